// How long a moved obstacle takes to be in the graph, and what of it is tiles and what is joining
// them into one world. Obstacles wander over the bundled scenes, built in tiles of 6 m at 0.1 m.
// Times are those of the clock and, because machines are shared, of the processor as well. At the
// end the world is compared with one that is built from nothing.
#include <fmt/format.h>

#include <time.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "bench/timing.h"
#include "bench/worlds.h"
#include "navmesh/build/live_mesh.h"
#include "navmesh/random.h"
#include "rdw/session.h"
#include "service/live_world.h"
#include "tests/support/same_graph.h"

namespace forewalk::bench {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What this thread has used of a processor, milliseconds.
double processorMilliseconds() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return 1e3 * static_cast<double>(used.tv_sec) + 1e-6 * static_cast<double>(used.tv_nsec);
}

/// Whether the world is that of the obstacles in it, built from nothing and joined by the long way.
bool isRebuilt(const navmesh::World& world, const navmesh::TileSource& source,
               const std::vector<navmesh::Obstacle>& obstacles) {
  std::vector<std::shared_ptr<const navmesh::GridObstacle>> placed;
  std::vector<const navmesh::GridObstacle*> all;
  for (const navmesh::Obstacle& obstacle : obstacles) placed.push_back(source.place(obstacle));
  for (const auto& obstacle : placed) all.push_back(obstacle.get());
  std::vector<navmesh::DetourTile> tiles;
  for (std::size_t tile = 0; tile < source.tileCount(); ++tile) {
    auto built = source.build(tile, all);
    if (built && !built->empty()) tiles.push_back(std::move(*built));
  }
  const auto mesh = navmesh::polygonsFromTiles(tiles, source.settings().climb, source.name());
  if (!mesh) return false;
  auto graph = navmesh::makeNavGraph(*mesh);
  return graph && testing::differences(world, navmesh::makeWorld(std::move(*graph))).empty();
}

/// A place of the ground, uniform over polygons.
glm::vec3 somewhere(const navmesh::World& world, std::mt19937_64& rng) {
  const auto p = static_cast<std::uint32_t>(
      navmesh::uniformInt(rng, static_cast<int>(world.graph.polygonCount())));
  return navmesh::toSpace(world.graph.centroid[p], world.graph.centroidHeight[p]);
}

void measure(const std::string& name, navmesh::Scene scene, float tileSide, int moves) {
  navmesh::BuildSettings settings;
  settings.tile = tileSide;
  const auto source = navmesh::TileSource::make(scene, settings);
  auto made = navmesh::LiveMesh::make(std::move(scene), settings);
  if (!source || !made) {
    fmt::print(stderr, "{}\n", made.error().message);
    return;
  }
  navmesh::LiveMesh& mesh = *made;
  std::mt19937_64 rng(1);
  const auto empty = mesh.world();
  std::vector<navmesh::ObstacleChange> crowd;
  std::vector<navmesh::Obstacle> there;
  constexpr std::uint32_t kObstacles = 20;
  for (std::uint32_t i = 0; i < kObstacles; ++i) {
    there.push_back(navmesh::CylinderObstacle{somewhere(*empty, rng), 0.3f, 1.8f});
    crowd.push_back({navmesh::ObstacleId{i}, there.back()});
  }
  if (auto put = mesh.apply(crowd); !put) {
    fmt::print(stderr, "{}\n", put.error().message);
    return;
  }

  std::vector<double> all, processor, alone, tiles;
  for (int i = 0; i < moves; ++i) {
    const auto id = static_cast<std::uint32_t>(navmesh::uniformInt(rng, kObstacles));
    there[id] = navmesh::CylinderObstacle{somewhere(*empty, rng), 0.3f, 1.8f};
    const navmesh::ObstacleChange move{navmesh::ObstacleId{id}, there[id]};
    const auto start = Clock::now();
    const double used = processorMilliseconds();
    const auto update = mesh.apply({&move, 1});
    processor.push_back(processorMilliseconds() - used);
    all.push_back(millisecondsSince(start));
    if (!update) {
      fmt::print(stderr, "{}\n", update.error().message);
      return;
    }
    tiles.push_back(update->tilesBuilt);
    const auto placed = source->place(there[id]);
    const navmesh::GridObstacle* only = placed.get();
    for (const std::uint32_t tile : source->tilesTouchedBy(*placed)) {
      const double begin = processorMilliseconds();
      const auto built = source->build(tile, {&only, 1});
      alone.push_back(processorMilliseconds() - begin);
      if (!built) fmt::print(stderr, "{}\n", built.error().message);
    }
  }
  fmt::print(
      "{:<11} {:5g} {:5} {:8} | {:3.0f} {:3.0f} | {:6.2f} {:6.2f} {:6.2f} | {:6.2f} {:6.2f} "
      "{:6.2f} "
      "| {:6.2f} | {}\n",
      name, tileSide, mesh.tileCount(), mesh.world()->graph.polygonCount(), medianOf(tiles),
      quantileOf(tiles, 1.0), medianOf(all), quantileOf(all, 0.99), quantileOf(all, 1.0),
      medianOf(processor), quantileOf(processor, 0.99), quantileOf(processor, 1.0), medianOf(alone),
      isRebuilt(*mesh.world(), *source, there) ? "equal" : "DIFFERENT");
  std::fflush(stdout);
}

