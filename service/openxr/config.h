// `forewalk.openxr/1`: how the OpenXR layer redirects, as a JSON file.
//
//   {
//     "format": "forewalk.openxr/1",
//     "scene": "museum.fwmesh",
//     "space": "stage",
//     "controller": "s2c-predictive", "limits": "steinicke", "horizon_m": 20,
//     "start": {"position": [22, 0, 17], "heading_deg": 30},
//     "origin": {"space": "stage", "position": [0, 0, 0], "heading_deg": 0},
//     "eye_height_m": 1.6,
//     "reset_tint": [1, 0.5, 0.5],
//     "applications": ["walkthrough"]
//   }
//
// Everything but `format` and `scene` has a default.
// - scene: a scene or .fwmesh; `import` and `build` as in forewalk.simulation/1
//   (rdw/simulation_config.h), as are limits, controller, horizon_m, method, persistence_m, resets,
//   reset and heading.
// - space: as there, or "stage", the default: the rectangle that the runtime says is free around
//   the origin of its STAGE space. A rectangle or polygon lies in STAGE coordinates; where the
//   runtime has no STAGE, in LOCAL's.
// - origin: where in the scene the application has put the origin of its reference space "stage"
//   or "local".
// - start: where in the scene the walk begins; without it, where the application's own origin and
//   the head put it, so that nothing changes at first.
// - eye_height_m: of LOCAL's origin over the floor, where the runtime has no STAGE.
// - reset_tint: what red, green and blue are multiplied by while the user has to turn; [1, 1, 1]:
//   nothing is shown. Needs XR_KHR_composition_layer_color_scale_bias of the runtime.
// - applications: names, as they call themselves, of those to redirect; without it, all.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/session.h"
#include "service/openxr/rigid.h"

namespace forewalk::openxr {

/// Which of the application's spaces the scene is tied to.
enum class OriginSpace : std::uint8_t { kStage, kLocal };

struct LayerConfig {
  std::filesystem::path file;
  std::string scene;                            ///< as the file names it
  std::shared_ptr<const navmesh::World> world;  ///< never null
  rdw::SessionSettings session;
  bool stageRoom = true;  ///< session.space is the runtime's to say
  OriginSpace originSpace = OriginSpace::kStage;
  Rigid origin;                           ///< pose of that space's origin in the scene
  double eyeHeight = 1.6;                 ///< metres
  glm::vec3 resetTint{1.0f, 0.5f, 0.5f};  ///< red, green, blue
  std::vector<std::string> applications;  ///< none: all
};

/// Reads the file and what it names, which lies beside it unless its path is absolute, and builds
/// the navmesh on all cores. Fails as service::SimulationLoader does, with the file's name, and
/// when `scene` is missing (kDataDamaged).
[[nodiscard]] tl::expected<LayerConfig, Error> loadConfig(const std::filesystem::path& file);

/// Whether an application of this name is to be redirected.
bool isMeant(const LayerConfig& config, std::string_view application);

}  // namespace forewalk::openxr
