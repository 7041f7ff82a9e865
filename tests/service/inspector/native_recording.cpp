// Walks in bundled buildings as recordings (forewalk.session/1), with what the native library
// predicts on the way, for the inspector to be measured against:
//
//   native_recording FOLDER SECONDS   writes FOLDER/WALK.jsonl and FOLDER/WALK.graphs.jsonl for
//   each walk
//
// The first walk takes SECONDS at 90 frames a second, the others 30 s. A line of the graphs is
// {"frame": 450, "nodes": [[x, y, z, polygon], ...]}, every five seconds.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>

#include "navmesh/plan.h"
#include "rdw/simulation.h"
#include "service/daemon/recording_format.h"
#include "service/daemon/session_bytes.h"
#include "service/files.h"

namespace forewalk {
namespace {

constexpr std::size_t kGraphEvery = 450;  // frames

struct Walk {
  std::string name, controller;
  prediction::Method method;
  float horizon;
  double seconds;
};

int refused(const std::string& what) {
  fmt::print(stderr, "{}\n", what);
  return 1;
}

void appendGraph(std::size_t frame, const prediction::PredictionGraph& graph, std::string& out) {
  fmt::format_to(std::back_inserter(out), "{{\"frame\":{},\"nodes\":[", frame);
  for (const prediction::Node& node : graph.nodes) {
    const glm::vec3 p = node.position();
    fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}]", out.back() == '[' ? "" : ",", p.x,
                   p.y, p.z, navmesh::index(node.polygon));
  }
  out += "]}\n";
}

int walkAndWrite(const Walk& walk, const std::filesystem::path& folder) {
  const auto navMesh =
      service::loadNavMesh(std::string(FOREWALK_ASSETS) + "/scenes/" + walk.name + ".obj");
  if (!navMesh) return refused(navMesh.error().message);
  const auto world = service::makeWorld(*navMesh);
  if (!world) return refused(world.error().message);

  rdw::SimulationConfig config;
  config.session.space = *rdw::TrackedSpace::rectangle(5.0, 5.0);
  config.session.controller = walk.controller;
  config.session.method = walk.method;
  config.session.horizon = walk.horizon;
  config.session.alwaysPredict = true;
  config.stop.seconds = walk.seconds;
  config.seed = 5;
  const auto simulated = rdw::simulate(*world, config);
  if (!simulated) return refused(simulated.error().message);
  const std::vector<rdw::FrameRecord>& frames = simulated->frames;

  config.session.start = rdw::VirtualStart{
      navmesh::toSpace(glm::vec2(frames.front().virtualPosition), simulated->startHeight),
      static_cast<float>(frames.front().virtualHeading)};
  auto session = rdw::Session::make(*world, config.session);
  if (!session) return refused(session.error().message);
  const daemon::NavMeshHash hash = daemon::hashOf(*navMesh);
  std::string recording, graphs;
  std::uint32_t resets = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double half = 0.5 * frames[i].physicalHeading;
    daemon::Frame frame;
    frame.sequence = static_cast<std::uint32_t>(i) - 1;  // the first is not recorded
    frame.seconds = frames[i].t;
    frame.head = {
        navmesh::toSpace(glm::vec2(frames[i].physicalPosition), 1.7f),
        {static_cast<float>(std::cos(half)), 0.0f, static_cast<float>(std::sin(half)), 0.0f}};
    const rdw::FrameResult& result = session->frame(frame.head, frame.seconds);
    if (i == 0) {
      // As sessions of the C interface are recorded: from a state onward, which replays to the bit.
      const rdw::SessionState state = session->state();
      if (!session->resume(state))
        return refused(walk.name + ": its first state cannot be resumed");
      recording = daemon::recordingHead("0000000000000001", walk.name + ".obj",
                                        daemon::textOf(hash), daemon::settingsText(config.session),
                                        daemon::stateBytes({1, state}, hash));
      continue;
    }
    const daemon::Answer answer = daemon::answerOf(frame.sequence, result);
    daemon::appendRecordedFrame(frame, answer, recording);
    if (frame.sequence % kGraphEvery == 0 && result.graph != nullptr)
      appendGraph(frame.sequence, *result.graph, graphs);
    resets = answer.resetCount;
  }
  for (const auto& [ending, text] : {std::pair(".jsonl", &recording), {".graphs.jsonl", &graphs}}) {
    if (auto written = service::writeFile(folder / (walk.name + ending), *text); !written)
      return refused(written.error().message);
  }
  fmt::print("{}: {} frames, {} resets, {:.1f} MB\n", walk.name, frames.size() - 1, resets,
             1e-6 * static_cast<double>(recording.size()));
  return 0;
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  const double seconds = argc == 3 ? std::atof(argv[2]) : 0.0;
  if (!(seconds > 0.0)) return forewalk::refused("usage: native_recording FOLDER SECONDS");
  using forewalk::prediction::Method;
  for (const forewalk::Walk& walk :
       {forewalk::Walk{"museum", "foresight", Method::kPolygon, 10.0f, seconds},
        forewalk::Walk{"office", "s2c", Method::kFront, 12.0f, 30.0},
        forewalk::Walk{"two_storey", "s2o-predictive", Method::kPolygon, 8.0f, 30.0}}) {
    if (const int failed = forewalk::walkAndWrite(walk, argv[1])) return failed;
  }
  return 0;
}
