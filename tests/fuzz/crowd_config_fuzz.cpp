// The reader of crowd files on any bytes; what it accepts keeps the promises of its ranges.
#include "service/crowd_config.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forewalk::service;
  const auto config = parseCrowd(std::as_bytes(std::span<const std::uint8_t>(data, size)), "fuzz");
  if (config) {
    require(config->tick >= 0.001 && config->seconds <= 86400.0, "times are in range");
    require(!config->groups.empty(), "there is a group");
    for (const CrowdGroup& group : config->groups) {
      require(group.count >= 1 && group.count <= 100000, "a group has agents, and not too many");
      require(group.radius.x > 0.0f && group.radius.x <= group.radius.y, "bodies have a size");
      require(group.speed.x >= 0.0f && group.speed.x <= group.speed.y, "speeds are in order");
      require(config->makeModel(group.model) != nullptr, "every model can be made");
      require(
          group.start.kind != CrowdStart::Kind::points || group.start.points.size() >= group.count,
          "everybody has a start");
      require(group.goal.kind != CrowdGoal::Kind::visit || !group.goal.points.empty(),
              "a visit has a place");
    }
    for (const PlacedObstacle& obstacle : config->obstacles) {
      require(forewalk::navmesh::validate(obstacle.shape).has_value(), "obstacles are valid");
    }
  } else {
    requireSentence(config.error().message, "fuzz");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf(
      {R"({"format": "forewalk.crowd/1", "seconds": 10, "tick_s": 0.1, "model": "orca",
            "groups": [{"count": 5, "start": {"ring": [0, 0], "radius_m": 8}, "goal": "opposite"}],
            "measure": {"area": [-2, -2, 2, 2]}})",
       R"({"format": "forewalk.crowd/1", "models": {"caacd": {"mass": 2}, "hrvo": {}},
            "room": [[0, 0], [9, 0], [9, 9], [0, 9]], "walls": [[[1, 1], [2, 2], [3, 1]]],
            "obstacles": [{"circle": [5, 5], "radius_m": 1}, {"box": [7, 7], "size": [1, 2]},
              {"polygon": [[1, 7], [2, 7], [2, 8]], "velocity": [0.1, 0]}],
            "groups": [{"name": "a", "human": true, "start": {"points": [[1, 5]]},
              "goal": {"visit": [[2, 5], [1, 5]], "loop": true}},
              {"model": "social-forces", "count": 2, "radius_m": [0.2, 0.3], "friends": true,
               "start": {"area": [0, 0, 4, 4]}, "goal": {"follow": "a", "distance_m": 2}}]})",
       R"({"format": "forewalk.crowd/1", "scene": "museum.obj", "seed": 7, "projection": false,
            "groups": [{"count": 9, "start": "anywhere", "goal": "anywhere", "depart_s": 3},
              {"start": {"points": [[0, 0]]}, "goal": {"points": [[4, 4]]}, "height_m": 1}]})"});
}
