// Where one walker alone goes: a model sent from a start to a goal in a building, or from object to
// object in the scenes of Ono's thesis. To be compared with people's paths, and with each other's.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "agents/model.h"
#include "agents/published_scenes.h"
#include "navmesh/world.h"

namespace forewalk::service {

/// A walker's name and its model.
struct LoneModel {
  std::string name;
  std::function<std::unique_ptr<const agents::Model>()> make;  ///< as ModelMaker
};

/// All models of the registry (crowd_models.h) with their defaults.
std::vector<LoneModel> loneModels();

/// Who is sent where.
struct Errand {
  glm::dvec2 from{0.0}, to{0.0};  ///< plan, metres
  double heading = 0.0;           ///< at the start, radians
  double speed = 1.3;             ///< comfort speed, m/s; at most half as fast again
  double rate = 20.0;             ///< samples a second of the path, > 0
};

/// A path, and whether it came to the goal.
struct LonePath {
  std::vector<glm::dvec2> points;  ///< plan, metres; the start first
  double seconds = 0.0;            ///< walked
  bool arrived = false;
};

/// The shortest way from place to place on the navmesh, pulled taut; start and goal first and last,
/// as they were given. Empty where one of them is more than half a metre beside the navmesh, or
/// there is no way. Same as what a crowd walks along: portal midpoints decide the corridor.
std::vector<glm::dvec2> tautPath(const navmesh::World& world, glm::dvec2 from, glm::dvec2 to);

/// Walks the errand with ticks of 0.1 s in a world built for `walkerRadius`: a body of 0.25 m that
/// starts at rest, within 0.15 m of the goal when it has arrived, and no longer than four times
/// what the shortest way would take, and 10 s.
LonePath walkErrand(const std::shared_ptr<const navmesh::World>& world, float walkerRadius,
                    const LoneModel& model, const Errand& errand);

/// Walks a scene of the thesis: to all of its visits in turn, with its body of 1 m, at 1.3 m/s,
/// over paths that every model is given alike (cells, as Crowd::setCells); the object that it walks
/// to is no obstacle, and is reached half a metre before body and box touch. 10 samples a second.
LonePath walkScene(const agents::AvatarScene& scene, const LoneModel& model);

/// The same by the thesis's own navigation (avatar_navigation.h): HRVO and its autopilot, without
/// paths, at the thesis's speeds, stopping where it stops.
LonePath walkSceneAsAvatar(const agents::AvatarScene& scene);

}  // namespace forewalk::service
