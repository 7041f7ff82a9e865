// `forewalk.crowd/1`: who walks where, as a JSON file.
//
//   {
//     "format": "forewalk.crowd/1",
//     "scene": "../scenes/museum.obj",
//     "seconds": 120, "tick_s": 0.1, "seed": 1, "projection": true, "model": "orca",
//     "models": {"orca": {"time_horizon_s": 3}},
//     "room": [[-20, -10], [20, -10], [20, 10], [-20, 10]],
//     "walls": [[[0, -10], [0, -1]], [[0, 1], [0, 10]]],
//     "obstacles": [{"circle": [0, 5], "radius_m": 2},
//                   {"box": [5, 5], "size": [2, 1], "heading_deg": 30, "velocity": [0.5, 0]},
//                   {"box": [0, 0], "size": [0.2, 2], "from_s": 20, "until_s": 35},
//                   {"polygon": [[1, 1], [2, 1], [2, 2]]}],
//     "groups": [
//       {"name": "visitors", "count": 18, "model": "social-forces",
//        "radius_m": [0.2, 0.3], "speed_m_per_s": [1.1, 1.5],
//        "start": {"area": [-19, -9, -15, 9]}, "goal": {"area": [15, -9, 19, 9]}},
//       {"name": "user", "human": true, "start": {"points": [[0, 0]]},
//        "goal": {"visit": [[5, 0], [0, 0]], "loop": true}}
//     ],
//     "measure": {"area": [-2, -2, 2, 2]}
//   }
//
// Everything but `format` and `groups` has a default.
// - scene: a scene or .fwmesh to walk on, beside this file; without one, an open plane. Its keys
//   import and build are those of forewalk.simulation/1.
// - room: an outline with free ground inside. walls: thin ones, each a row of points. obstacles:
// one
//   of circle, box (its middle and whole size) or polygon each; those that move have a velocity.
//   from_s, until_s: it is there from then until then only (a door that shuts at 20 s and opens at
//   35 s, a cart that comes by); it moves from the moment it is there. Nobody is pushed out of what
//   appears around them, but walks out of it.
// - models: parameters by model (crowd_models.h); model: whose groups name none.
// - groups: count 1 to 100000. human: walks its way and yields to nobody (Crowd, kHuman).
//   radius_m, speed_m_per_s: a number, or [low, high] for random ones. depart_s: stands until then.
//   height_m: picks the storey of a scene. friends: whether they belong together (attraction).
//     start  {"points": [[x, z], ...]} as many as count; {"area": [x, z, x, z]} random in it;
//            {"ring": [x, z], "radius_m": r} evenly on it; "anywhere": random on the scene
//     goal   {"points": ...} one each or one for all; {"area": ...} random in it; "opposite": the
//            mirror image in the ring's middle; {"visit": [[x, z], ...], "loop": false} one after
//            the other; {"follow": "name of a group", "distance_m": 1.5}; "anywhere": random, and
//            a new one at each arrival; "none"
// - measure: where density and flow are measured; without it, no fundamental diagram.
// Positions are [x, z] of the world, metres; degrees only where a name says so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "agents/model.h"
#include "navmesh/build/obstacle.h"
#include "navmesh/build/scene.h"
#include "navmesh/build/settings.h"
#include "navmesh/error.h"

namespace forewalk::rdw {
class Fields;
}

namespace forewalk::service {

/// A rectangle on the plan, metres; low <= high.
struct PlanArea {
  glm::vec2 low{0.0f}, high{0.0f};
  bool contains(glm::vec2 point) const {
    return point.x >= low.x && point.y >= low.y && point.x <= high.x && point.y <= high.y;
  }
  float size() const { return (high.x - low.x) * (high.y - low.y); }  ///< m^2
};

struct CrowdStart {
  enum class Kind { points, area, ring, anywhere };
  Kind kind = Kind::points;
  std::vector<glm::vec2> points;
  PlanArea area;
  glm::vec2 centre{0.0f};
  float radius = 1.0f;
};

struct CrowdGoal {
  enum class Kind { none, points, area, opposite, visit, follow, anywhere };
  Kind kind = Kind::none;
  std::vector<glm::vec2> points;  ///< points, visit
  PlanArea area;
  bool loop = false;
  std::string follow;  ///< name of a group before this one: agent i follows its i-th, or its last
  float distance = 1.5f;  ///< from who is followed, metres
};

struct CrowdGroup {
  std::string name;
  std::uint32_t count = 1;
  std::string model;  ///< a name of crowd_models.h
  bool human = false;
  bool friends = false;
  glm::vec2 radius{0.25f}, speed{1.3f};  ///< low and high
  float departSeconds = 0.0f;
  float height = 0.0f;
  CrowdStart start;
  CrowdGoal goal;
};

struct PlacedObstacle {
  navmesh::Obstacle shape;
  glm::vec2 velocity{0.0f};
  /// It is there when the tick begins at `from` seconds or later, and before `until`.
  double from = 0.0, until = std::numeric_limits<double>::infinity();

  bool isThere(double seconds) const { return seconds >= from && seconds < until; }
};

struct CrowdConfig {
  std::string scene;  ///< empty: an open plane
  navmesh::ImportSettings import;
  navmesh::BuildSettings build;
  double seconds = 60.0;
  double tick = 0.1;
  std::uint64_t seed = 1;
  bool projection = true;
  std::vector<glm::vec2> room;                ///< counter-clockwise, or empty
  std::vector<std::vector<glm::vec2>> walls;  ///< rows of points
  std::vector<PlacedObstacle> obstacles;
  std::vector<CrowdGroup> groups;  ///< at least one
  std::optional<PlanArea> measure;
  /// Makes a model of the registry with the file's parameters.
  std::function<std::unique_ptr<const agents::Model>(const std::string& name)> makeModel;
};

/// Reads `model`, `models` and `groups` of an object that holds them, for a scene of this name
/// (empty: an open plane); what is wrong is told to the fields' problem.
void readGroups(rdw::Fields& fields, const std::string& scene, CrowdConfig& config);

/// Parses the bytes of such a file; `name` stands for it in messages. Nothing here touches the
/// disk.
///
/// Fails as parseSimulation does (rdw/simulation_config.h): not JSON, another format, an unknown
/// key or model with the nearest known one, a value of the wrong kind or out of its range; besides
/// when an obstacle cannot be one, points are fewer than a group needs, a goal does not fit its
/// start, or more than 100,000 agents are asked for. Costs O(size).
[[nodiscard]] tl::expected<CrowdConfig, Error> parseCrowd(std::span<const std::byte> bytes,
                                                          const std::string& name);

}  // namespace forewalk::service
