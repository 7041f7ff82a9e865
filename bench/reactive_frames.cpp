// Frames a second on one core of every reactive controller: a walk in a circle on the empty plane
// without a graph, one session, resets watched for. Beside the price the answer: how far the world
// was turned. usage: reactive_frames [frames]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "rdw/session.h"

namespace {

using namespace forewalk;

std::shared_ptr<const navmesh::World> plane() {
  navmesh::PolygonMesh square;
  for (const auto& [x, z] : {std::pair{-500.0f, 500.0f}, {500, 500}, {500, -500}, {-500, -500}}) {
    square.vertices.push_back({x, 0, z});
    square.ring.push_back(static_cast<std::uint32_t>(square.ring.size()));
  }
  square.ringStart.push_back(4);
  return std::make_shared<const navmesh::World>(navmesh::makeWorld(*navmesh::makeNavGraph(square)));
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 400000;
  // The heads of a walk round a circle of 2 m, once.
  std::vector<rdw::HeadPose> heads(1131);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const double angle = 2.0 * rdw::kPi * static_cast<double>(i) / 1131.0;
    heads[i].position = {static_cast<float>(2.0 * std::cos(angle)), 1.7f,
                         static_cast<float>(-2.0 * std::sin(angle))};
    const double half = 0.5 * angle;
    heads[i].orientation = glm::quat(static_cast<float>(std::cos(half)), 0.0f,
                                     static_cast<float>(std::sin(half)), 0.0f);
  }
  fmt::print("controller     frames/s (median of 5)   ns/frame   world turned, rad\n");
  for (const std::string_view name : rdw::controllerNames()) {
    if ((*rdw::makeController(name))->wantsPrediction()) continue;
    std::array<double, 5> seconds{};
    double turned = 0.0;
    for (double& each : seconds) {
      rdw::SessionSettings settings;
      settings.space = *rdw::TrackedSpace::rectangle(10.0, 10.0);
      settings.limits = *rdw::gainLimitsByName("toolkit");
      settings.controller = name;
      settings.alwaysPredict = false;
      auto session = rdw::Session::make(plane(), settings);
      if (!session) return 1;
      turned = 0.0;
      const auto begin = std::chrono::steady_clock::now();
      for (int i = 0; i < frames; ++i) {
        turned +=
            session->frame(heads[static_cast<std::size_t>(i) % heads.size()], i / 90.0).injectedYaw;
      }
      each = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    std::sort(seconds.begin(), seconds.end());
    fmt::print("{:<14} {:>12.0f} {:>20.0f} {:>15.6f}\n", name, frames / seconds[2],
               1e9 * seconds[2] / frames, turned);
  }
  return 0;
}
