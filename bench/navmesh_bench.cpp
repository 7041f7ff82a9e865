// What the navmesh queries of a frame cost: where is the user, which way is it, what is the taut
// path.
//
// Scenes: a random navmesh, the bundled office and, where it is found, nav_test. The user walks
// taut paths between random goals at 1.4 m/s, 90 frames a second.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "bench/worlds.h"
#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
#include "navmesh/locate.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/zigzag.h"

namespace forewalk {
namespace {

using namespace navmesh;

constexpr float kSpeed = 1.4f;       // metres per second
constexpr float kFrame = 1.0f / 90;  // seconds
constexpr float kHead = 1.7f;        // metres above the floor
constexpr std::size_t kFrames = 50000;

struct Walked {
  std::string name;
  NavGraph graph;
  LocationIndex index;
  std::vector<Location> goals;
  Location start;
  std::vector<glm::vec3> heads;  // one a frame
};

std::shared_ptr<const Walked> walk(std::string name, NavGraph graph) {
  auto walked = std::make_shared<Walked>();
  walked->name = std::move(name);
  walked->graph = std::move(graph);
  walked->index = makeLocationIndex(walked->graph);
  walked->goals = testing::randomStarts(walked->graph, 1000, 1);
  // On the largest part, which most goals lie on.
  std::vector<int> goalsOn(walked->graph.componentCount, 0);
  const auto goalsBeside = [&](const Location& goal) -> int& {
    return goalsOn[walked->graph.component[index(goal.polygon)]];
  };
  for (const Location& goal : walked->goals) ++goalsBeside(goal);
  walked->start = *std::max_element(
      walked->goals.begin(), walked->goals.end(),
      [&](const Location& a, const Location& b) { return goalsBeside(a) < goalsBeside(b); });
  Location at = walked->start;
  CorridorScratch scratch;
  std::vector<std::uint32_t> corridor;
  std::vector<glm::vec2> path;
  for (std::size_t goal = 1; walked->heads.size() < kFrames; ++goal) {
    const Location& to = walked->goals[goal % walked->goals.size()];
    if (!findCorridor(walked->graph, at, to, scratch, corridor)) continue;
    pullString(walked->graph, at.plan, to.plan, corridor, path);
    float ahead = 0.0f;  // metres from the present leg's start to the next frame's place
    for (std::size_t leg = 1; leg < path.size(); ++leg) {
      const float length = glm::distance(path[leg - 1], path[leg]);
      for (; ahead < length; ahead += kSpeed * kFrame) {
        const glm::vec2 plan = glm::mix(path[leg - 1], path[leg], ahead / length);
        const auto place =
            locateFrom(walked->graph, walked->index, at, toSpace(plan, at.height + kHead));
        if (place) at = *place;
        walked->heads.push_back(toSpace(plan, at.height + kHead));
      }
      ahead -= length;
    }
  }
  return walked;
}

void locateWalkingUser(benchmark::State& state, const std::shared_ptr<const Walked>& walked) {
  // Each place is made where it stays, beside the last one. Assigning it within nanoseconds would
  // wait for bytes that are still on their way to the cache; in a frame, a million times longer,
  // nothing waits.
  std::array<std::optional<Location>, 2> places{walked->start, walked->start};
  std::size_t frame = 0, moved = 0, snapped = 0, lost = 0;
  for (auto _ : state) {
    std::optional<Location>& last = places[frame % 2];
    std::optional<Location>& now = places[1 - frame % 2];
    new (&now) std::optional<Location>(
        locateFrom(walked->graph, walked->index, *last, walked->heads[frame]));
    moved += now && now->polygon != last->polygon ? 1 : 0;
    snapped += now && now->snapped ? 1 : 0;
    ++frame;
    if (!now || frame == walked->heads.size()) {
      lost += now ? 0 : 1;
      frame = 0;
      places = {walked->start, walked->start};
    }
  }
  using benchmark::Counter;
  state.counters["moved"] = Counter(static_cast<double>(moved), Counter::kAvgIterations);
  state.counters["snapped"] = Counter(static_cast<double>(snapped), Counter::kAvgIterations);
  state.counters["lost"] = static_cast<double>(lost);
  state.counters["polygons"] = walked->graph.polygonCount();
}

void locateFromNothing(benchmark::State& state, const std::shared_ptr<const Walked>& walked) {
  std::vector<glm::vec3> heads;
  for (const Location& goal : walked->goals) {
    heads.push_back(toSpace(goal.plan, goal.height + kHead));
  }
  std::size_t i = 0, found = 0;
  for (auto _ : state) {
    const auto place = locate(walked->graph, walked->index, heads[i]);
    found += place && !place->snapped ? 1 : 0;
    if (++i == heads.size()) i = 0;
  }
  state.counters["found"] =
      benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}

void findCorridorAndPull(benchmark::State& state, const std::shared_ptr<const Walked>& walked) {
  CorridorScratch scratch;
  std::vector<std::uint32_t> corridor;
  std::vector<glm::vec2> path;
  std::size_t i = 0, ways = 0, portals = 0, waypoints = 0;
  double metres = 0.0;
  for (auto _ : state) {
    const Location& from = walked->goals[i];
    if (++i == walked->goals.size()) i = 0;
    const Location& to = walked->goals[i];
    if (!findCorridor(walked->graph, from, to, scratch, corridor)) continue;
    pullString(walked->graph, from.plan, to.plan, corridor, path);
    ++ways;
    portals += corridor.size();
    waypoints += path.size();
    metres += static_cast<double>(lengthOf(path));
  }
  const auto perWay = [&](double total) {
    return total / static_cast<double>(std::max<std::size_t>(ways, 1));
  };
  state.counters["portals"] = perWay(static_cast<double>(portals));
  state.counters["waypoints"] = perWay(static_cast<double>(waypoints));
  state.counters["metres"] = perWay(metres);
}

// How the cost of a taut path grows with its corridor. A zigzag moves the apex at every portal.
// Sizes: a room and its door, a floor, a stress case past any horizon.
void BM_PullString(benchmark::State& state) {
  const testing::Corridor corridor = testing::zigzag(static_cast<int>(state.range(0)));
  std::vector<glm::vec2> path;
  for (auto _ : state) {
    pullString(corridor.start, corridor.goal, corridor.portals, path);
    benchmark::DoNotOptimize(path.data());
  }
  state.counters["waypoints"] = static_cast<double>(path.size());
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_PullString)->ArgName("portals")->Arg(4)->Arg(32)->Arg(512);

std::vector<std::shared_ptr<const Walked>> scenes() {
  std::vector<std::shared_ptr<const Walked>> all;
  testing::RandomMeshOptions rooms;
  rooms.cell = 1.5f;
  all.push_back(walk("random", *makeNavGraph(testing::randomMesh(1, 60, 60, rooms))));
  const auto addBuilt = [&](const std::string& name, const std::string& file) {
    if (std::filesystem::exists(file))
      all.push_back(walk(name, bench::buildWorld(name, file, {}).graph));
  };
  addBuilt("office", FOREWALK_ASSETS "/scenes/office.obj");
  addBuilt("nav_test", FOREWALK_SHARED_DATA "/scenes/nav_test.obj");
  return all;
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const auto& scene : forewalk::scenes()) {
    benchmark::RegisterBenchmark(("locateFrom/walking/" + scene->name).c_str(),
                                 forewalk::locateWalkingUser, scene);
    benchmark::RegisterBenchmark(("locate/from_nothing/" + scene->name).c_str(),
                                 forewalk::locateFromNothing, scene);
    benchmark::RegisterBenchmark(("findCorridor_pullString/" + scene->name).c_str(),
                                 forewalk::findCorridorAndPull, scene);
  }
  benchmark::RunSpecifiedBenchmarks();
}
