#include "agents/published_scenes.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

constexpr AvatarObject kOneBox[] = {{{0.0f, 10.0f}, {2.0f, 1.0f}}, {{0.0f, 20.0f}, {0.5f, 0.5f}}};
constexpr std::uint32_t kToTheLast[] = {2};

constexpr AvatarObject kRow[] = {{{-10.5f, 10.0f}, {1.5f, 1.0f}},
                                 {{-3.5f, 10.0f}, {1.5f, 1.0f}},
                                 {{3.5f, 10.0f}, {1.5f, 1.0f}},
                                 {{10.5f, 10.0f}, {1.5f, 1.0f}},
                                 {{2.0f, 20.0f}, {0.5f, 0.5f}}};
constexpr std::uint32_t kBeyondTheRow[] = {5};

constexpr AvatarObject kEight[] = {
    {{-9.0f, -8.0f}, {1.0f, 1.0f}},        {{0.0f, -7.0f}, {2.0f, 0.8f}, 0.4f},
    {{9.0f, -8.0f}, {0.8f, 0.8f}},         {{-8.0f, 1.0f}, {1.2f, 1.5f}},
    {{1.0f, 1.0f}, {1.5f, 1.5f}, 0.7854f}, {{9.5f, 2.0f}, {1.0f, 2.0f}},
    {{-5.0f, 9.5f}, {1.5f, 0.7f}, -0.3f},  {{6.0f, 10.0f}, {1.0f, 1.0f}}};
constexpr std::uint32_t kEightVisits[] = {8, 1, 3, 7};

constexpr AvatarObject kTen[] = {
    {{-11.0f, -10.0f}, {1.0f, 1.0f}},     {{-1.0f, -11.0f}, {2.0f, 0.8f}},
    {{10.0f, -9.0f}, {1.0f, 1.0f}, 0.5f}, {{-5.5f, -3.0f}, {1.2f, 1.2f}},
    {{4.5f, -3.0f}, {1.5f, 1.0f}, 0.3f},  {{-11.0f, 4.0f}, {0.8f, 2.0f}},
    {{-0.5f, 4.5f}, {1.4f, 1.0f}},        {{11.0f, 3.0f}, {1.0f, 1.5f}},
    {{-6.0f, 11.5f}, {1.0f, 1.0f}},       {{6.0f, 11.0f}, {1.5f, 0.8f}, -0.4f}};
constexpr std::uint32_t kTenVisits[] = {10, 1, 8, 2, 9};

constexpr AvatarObject kTwenty[] = {
    {{-16.0f, -12.0f}, {1.0f, 1.0f}},      {{-8.0f, -12.5f}, {1.5f, 0.8f}},
    {{0.0f, -12.0f}, {1.0f, 1.0f}, 0.6f},  {{8.0f, -12.0f}, {0.8f, 1.5f}},
    {{16.0f, -12.5f}, {1.0f, 1.0f}},       {{-15.5f, -4.0f}, {1.2f, 0.8f}, 0.2f},
    {{-8.0f, -4.5f}, {1.0f, 1.0f}},        {{0.5f, -4.0f}, {1.5f, 1.0f}, -0.5f},
    {{8.5f, -4.0f}, {1.0f, 1.0f}},         {{16.0f, -4.0f}, {0.8f, 1.2f}},
    {{-16.0f, 4.0f}, {1.0f, 1.5f}},        {{-7.5f, 4.0f}, {1.2f, 1.2f}, 0.7854f},
    {{0.0f, 4.5f}, {0.8f, 0.8f}},          {{8.0f, 4.5f}, {1.5f, 0.8f}, 0.3f},
    {{15.5f, 4.0f}, {1.0f, 1.0f}},         {{-15.5f, 12.0f}, {1.0f, 1.0f}},
    {{-8.0f, 12.5f}, {1.5f, 1.0f}, -0.2f}, {{0.5f, 12.0f}, {1.0f, 1.0f}},
    {{8.0f, 12.0f}, {1.0f, 1.2f}, 0.4f},   {{16.0f, 12.5f}, {0.8f, 0.8f}}};
constexpr std::uint32_t kTwentyVisits[] = {20, 1, 5, 16, 13};

constexpr AvatarScene kScenes[] = {{"initial, a box in the way", {0.0f, 0.0f}, kOneBox, kToTheLast},
                                   {"initial, a row of boxes", {0.0f, 0.0f}, kRow, kBeyondTheRow},
                                   {"test 1, 8 objects", {-3.5f, -3.0f}, kEight, kEightVisits},
                                   {"test 2, 10 objects", {0.0f, 0.0f}, kTen, kTenVisits},
                                   {"test 3, 20 objects", {-4.0f, 0.0f}, kTwenty, kTwentyVisits}};

struct Area {
  glm::vec2 low, high;
};

// As in assets/crowds/city_block.json, whose z is our -y.
constexpr Area kEast{{20.0f, -5.0f}, {29.0f, 5.0f}}, kWest{{-29.0f, -5.0f}, {-20.0f, 5.0f}};
constexpr Area kNorth{{-5.0f, 15.0f}, {5.0f, 24.0f}}, kSouth{{-5.0f, -24.0f}, {5.0f, -15.0f}};
constexpr Area kPatio{{9.0f, -22.0f}, {18.0f, -8.0f}};

}  // namespace

std::span<const AvatarScene> avatarScenes() { return kScenes; }

