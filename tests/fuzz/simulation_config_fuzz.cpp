// The reader of simulation files on any bytes; what it accepts keeps the promises of its ranges.
#include "rdw/other_user.h"
#include "rdw/simulation_config.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = forewalk::rdw::parseSimulation(
      std::as_bytes(std::span<const std::uint8_t>(data, size)), "fuzz");
  if (file) {
    const forewalk::rdw::SimulationConfig& simulation = file->simulation;
    require(simulation.rate >= 5.0 && simulation.rate <= 1000.0, "the rate is in range");
    require(simulation.session.horizon > 0.0f && simulation.session.horizon <= 1000.0f,
            "the horizon is in range");
    require(simulation.stop.virtualMetres > 0.0 && simulation.stop.seconds > 0.0,
            "stops are positive");
    require(simulation.user.walker.speed > 0.0 && simulation.user.walker.speed <= 5.0,
            "the speed is in range");
    std::size_t users = 0;
    for (const auto& user : file->users) users += user.count;
    require(users >= 1 && users <= forewalk::rdw::kMostOthers + 1, "some walk, not too many");
    require(simulation.session.space.area() > 0.0, "the space has an area");
    require(forewalk::rdw::validate(simulation.session.limits).has_value(), "limits can work");
  } else {
    requireSentence(file.error().message, "fuzz");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf(
      {R"({"format": "forewalk.simulation/1", "scene": "a.obj", "user": {"kind": "wander"},
            "limits": {"preset": "toolkit", "rotation_max": 1.3}, "space": {"rectangle": [6, 6]}})",
       R"({"format": "forewalk.simulation/1", "space": {"polygon": [[0,0],[4,0],[4,-4],[0,-4]],
            "holes": [[[1,-1],[2,-1],[2,-2]]]}, "controller": "s2o", "seed": 7,
            "user": {"kind": "waypoints", "waypoints": [[0,0,0],[1,0,-1]], "loop": true}})",
       R"({"format": "forewalk.simulation/1", "rate_hz": 60, "stop": {"virtual_m": 10},
            "build": {"slope_deg": 30, "partition": "layers"}, "reset": {"clearance_m": 0.5},
            "start": {"position": [0,0,0], "heading_deg": 90}, "physical_start": {"position": [1,1]},
            "user": {"kind": "legs", "turn": "uniform", "speed_m_per_s": 1.2}})",
       R"({"format": "forewalk.simulation/1", "user": {"kind": "recorded", "walks": "w.csv"}})",
       R"({"format": "forewalk.simulation/1", "user": {"share": "world", "together": [
            {"kind": "recorded", "walks": "p.csv", "intervals": "t.csv"},
            {"kind": "waypoints", "waypoints": "p.csv"}, {"kind": "circle", "count": 3}]}})"});
}
