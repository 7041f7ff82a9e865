// The OpenXR layer's configuration from any bytes: what it accepts is in range, and only a file
// that names a building that is there gets as far as a session.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "navmesh/build/build.h"
#include "navmesh/build/fwmesh.h"
#include "rdw/gains.h"
#include "service/openxr/config.h"
#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;
using forewalk::testing::require;

/// A folder of our own with a building in it.
const fs::path& folder() {
  static const fs::path made = [] {
    const fs::path path =
        fs::temp_directory_path() / ("forewalk-openxr-config-fuzz-" + std::to_string(getpid()));
    fs::create_directories(path);
    forewalk::navmesh::Scene scene;
    scene.vertices = {{-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3}};
    scene.triangles = {{0, 2, 1}, {0, 3, 2}};
    const auto saved =
        forewalk::navmesh::saveFwmesh(forewalk::navmesh::buildNavMesh(scene).value());
    std::ofstream(path / "hall.fwmesh", std::ios::binary)
        .write(reinterpret_cast<const char*>(saved.data()),
               static_cast<std::streamsize>(saved.size()));
    std::atexit([] { fs::remove_all(folder()); });
    return path;
  }();
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fs::path file = folder() / "layer.json";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto config = forewalk::openxr::loadConfig(file);
  if (config) {
    require(config->world != nullptr, "there is a world");
    require(config->eyeHeight >= 0.2 && config->eyeHeight <= 3.0, "the eye height is in range");
    for (int i = 0; i < 3; ++i) {
      require(config->resetTint[i] >= 0.0f && config->resetTint[i] <= 1.0f, "the tint is in range");
    }
    require(forewalk::rdw::validate(config->session.limits).has_value(), "limits can work");
    require(config->session.horizon > 0.0f && config->session.horizon <= 1000.0f,
            "the horizon is in range");
  } else {
    const std::string& message = config.error().message;
    require(!message.empty() && message.size() < 900, "a message is there, and short");
    for (const char c : message) require(c >= ' ' && c <= '~', "a message is printable");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return forewalk::testing::seedsOf(
      {R"({"format": "forewalk.openxr/1", "scene": "hall.fwmesh"})",
       R"({"format": "forewalk.openxr/1", "scene": "hall.fwmesh", "space": {"rectangle": [4, 5]},
            "controller": "s2c", "limits": "toolkit", "horizon_m": 20, "reset": "r2g",
            "start": {"position": [1, 0, 1], "heading_deg": 30},
            "origin": {"space": "local", "position": [0, 0, 0], "heading_deg": 90},
            "eye_height_m": 1.6, "reset_tint": [1, 0.5, 0.5], "applications": ["walkthrough"]})",
       R"({"format": "forewalk.openxr/1", "scene": "none.obj", "space": "stage",
            "build": {"cell_m": 0.2}, "import": {"unit": 0.01}, "heading": "chest"})"});
}
