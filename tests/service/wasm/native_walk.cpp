// Walks as the native library is told them and answers, as JSON lines for agreement.mjs:
//
//   native_walk FOLDER   writes FOLDER/WALK.fwmesh and FOLDER/WALK.jsonl for each walk
//
// The first line holds the session's settings, then a line a frame: [seconds, head position and
// orientation, virtual position and orientation, flags, resets, graph nodes], 17 numbers.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/build/fwmesh.h"
#include "navmesh/plan.h"
#include "rdw/simulation.h"
#include "rdw/walk_file.h"
#include "service/capi/forewalk.h"
#include "service/files.h"

namespace forewalk {
namespace {

struct Walk {
  std::string name, scene;
  const char *controller, *reset, *method;
  forewalk_controller controllerConstant;
  forewalk_reset resetConstant;
  forewalk_method methodConstant;
  float horizon;
  std::string recording;  // empty: a made-up walker
};

int refused(const std::string& what) {
  fmt::print(stderr, "{}\n", what);
  return 1;
}

int walkAndWrite(const Walk& walk, const std::filesystem::path& folder) {
  const auto navMesh = service::loadNavMesh(walk.scene);
  if (!navMesh) return refused(navMesh.error().message);
  const auto world = service::makeWorld(*navMesh);
  if (!world) return refused(world.error().message);
  const std::vector<std::byte> fwmesh = navmesh::saveFwmesh(*navMesh);
  if (auto written = service::writeFile(folder / (walk.name + ".fwmesh"), fwmesh); !written)
    return refused(written.error().message);

  // Whatever the walker does: the heads are what counts.
  rdw::SimulationConfig config;
  config.session.space = *rdw::TrackedSpace::rectangle(5.0, 5.0);
  config.session.controller = "s2c";
  config.session.alwaysPredict = false;
  config.stop.seconds = 60.0;
  config.seed = 3;
  if (!walk.recording.empty()) {
    const auto bytes = service::readFile(walk.recording);
    if (!bytes) return refused(bytes.error().message);
    auto walks = rdw::parseWalks(*bytes, walk.recording);
    if (!walks) return refused(walks.error().message);
    config.user.plan = rdw::Recorded{std::move(walks->front())};
  }
  const auto simulated = rdw::simulate(*world, config);
  if (!simulated) return refused(simulated.error().message);
  const std::vector<rdw::FrameRecord>& frames = simulated->frames;

  forewalk_navmesh* navmesh = nullptr;
  forewalk_session* session = nullptr;
  if (forewalk_navmesh_from_fwmesh(fwmesh.data(), fwmesh.size(), &navmesh) != FOREWALK_OK)
    return refused(forewalk_last_error());
  forewalk_session_settings settings;
  forewalk_session_settings_init(&settings, sizeof settings);
  settings.controller = walk.controllerConstant;
  settings.reset = walk.resetConstant;
  settings.method = walk.methodConstant;
  settings.horizon = walk.horizon;
  settings.width = settings.depth = 5.0f;
  settings.has_start = 1;
  const glm::vec2 start(frames.front().virtualPosition);
  settings.start_floor = {start.x, 0.0f, -start.y};
  settings.start_heading = static_cast<float>(frames.front().virtualHeading);
  if (forewalk_session_create(navmesh, &settings, &session) != FOREWALK_OK)
    return refused(forewalk_last_error());

  std::string text = fmt::format(
      R"({{"controller":"{}","reset":"{}","method":"{}","horizon":{},"width":5,"depth":5,"start":{{"floor":[{},0,{}],"heading":{}}}}})"
      "\n",
      walk.controller, walk.reset, walk.method, walk.horizon, settings.start_floor.x,
      settings.start_floor.z, settings.start_heading);
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  for (const rdw::FrameRecord& frame : frames) {
    const glm::vec3 head = navmesh::toSpace(glm::vec2(frame.physicalPosition), 1.7f);
    const double half = 0.5 * frame.physicalHeading;
    const forewalk_quat looking = {0.0f, static_cast<float>(std::sin(half)), 0.0f,
                                   static_cast<float>(std::cos(half))};
    forewalk_frame(session, {head.x, head.y, head.z}, looking, frame.t, &out);
    const forewalk_pose& pose = out.virtual_pose;
    fmt::format_to(
        std::back_inserter(text), "[{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}]\n",
        frame.t, head.x, head.y, head.z, looking.x, looking.y, looking.z, looking.w,
        pose.position.x, pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y,
        pose.orientation.z, pose.orientation.w, out.flags, out.reset_count, out.graph_nodes);
  }
  forewalk_session_destroy(session);
  forewalk_navmesh_release(navmesh);
  if (auto written = service::writeFile(folder / (walk.name + ".jsonl"), text); !written)
    return refused(written.error().message);
  fmt::print("{}: {} frames, {} resets\n", walk.name, frames.size(), out.reset_count);
  return 0;
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  if (argc != 2) return forewalk::refused("usage: native_walk FOLDER");
  const std::string scenes = std::string(FOREWALK_ASSETS) + "/scenes/";
  std::vector<forewalk::Walk> walks = {
      {"office", scenes + "office.obj", "s2c-predictive", "two-one-turn", "polygon",
       FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_RESET_TWO_ONE_TURN, FOREWALK_METHOD_POLYGON,
       15.0f, ""},
      {"museum", scenes + "museum.obj", "s2o", "r2g", "front", FOREWALK_CONTROLLER_S2O,
       FOREWALK_RESET_R2G, FOREWALK_METHOD_FRONT, 12.0f, ""},
      {"two_storey", scenes + "two_storey.obj", "foresight", "ahead", "polygon",
       FOREWALK_CONTROLLER_FORESIGHT, FOREWALK_RESET_AHEAD, FOREWALK_METHOD_POLYGON, 10.0f, ""}};
  const std::string people = std::string(FOREWALK_SHARED_DATA) + "/walks/searching-a/";
  if (std::filesystem::exists(people + "walks.csv")) {
    walks.push_back({"people", people + "scene.obj", "s2c-predictive", "r2c", "polygon",
                     FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_RESET_R2C,
                     FOREWALK_METHOD_POLYGON, 10.0f, people + "walks.csv"});
  }
  for (const forewalk::Walk& walk : walks) {
    if (const int failed = forewalk::walkAndWrite(walk, argv[1])) return failed;
  }
  return 0;
}
