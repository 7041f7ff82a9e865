// Others who share the virtual building with a simulated walk, as far as the walk needs to know.
//
// The simulation moves the user, tells the company where the user is, and asks it what the world is
// like now and whom to make way for. Who the others are and how they walk is the caller's matter
// (service/walk_company.h brings a crowd).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/polygon_states.h"
#include "rdw/pose.h"

namespace forewalk::rdw {

/// The user as others see them: virtual space.
struct CompanyUser {
  PlanarPose pose;                 ///< plan, metres and radians
  float height = 0.0f;             ///< of the floor under the feet, world y, metres
  std::optional<glm::dvec2> goal;  ///< the point walked straight to now, plan; none: nowhere
  double speed = 1.0;              ///< at which the user would like to walk, virtual m/s
};

/// What others were to the user in one frame.
struct CompanyRecord {
  /// From the user's body to the nearest other, metres; negative: in each other. Infinity: nobody.
  double clearance = std::numeric_limits<double>::infinity();
  std::uint64_t collisions = 0;       ///< of the user with others, begun so far
  std::uint32_t blockedPolygons = 0;  ///< closed, or dearer, because somebody stands there
};

/// The company of a whole walk in numbers.
struct CompanySummary {
  std::uint32_t others = 0;
  bool userAvoids = false;
  std::uint64_t collisions = 0;        ///< of the user with others
  double collisionSeconds = 0.0;       ///< in which they lasted
  std::uint64_t othersCollisions = 0;  ///< among the others
  /// The least clearance of any frame, metres; infinity where there was nobody.
  double minimumSeparation = std::numeric_limits<double>::infinity();
  double blockedSeconds = 0.0;        ///< while somebody blocked a way
  std::uint64_t stateChanges = 0;     ///< times a way was blocked, priced or freed
  std::uint32_t blockedPolygons = 0;  ///< most at a time
  std::uint64_t hash = 0;             ///< of the others' last state
};

class Company {
 public:
  virtual ~Company() = default;

  /// Before the first frame, the user standing at the start. Fails where there is no room for the
  /// others.
  [[nodiscard]] virtual tl::expected<void, Error> begin(const CompanyUser& user) = 0;

  /// After frame `frame` (0, 1, ...), where the user has come to `user`: others are now where they
  /// are at that frame's time.
  virtual void follow(std::uint64_t frame, const CompanyUser& user) = 0;

  /// What is closed and what costs more because of them; null: nothing. Another pointer is another
  /// state of the world.
  virtual std::shared_ptr<const navmesh::PolygonStates> states() const = 0;

  /// Whether a simulated user makes way, and takes ways that are not blocked.
  virtual bool userAvoids() const = 0;

  /// How the user would walk now to make way, virtual m/s on the plan; none: as it likes.
  virtual std::optional<glm::dvec2> makeWay() const = 0;

  virtual CompanyRecord record() const = 0;
  virtual CompanySummary summary() const = 0;
};

}  // namespace forewalk::rdw
