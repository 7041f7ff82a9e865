// The navigation of avatars in Ono's thesis (UCL 2011): a database of objects, an autopilot, and
// only a heading and a speed handed back to the world.
//
// Objects are boxes on the plan, named by the world's own numbers. They appear, move and disappear
// at any time, also while somebody walks (the thesis had to stop for that). Every box is grown by a
// margin; the object an avatar walks to is no obstacle to it. The autopilot turns towards where the
// model (HRVO) wants to go, walks fast when it looks there, and slows down and stops before its
// target.
//
// The thesis counts in steps of its simulation and units of its world; both are seconds and metres
// here.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <random>
#include <tl/expected.hpp>
#include <vector>

#include "agents/crowd.h"
#include "agents/models/hrvo.h"

namespace forewalk::agents {

/// The world's number of an object.
enum class ObjectId : std::uint32_t {};

struct AvatarParameters {
  HrvoParameters model{3.0f, 6, 0.0f, 1.0f, 1.0f, 1.0f, false};  ///< the thesis's constants
  float radius = 1.0f;                                           ///< metres
  float maximumSpeed = 2.0f;                                     ///< m/s
  float preferredSpeed = 0.5f;       ///< m/s, at the start; then what was walked in the last frame
  float maximumAcceleration = 0.5f;  ///< m/s^2
  float margin = 0.1f;               ///< boxes are grown by so much on each side, metres
  float retargetSeconds = 15.0f;     ///< another target after so long
  float slowSpeed = 0.25f;  ///< share of the maximum speed where it does not look where it goes
  float turnRate = 3.0f;    ///< of the body, rad/s
};

/// How near to its target an avatar stops and begins to slow down, for the distance at which it set
/// out; metres. max(0.5, sqrt(d)) and max(3, stop + 2).
float stopDistance(float startDistance);
float slowDistance(float startDistance);

/// What goes back to the world for one avatar.
struct AvatarMotion {
  float heading = 0.0f;  ///< radians
  float speed = 0.0f;    ///< m/s
};

/// One avatar among objects. Deterministic: random targets come from the seed.
class AvatarNavigation {
 public:
  explicit AvatarNavigation(glm::vec2 start, const AvatarParameters& parameters = {},
                            std::uint64_t seed = 1);

  /// Adds an object, or moves the one with this number. `centre` and `halfSize` on the plan,
  /// metres. Fails as navmesh::validate does.
  [[nodiscard]] tl::expected<void, Error> setObject(ObjectId id, glm::vec2 centre,
                                                    glm::vec2 halfSize, float heading = 0.0f);
  bool removeObject(ObjectId id);
  std::size_t objectCount() const { return objects_.size(); }

  /// Walks to an object. False where there is none of that number.
  bool walkTo(ObjectId target);
  std::optional<ObjectId> target() const { return target_; }
  bool arrived() const { return arrived_; }

  /// One frame. Where it has arrived or walked for `retargetSeconds`, and `wander`, it picks
  /// another object.
  AvatarMotion step(float seconds, bool wander = false);

  glm::vec2 position() const { return crowd_.view().position[0]; }
  float heading() const { return heading_; }

 private:
  struct Object {
    ObjectId id;
    glm::vec2 centre, halfSize;
    float heading;
    navmesh::ObstacleId obstacle;
    bool blocks;  // it is in the crowd
  };
  Object* find(ObjectId id);
  navmesh::BoxObstacle grown(const Object& object) const;
  void block(Object& object, bool blocks);

  AvatarParameters parameters_;
  Crowd crowd_;
  AgentId self_;
  std::vector<Object> objects_;  // ascending by id
  std::optional<ObjectId> target_;
  std::mt19937_64 rng_;
  float heading_ = 0.0f;
  float startDistance_ = 0.0f;
  float walking_ = 0.0f;  // seconds towards this target
  bool arrived_ = true;
};

}  // namespace forewalk::agents