AvatarNavigation populate(const AvatarScene& scene, const AvatarParameters& parameters,
                          std::uint64_t seed) {
  AvatarNavigation avatar(scene.start, parameters, seed);
  std::uint32_t id = 0;
  for (const AvatarObject& object : scene.objects) {
    // Ours, and valid.
    (void)avatar.setObject(ObjectId{++id}, object.centre, object.halfSize, object.heading);
  }
  return avatar;
}

CrowdScene cityBlockScene(std::uint64_t seed) {
  CrowdScene scene;
  scene.name = "city block";
  scene.arrivalRadius = 0.5f;
  std::mt19937_64 rng(seed);
  const glm::vec2 room[] = {{-30.0f, -25.0f}, {30.0f, -25.0f}, {30.0f, 25.0f}, {-30.0f, 25.0f}};
  appendLoop(room, glm::vec2(0.0f), scene.walls);
  const auto house = [&](glm::vec2 centre, glm::vec2 halfSize) {
    scene.obstacles.push_back(
        navmesh::BoxObstacle{navmesh::toSpace(centre, 2.0f), {halfSize.x, 2.0f, halfSize.y}});
  };
  house({-18.0f, 15.0f}, {11.0f, 9.0f});
  house({18.0f, 15.0f}, {11.0f, 9.0f});
  house({-18.0f, -15.0f}, {11.0f, 9.0f});
  house({25.0f, -15.0f}, {4.0f, 9.0f});
  const auto round = [&](glm::vec2 centre, float radius) {
    navmesh::CylinderObstacle pillar;
    pillar.foot = navmesh::toSpace(centre, 0.0f);
    pillar.radius = radius;
    scene.obstacles.push_back(pillar);
    return std::pair(centre, radius);
  };
  const std::pair<glm::vec2, float> pillars[] = {
      round({0.0f, 0.0f}, 2.5f), round({14.0f, -12.0f}, 0.5f), round({17.0f, -17.0f}, 0.5f)};

  std::vector<glm::vec2> starts, goals;
  const auto placeIn = [&](const Area& area, std::vector<glm::vec2>& others) {
    glm::vec2 at;
    const auto isFree = [&] {
      for (const auto& [centre, radius] : pillars) {
        if (glm::distance(at, centre) < radius + 0.5f) return false;
      }
      return std::all_of(others.begin(), others.end(),
                         [&](glm::vec2 other) { return glm::distance(at, other) > 1.2f; });
    };
    int tries = 0;
    do {
      const double x = navmesh::uniform(rng, area.low.x, area.high.x);
      at = glm::vec2(x, navmesh::uniform(rng, area.low.y, area.high.y));
    } while (!isFree() && ++tries < 1000);
    others.push_back(at);
    return at;
  };
  // Humans first: nobody starts where one stands.
  const auto human = [&](glm::vec2 from, glm::vec2 to, float speed) {
    SceneAgent agent;
    agent.spec.flags = kHuman;
    agent.spec.position = from;
    agent.spec.preferredSpeed = speed;
    agent.goal = to;
    agent.spec.heading = navmesh::headingOf(to - from);
    scene.agents.push_back(agent);
    starts.push_back(from);
  };
  human({-3.5f, 4.0f}, {-17.0f, 4.0f}, 1.0f);
  human({4.0f, -4.5f}, {4.0f, 20.0f}, 1.0f);
  human({12.0f, -5.0f}, {12.0f, -15.0f}, 0.8f);
  const auto walkers = [&](int count, const Area& from, const Area& to, double slow, double fast) {
    for (int k = 0; k < count; ++k) {
      SceneAgent agent;
      agent.spec.radius = static_cast<float>(navmesh::uniform(rng, 0.22, 0.28));
      agent.spec.preferredSpeed = static_cast<float>(navmesh::uniform(rng, slow, fast));
      agent.spec.goalRadius = 0.3f;
      agent.spec.position = placeIn(from, starts);
      agent.goal = placeIn(to, goals);
      agent.spec.heading = navmesh::headingOf(agent.goal - agent.spec.position);
      scene.agents.push_back(agent);
    }
  };
  walkers(5, kWest, kEast, 1.1, 1.5);
  walkers(5, kEast, kWest, 1.1, 1.5);
  walkers(4, kNorth, kSouth, 1.1, 1.5);
  walkers(4, kSouth, kPatio, 0.8, 1.1);
  return scene;
}

CrowdScene meetingScene(std::uint32_t count, float radius, std::uint64_t seed) {
  CrowdScene scene;
  scene.name = "meeting";
  scene.arrivalRadius = 0.5f;
  std::mt19937_64 rng(seed);
  for (std::uint32_t k = 0; k < count; ++k) {
    const double angle = 2.0 * 3.14159265358979323846 * k / count;
    SceneAgent agent;
    agent.spec.position = radius * glm::vec2(std::cos(angle), std::sin(angle));
    agent.spec.preferredSpeed = static_cast<float>(navmesh::uniform(rng, 1.1, 1.5));
    agent.goal = -agent.spec.position;
    agent.spec.heading = navmesh::headingOf(agent.goal);
    scene.agents.push_back(agent);
  }
  return scene;
}

CellSettings cityBlockCells() {
  CellSettings cells;
  cells.low = {-30.0f, -25.0f};
  cells.high = {30.0f, 25.0f};
  return cells;
}

}  // namespace forewalk::agents