/// From change() to a frame that has it, and what taking it costs that frame.
void measurePublication(const std::string& name, const navmesh::Scene& scene, int moves) {
  service::LiveWorldSettings settings;
  settings.build.tile = 6.0f;
  const auto live = service::LiveWorld::make(scene, settings);
  if (!live) {
    fmt::print(stderr, "{}\n", live.error().message);
    return;
  }
  std::mt19937_64 rng(2);
  service::WorldReader reader = (*live)->readerForSession({});
  const auto empty = reader.version().world;
  rdw::SessionSettings sessionSettings;
  sessionSettings.start = rdw::VirtualStart{somewhere(*empty, rng), 0.0f};
  auto session = rdw::Session::make(empty, sessionSettings);
  if (!session) {
    fmt::print(stderr, "{}\n", session.error().message);
    return;
  }
  session->frame({{0.0f, 1.7f, 0.0f}, glm::quat(1, 0, 0, 0)}, 0.0);
  std::vector<double> latency, taking, idle;
  glm::vec3 place{0.0f};
  for (int i = 0; i < moves; ++i) {
    const glm::vec3 last = place;
    while (place == last) place = somewhere(*empty, rng);  // no move is no news
    const navmesh::ObstacleChange move{navmesh::ObstacleId{0},
                                       navmesh::CylinderObstacle{place, 0.3f, 1.8f}};
    const auto start = Clock::now();
    if (auto taken = (*live)->change({&move, 1}); !taken) {
      fmt::print(stderr, "{}\n", taken.error().message);
      return;
    }
    for (bool there = false; !there;) {
      const auto before = Clock::now();
      there = reader.update(*session);
      const double microseconds = 1e3 * millisecondsSince(before);
      (there ? taking : idle).push_back(microseconds);
      if (!there) std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    latency.push_back(millisecondsSince(start));
  }
  fmt::print("{:<14} {:7.2f} {:7.2f} | {:7.2f} {:7.2f} | {:7.3f}\n", name, medianOf(latency),
             quantileOf(latency, 0.99), medianOf(taking), quantileOf(taking, 0.99), medianOf(idle));
  std::fflush(stdout);
}

/// Ten people who walk about: what telling LiveWorld costs, where nothing changes and where it
/// does.
void measureStanding(const std::string& name, const navmesh::Scene& scene, int moves) {
  service::LiveWorldSettings settings;
  settings.build.tile = 6.0f;
  const auto live = service::LiveWorld::make(scene, settings);
  if (!live) {
    fmt::print(stderr, "{}\n", live.error().message);
    return;
  }
  service::WorldReader reader = (*live)->reader();
  std::mt19937_64 rng(3);
  std::vector<navmesh::Standing> people(10);
  std::vector<double> same, news;
  for (int i = 0; i < 20 * moves; ++i) {
    navmesh::Standing& one = people[static_cast<std::size_t>(navmesh::uniformInt(rng, 10))];
    one.foot = somewhere(*reader.version().world, rng);
    const double before = processorMilliseconds();
    const auto published = (*live)->setStanding(people);
    const double microseconds = 1e3 * (processorMilliseconds() - before);
    if (!published) return;
    (*published ? news : same).push_back(microseconds);
    reader.update();
  }
  fmt::print(
      "{:<14} {:7.2f} {:7.2f} | {:7.2f} {:7.2f} | {:5.1f} %\n", name, medianOf(same),
      quantileOf(same, 0.99), medianOf(news), quantileOf(news, 0.99),
      100.0 * static_cast<double>(news.size()) / static_cast<double>(news.size() + same.size()));
  std::fflush(stdout);
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  using namespace forewalk;
  CLI::App app("How long a moved obstacle takes to be in the graph");
  int moves = 400;
  app.add_option("--moves", moves, "of one obstacle a scene")->check(CLI::PositiveNumber);
  std::string only;
  app.add_option("--scene", only, "this one alone");
  CLI11_PARSE(app, argc, argv);

  const std::string scenes = FOREWALK_ASSETS "/scenes/";
  fmt::print("one of 20 cylinders (radius 0.3 m) moves to another place of the ground\n\n");
  fmt::print("{:<11} {:>5} {:>5} {:>8} | {:^7} | {:^20} | {:^20} | a tile | as\n", "", "tile", "",
             "", "touched", "until in graph, ms", "its processor, ms");
  fmt::print(
      "{:<11} {:>5} {:>5} {:>8} | {:>3} {:>3} | {:>6} {:>6} {:>6} | {:>6} {:>6} {:>6} | {:>6} | "
      "rebuilt\n",
      "scene", "m", "tiles", "polygons", "med", "max", "median", "p99", "worst", "median", "p99",
      "worst", "median");
  for (const std::string name : {"office", "museum", "two_storey", "corridor", "maze"}) {
    if (!only.empty() && only != name) continue;
    bench::measure(name, bench::sceneOf(scenes + name + ".obj"), 6.0f, moves);
  }
  const std::string real = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (!only.empty() && only != "nav_test") {
  } else if (std::filesystem::exists(real)) {
    bench::measure("nav_test", bench::sceneOf(real), 6.0f, moves);
  } else {
    fmt::print(stderr, "nav_test is left out: {} is not here\n", real);
  }
  if (!only.empty() && only != "campus") return 0;
  const navmesh::Scene campus = bench::sceneOf(scenes + "office.obj", 5, 8);
  bench::measure("campus", campus, 6.0f, moves);
  if (!only.empty()) return 0;
  bench::measure("campus", campus, 25.6f, moves / 4);

  fmt::print("\nthrough LiveWorld: one obstacle, one session\n\n");
  fmt::print("{:<14} {:^15} | {:^15} | no news\n", "", "until taken, ms", "taking it, us");
  fmt::print("{:<14} {:>7} {:>7} | {:>7} {:>7} | {:>7}\n", "scene", "median", "p99", "median",
             "p99", "us");
  for (const std::string name : {"office", "museum", "two_storey", "maze"}) {
    bench::measurePublication(name, bench::sceneOf(scenes + name + ".obj"), moves);
  }
  bench::measurePublication("campus", campus, moves / 4);

  fmt::print("\nten people stand about, one of them elsewhere (LiveWorld::setStanding)\n\n");
  fmt::print("{:<14} {:^15} | {:^15} | of the moves\n", "", "no news, us", "published, us");
  fmt::print("{:<14} {:>7} {:>7} | {:>7} {:>7} |\n", "scene", "median", "p99", "median", "p99");
  for (const std::string name : {"office", "museum", "two_storey", "maze"}) {
    bench::measureStanding(name, bench::sceneOf(scenes + name + ".obj"), moves);
  }
  bench::measureStanding("campus", campus, moves / 4);
}
