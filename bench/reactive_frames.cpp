// Frames a second on one core of every reactive controller: a walk in a circle on the empty plane
// without a graph, one session, resets watched for. Then s2c with the prediction graph for 10 m: a
// walk through the office in a room of 6 m x 6 m, resets and corners as they come, replayed from
// its heads; a graph stands for every frame (one is made where the feet have moved). Beside the
// price the answer: how far the world was turned. Times are processor time of the thread.
// usage: reactive_frames [frames]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "bench/thread_clock.h"
#include "bench/worlds.h"
#include "rdw/session.h"
#include "rdw/simulation.h"

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

int withGraph() {
  const bench::World built =
      bench::buildWorld("office", FOREWALK_ASSETS "/scenes/office.obj", navmesh::BuildSettings{});
  const auto world = std::make_shared<const navmesh::World>(navmesh::makeWorld(built.graph));
  rdw::SimulationConfig config;
  config.session.space = *rdw::TrackedSpace::rectangle(6.0, 6.0);
  config.session.limits = *rdw::gainLimitsByName("toolkit");
  config.session.controller = "s2c";
  config.session.alwaysPredict = false;
  config.stop.virtualMetres = 200.0;
  const auto walk = rdw::simulate(world, config);
  if (!walk) return 1;
  std::vector<rdw::HeadPose> heads;
  for (const rdw::FrameRecord& frame : walk->frames) {
    const double half = 0.5 * frame.physicalHeading;
    heads.push_back({navmesh::toSpace(glm::vec2(frame.physicalPosition), 1.65f),
                     glm::quat(static_cast<float>(std::cos(half)), 0.0f,
                               static_cast<float>(std::sin(half)), 0.0f)});
  }
  const rdw::FrameRecord& first = walk->frames.front();
  // On the office's one floor, at the height that is walkable there.
  const glm::vec3 floor = navmesh::toSpace(glm::vec2(first.virtualPosition), 0.0f);
  fmt::print("\ns2c and a graph for d in the office, {} frames\n", heads.size());
  fmt::print(
      "d, m           frames/s (median of 5)   ns/frame   world turned, rad   graphs made\n");
  for (const float horizon : {10.0f, 20.0f}) {
    std::array<double, 5> seconds{};
    double turned = 0.0;
    std::size_t graphs = 0;
    for (double& each : seconds) {
      rdw::SessionSettings settings = config.session;
      settings.alwaysPredict = true;
      settings.horizon = horizon;
      settings.start = rdw::VirtualStart{floor, static_cast<float>(first.virtualHeading)};
      auto session = rdw::Session::make(world, settings);
      if (!session) return 1;
      turned = 0.0;
      graphs = 0;
      glm::vec2 from(NAN);
      const double begin = bench::threadMicroseconds();
      for (std::size_t i = 0; i < heads.size(); ++i) {
        const rdw::FrameResult& frame =
            session->frame(heads[i], static_cast<double>(i) / config.rate);
        turned += frame.injectedYaw;
        graphs += frame.location.plan != from;
        from = frame.location.plan;
      }
      each = 1e-6 * (bench::threadMicroseconds() - begin);
    }
    std::sort(seconds.begin(), seconds.end());
    const auto count = static_cast<double>(heads.size());
    fmt::print("{:<14g} {:>12.0f} {:>20.0f} {:>15.6f} {:>13}\n", static_cast<double>(horizon),
               count / seconds[2], 1e9 * seconds[2] / count, turned, graphs);
  }
  return 0;
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
      const double begin = bench::threadMicroseconds();
      for (int i = 0; i < frames; ++i) {
        turned +=
            session->frame(heads[static_cast<std::size_t>(i) % heads.size()], i / 90.0).injectedYaw;
      }
      each = 1e-6 * (bench::threadMicroseconds() - begin);
    }
    std::sort(seconds.begin(), seconds.end());
    fmt::print("{:<14} {:>12.0f} {:>20.0f} {:>15.6f}\n", name, frames / seconds[2],
               1e9 * seconds[2] / frames, turned);
  }
  return withGraph();
}
