// What a frame costs through the C interface, several users at once.
//
// A walk of the simulation is played to sessions of the C interface on as many threads as asked
// for, all on one navmesh. Printed: processor time of forewalk_frame, median, 99th percentile and
// worst, over all threads. Proof: all threads are told the same virtual poses to the last bit, and
// their hash is printed.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "navmesh/plan.h"
#include "rdw/simulation.h"
#include "service/capi/forewalk.h"
#include "service/files.h"
#include "service/timing.h"

namespace forewalk::bench {
namespace {

struct Options {
  float horizon = 20.0f;
  double seconds = 60.0;
  unsigned threads = 2;
  std::vector<std::string> scenes = {"office", "museum", "two_storey", "corridor", "maze"};
};

double threadMicroseconds() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return 1e6 * static_cast<double>(used.tv_sec) + 1e-3 * static_cast<double>(used.tv_nsec);
}

/// A walk as the simulation made it: heads, and where it was virtually at first.
struct Walk {
  std::vector<rdw::FrameRecord> frames;
  rdw::VirtualStart start;
};

struct Played {
  std::vector<double> microseconds;
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  std::uint32_t resets = 0;
  std::string failure;
};

forewalk_vec3 vector(glm::vec3 v) { return {v.x, v.y, v.z}; }

Played play(const forewalk_navmesh* navmesh, const Walk& walk,
            const forewalk_session_settings& settings) {
  Played played;
  forewalk_session* session = nullptr;
  if (forewalk_session_create(navmesh, &settings, &session) != FOREWALK_OK) {
    played.failure = forewalk_last_error();
    return played;
  }
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  played.microseconds.reserve(walk.frames.size());
  for (const rdw::FrameRecord& frame : walk.frames) {
    const glm::vec3 head = navmesh::toSpace(glm::vec2(frame.physicalPosition), 1.7f);
    const auto half = 0.5 * frame.physicalHeading;
    const forewalk_quat looking = {0.0f, static_cast<float>(std::sin(half)), 0.0f,
                                   static_cast<float>(std::cos(half))};
    const double before = threadMicroseconds();
    forewalk_frame(session, vector(head), looking, frame.t, &out);
    played.microseconds.push_back(threadMicroseconds() - before);
    unsigned char bytes[sizeof out.virtual_pose];
    std::memcpy(bytes, &out.virtual_pose, sizeof bytes);
    for (const unsigned char byte : bytes) played.hash = (played.hash ^ byte) * 0x100000001b3u;
  }
  played.resets = out.reset_count;
  forewalk_session_destroy(session);
  return played;
}

tl::expected<Walk, Error> walkIn(const std::filesystem::path& scene, const Options& options) {
  auto navMesh = service::loadNavMesh(scene);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return tl::unexpected(world.error());
  rdw::SimulationConfig config;
  config.session.space = *rdw::TrackedSpace::rectangle(5.0, 5.0);
  config.session.controller = "s2c";
  config.session.alwaysPredict = false;
  config.stop.seconds = options.seconds;
  auto result = rdw::simulate(std::move(*world), config);
  if (!result) return tl::unexpected(result.error());
  Walk walk;
  walk.frames = std::move(result->frames);
  const rdw::FrameRecord& first = walk.frames.front();
  walk.start = {navmesh::toSpace(glm::vec2(first.virtualPosition), 0.0f),
                static_cast<float>(first.virtualHeading)};
  return walk;
}

int run(const Options& options) {
  const struct {
    const char* name;
    forewalk_controller controller;
    forewalk_method method;
    std::int32_t likelihoods;
  } kinds[] = {
      {"s2c-predictive, polygons", FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_METHOD_POLYGON, 0},
      {"the same, likelihoods", FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_METHOD_POLYGON, 1},
      {"s2c-predictive, fronts", FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_METHOD_FRONT, 0},
      {"foresight, polygons", FOREWALK_CONTROLLER_FORESIGHT, FOREWALK_METHOD_POLYGON, 0}};
  fmt::print("horizon {} m, {} threads, {} s of walk; microseconds of processor time a frame\n\n",
             options.horizon, options.threads, options.seconds);
  fmt::print("{:<12} {:<26} {:>7} {:>7} {:>7} {:>7}  {:>7}  {}\n", "scene", "session", "median",
             "p99", "p99.9", "worst", "resets", "hash");
  for (const std::string& name : options.scenes) {
    const std::filesystem::path bundled =
        std::filesystem::path(FOREWALK_ASSETS) / "scenes" / (name + ".obj");
    const std::filesystem::path scene =
        std::filesystem::exists(bundled) ? bundled : std::filesystem::path(name);
    const auto walk = walkIn(scene, options);
    if (!walk) {
      fmt::print(stderr, "{}\n", walk.error().message);
      return 1;
    }
    forewalk_navmesh* navmesh = nullptr;
    if (forewalk_navmesh_from_file(scene.string().c_str(), nullptr, &navmesh) != FOREWALK_OK) {
      fmt::print(stderr, "{}\n", forewalk_last_error());
      return 1;
    }
    for (const auto& kind : kinds) {
      forewalk_session_settings settings;
      forewalk_session_settings_init(&settings, sizeof settings);
      settings.controller = kind.controller;
      settings.method = kind.method;
      settings.likelihoods = kind.likelihoods;
      settings.horizon = options.horizon;
      settings.width = settings.depth = 5.0f;
      settings.has_start = 1;
      settings.start_floor = vector(walk->start.floor);
      settings.start_heading = walk->start.heading;
      std::vector<Played> played(options.threads);
      std::vector<std::thread> threads;
      for (Played& one : played) {
        threads.emplace_back([&] { one = play(navmesh, *walk, settings); });
      }
      for (std::thread& thread : threads) thread.join();
      std::vector<double> all;
      for (const Played& one : played) {
        if (!one.failure.empty()) {
          fmt::print(stderr, "{}: {}\n", name, one.failure);
          return 1;
        }
        if (one.hash != played.front().hash) {
          fmt::print(stderr, "{}: two threads walked the same and were told otherwise\n", name);
          return 1;
        }
        all.insert(all.end(), one.microseconds.begin(), one.microseconds.end());
      }
      fmt::print("{:<12} {:<26} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.0f}  {:>7}  {:016x}\n",
                 scene.stem().string(), kind.name, service::quantile(all, 0.5),
                 service::quantile(all, 0.99), service::quantile(all, 0.999),
                 service::quantile(all, 1.0), played.front().resets, played.front().hash);
    }
    forewalk_navmesh_release(navmesh);
  }
  return 0;
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  forewalk::bench::Options options;
  CLI::App app{"What a frame costs through the C interface, several users at once."};
  app.add_option("--horizon", options.horizon, "of prediction, metres")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "of walk")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "users at once, each on a thread")
      ->check(CLI::Range(1u, 64u))
      ->capture_default_str();
  app.add_option("--scene", options.scenes, "bundled ones by name, or files")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return forewalk::bench::run(options);
}
