// Ways that are not floor: lifts, ladders, teleports.
//
// A link leads from one place of the ground to another and counts for some metres of walking,
// however far the two lie apart. Prediction takes it for a neighbour relation with a length of its
// own: a way goes to the entry, through the link, and on from the exit (prediction/predict.h).
//
// Links are put on a graph once, off the frame, as a value beside it. They take effect as a part of
// PolygonStates (polygon_states.h), which know the chains and neighbours that follow. Closing a
// link is making the value again without it. `component` of the graph and findCorridor know of
// floor only.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// The owner's name for a link; any number.
enum class LinkId : std::uint32_t {};
constexpr std::uint32_t index(LinkId id) { return static_cast<std::uint32_t>(id); }

/// A link as people place it.
struct Link {
  LinkId id{};
  glm::vec3 entry{0.0f};  ///< on the ground, or near it (kLinkSnap); world space, metres
  glm::vec3 exit{0.0f};   ///< likewise
  float length = 1.0f;    ///< that it counts for, 0 to kLongestLink, metres
  bool bothWays = false;  ///< the exit is an entry as well
  bool open = true;       ///< closed: as if it were not there

  bool operator==(const Link&) const = default;
};

inline constexpr float kLongestLink = 10000.0f;  ///< metres

/// How far an end may be from the ground.
inline constexpr SnapLimits kLinkSnap{0.5f, 0.5f, 0.5f};

/// Most ways by links out of one polygon.
inline constexpr std::uint32_t kMostLinkWays = 64;

/// One way through a link.
struct LinkWay {
  PolygonId from;
  PolygonId to;
  glm::vec2 entry;                ///< in `from`; plan, metres
  glm::vec2 exit;                 ///< in `to`
  float entryHeight, exitHeight;  ///< world y, metres
  float length;                   ///< metres
  LinkId link;
  bool back;  ///< from the link's exit to its entry

  bool operator==(const LinkWay&) const = default;
};

/// Belongs to the one graph it was made for. Only read once it is made.
struct Links {
  std::vector<LinkWay> ways;            ///< of the open ones, by `from`, then by all that they are
  std::vector<std::uint32_t> wayStart;  ///< polygons + 1 offsets into `ways`; empty without ways

  bool empty() const { return ways.empty(); }
  std::span<const LinkWay> from(PolygonId polygon) const {
    if (ways.empty()) return {};
    const std::uint32_t begin = wayStart[index(polygon)];
    return {ways.data() + begin, wayStart[index(polygon) + 1] - begin};
  }

  bool operator==(const Links&) const = default;
};

/// Fails when a number is not finite (kDataDamaged) or a length is out of range
/// (kSettingOutOfRange), naming link and value.
[[nodiscard]] tl::expected<void, Error> validate(const Link& link);

/// Puts links on a graph: both ends go to the nearest ground within kLinkSnap. Their order does not
/// matter. A link whose ends are one place leads nowhere and is left out; one whose ends lie in one
/// polygon is followed by graphs by fronts only.
///
/// Fails as validate does, when two links have one id (kSettingOutOfRange), when more than
/// kMostLinkWays lead out of one polygon (kTooLarge), and where an end is not on walkable ground
/// (kPositionOffNavMesh, naming link, end and place). With `groundless`, such links are left out
/// instead, closed ones as well, and their ids put there, ascending. O(links log links + polygons).
[[nodiscard]] tl::expected<Links, Error> makeLinks(const NavGraph& graph,
                                                   const LocationIndex& locations,
                                                   std::span<const Link> links,
                                                   std::vector<LinkId>* groundless = nullptr);

}  // namespace forewalk::navmesh
