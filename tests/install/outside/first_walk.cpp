#include <cstdio>
#include <memory>

#include "navmesh/build/build.h"
#include "rdw/session.h"

int main(int, char** argv) {
  using namespace forewalk;

  // At load: scene -> navmesh -> navgraph. Each step may fail, and says why.
  const auto world = navmesh::importScene(argv[1])
                         .and_then([](const auto& scene) { return navmesh::buildNavMesh(scene); })
                         .and_then([](const auto& mesh) { return makeNavGraph(flatten(mesh)); })
                         .map(navmesh::makeWorld);
  if (!world) return std::fprintf(stderr, "%s\n", world.error().message.c_str()), 1;

  // A session per user: a room of 6 x 6 m, predictive steer-to-center, 20 m of foresight.
  rdw::SessionSettings settings;
  settings.horizon = 20.0f;
  settings.start = rdw::VirtualStart{.floor = {7.0f, 0.0f, 12.0f}, .heading = 0.0f};
  auto session = rdw::Session::make(std::make_shared<const navmesh::World>(*world), settings);
  if (!session) return std::fprintf(stderr, "%s\n", session.error().message.c_str()), 1;

  // Every frame: the tracked head goes in, the pose to render from comes out.
  for (int i = 0; i <= 180; ++i) {
    const double seconds = i / 90.0;
    rdw::HeadPose head;
    head.position = {0.0f, 1.7f, -static_cast<float>(seconds)};  // ahead at 1 m/s
    const rdw::FrameResult& frame = session->frame(head, seconds);
    if (i % 60 != 0) continue;
    const glm::vec3 eye = frame.virtualPose.position;
    std::printf("%.2f s: at (%.2f, %.2f, %.2f), %zu ways ahead, curvature gain %+.3f/m\n", seconds,
                eye.x, eye.y, eye.z, frame.graph->terminals.size(), frame.gains.curvature);
  }
}
