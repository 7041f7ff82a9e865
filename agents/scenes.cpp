#include "agents/scenes.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "navmesh/random.h"

namespace forewalk::agents {

std::vector<AgentId> populate(const CrowdScene& scene, ModelId model, Crowd& crowd) {
  crowd.setFixedWalls(scene.walls);
  for (const navmesh::Obstacle& obstacle : scene.obstacles) {
    (void)crowd.addObstacle(obstacle);  // a scene's obstacles are valid: they are ours
  }
  std::vector<AgentId> ids;
  for (const SceneAgent& agent : scene.agents) {
    AgentSpec spec = agent.spec;
    spec.model = model;
    const auto id = crowd.add(spec);
    ids.push_back(id ? *id : kNoAgent);
    if (id) crowd.setGoal(*id, agent.goal);
  }
  return ids;
}

bool allArrived(const CrowdScene& scene, std::span<const AgentId> ids, const Crowd& crowd) {
  const AgentsView agents = crowd.view();
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const glm::vec2 at = agents.position[crowd.indexOf(ids[k])];
    if (glm::distance(at, scene.agents[k].goal) > scene.arrivalRadius) return false;
  }
  return true;
}

CrowdScene circleScene(std::uint32_t count) {
  CrowdScene scene;
  scene.name = "circle " + std::to_string(count);
  const double radius = 200.0 / 6.0 * static_cast<double>(count) / 250.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2.0 * 3.14159265358979323846 * i / count;
    SceneAgent agent;
    agent.spec.position = glm::vec2(radius * std::cos(angle), radius * std::sin(angle));
    agent.spec.maximumSpeed = 2.0f;
    agent.goal = -agent.spec.position;
    agent.spec.heading = navmesh::headingOf(agent.goal);
    scene.agents.push_back(agent);
  }
  scene.arrivalRadius = 0.3f;
  return scene;
}

CrowdScene blocksScene(std::uint32_t side) {
  CrowdScene scene;
  scene.name = "blocks " + std::to_string(4 * side * side);
  scene.seconds = 0.25f;
  scene.arrivalRadius = 20.0f;
  for (const glm::vec2 quarter :
       {glm::vec2(1, 1), glm::vec2(-1, 1), glm::vec2(1, -1), glm::vec2(-1, -1)}) {
    navmesh::BoxObstacle block;
    block.centre = navmesh::toSpace(25.0f * quarter, 1.0f);
    block.halfSize = {15.0f, 1.0f, 15.0f};
    scene.obstacles.push_back(block);
    for (std::uint32_t i = 0; i < side; ++i) {
      for (std::uint32_t j = 0; j < side; ++j) {
        SceneAgent agent;
        agent.spec.position =
            quarter * (55.0f + 10.0f * glm::vec2(static_cast<float>(i), static_cast<float>(j)));
        agent.spec.radius = 2.0f;
        agent.spec.preferredSpeed = 1.0f;
        agent.spec.maximumSpeed = 2.0f;
        agent.goal = -75.0f * quarter;
        agent.spec.heading = navmesh::headingOf(agent.goal - agent.spec.position);
        scene.agents.push_back(agent);
      }
    }
  }
  return scene;
}

CrowdScene headOnScene() {
  CrowdScene scene;
  scene.name = "head-on";
  for (const float side : {-1.0f, 1.0f}) {
    SceneAgent agent;
    agent.spec.position = {4.0f * side, 0.0f};
    agent.goal = -agent.spec.position;
    agent.spec.heading = navmesh::headingOf(agent.goal);
    scene.agents.push_back(agent);
  }
  scene.arrivalRadius = 0.3f;
  return scene;
}

CrowdScene randomScene(std::uint32_t count, std::uint64_t seed) {
  CrowdScene scene;
  scene.name = "random " + std::to_string(count);
  std::mt19937_64 rng(seed);
  const double half = std::sqrt(static_cast<double>(count));
  const auto somewhere = [&] {
    const double x = navmesh::uniform(rng, -half, half);
    return glm::vec2(x, navmesh::uniform(rng, -half, half));
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    SceneAgent agent;
    agent.spec.position = somewhere();
    agent.spec.radius = static_cast<float>(navmesh::uniform(rng, 0.2, 0.3));
    agent.spec.preferredSpeed = static_cast<float>(navmesh::uniform(rng, 1.1, 1.5));
    agent.goal = somewhere();
    agent.spec.heading = navmesh::headingOf(agent.goal - agent.spec.position);
    scene.agents.push_back(agent);
  }
  scene.arrivalRadius = 0.3f;
  return scene;
}

std::span<const CaacdSet> caacdSets() {
  static constexpr CaacdSet kSets[] = {
      {1.0f, 1.0f, 0.06f}, {1.0f, 0.8f, 0.06f}, {2.0f, 0.4f, 0.06f}, {1.0f, 0.4f, 0.06f},
      {1.5f, 0.4f, 0.06f}, {2.0f, 0.4f, 0.02f}, {2.0f, 0.4f, 0.10f}, {2.0f, 0.4f, 0.20f},
      {2.0f, 0.8f, 0.20f}, {2.0f, 1.2f, 0.20f}};
  return kSets;
}

CrowdScene caacdScene(std::uint32_t avatars, float speed, std::uint64_t seed) {
  constexpr std::uint32_t kObstacles = 8;
  constexpr double kHalf = 60.0;
  constexpr float kApart = 8.0f;
  CrowdScene scene;
  scene.name = "caacd " + std::to_string(avatars);
  scene.seconds = 1.0f;
  scene.arrivalRadius = 0.5f;
  std::mt19937_64 rng(seed);
  std::vector<glm::vec2> obstacles, starts, goals;
  // A place with room to the obstacles and to the others of its kind.
  const auto place = [&](std::vector<glm::vec2>& others) {
    const auto hasRoom = [&](glm::vec2 at) {
      const auto clear = [&](glm::vec2 other) { return glm::distance(at, other) >= kApart; };
      return std::all_of(obstacles.begin(), obstacles.end(), clear) &&
             std::all_of(others.begin(), others.end(), clear);
    };
    glm::vec2 at;
    int tries = 0;
    do {
      const double x = navmesh::uniform(rng, -kHalf, kHalf);
      at = glm::vec2(x, navmesh::uniform(rng, -kHalf, kHalf));
    } while (!hasRoom(at) && ++tries < 10000);
    others.push_back(at);
  };
  for (std::uint32_t i = 0; i < kObstacles; ++i) place(obstacles);
  for (std::uint32_t i = 0; i < avatars; ++i) place(starts);
  for (std::uint32_t i = 0; i < avatars; ++i) place(goals);
  SceneAgent agent;
  agent.spec.radius = 1.0f;
  agent.spec.goalRadius = 0.5f;
  agent.spec.preferredSpeed = agent.spec.maximumSpeed = speed;
  for (std::uint32_t i = 0; i < avatars; ++i) {
    agent.spec.position = starts[i];
    agent.goal = goals[i];
    agent.spec.heading = navmesh::headingOf(agent.goal - agent.spec.position);
    scene.agents.push_back(agent);
  }
  agent.spec.flags = kStatic;
  agent.spec.heading = 0.0f;
  for (const glm::vec2 obstacle : obstacles) {
    agent.spec.position = agent.goal = obstacle;
    scene.agents.push_back(agent);
  }
  return scene;
}

CrowdScene mirrored(const CrowdScene& scene) {
  CrowdScene other = scene;
  other.name += " mirrored";
  const auto flip = [](glm::vec2 v) { return glm::vec2(-v.x, v.y); };
  for (SceneAgent& agent : other.agents) {
    agent.spec.position = flip(agent.spec.position);
    agent.spec.velocity = flip(agent.spec.velocity);
    agent.spec.heading = -agent.spec.heading;
    agent.goal = flip(agent.goal);
  }
  for (Wall& wall : other.walls) {
    // Free ground stays on the left: the walk turns round.
    wall = {flip(wall.to), flip(wall.from), wall.next,  wall.previous,      wall.clearance,
            wall.toHeight, wall.fromHeight, wall.reach, flip(wall.velocity)};
  }
  for (navmesh::Obstacle& obstacle : other.obstacles) {
    if (auto* box = std::get_if<navmesh::BoxObstacle>(&obstacle)) {
      box->centre.x = -box->centre.x;
      box->heading = -box->heading;
    } else if (auto* prism = std::get_if<navmesh::PrismObstacle>(&obstacle)) {
      for (glm::vec2& corner : prism->corners) corner = flip(corner);
      std::reverse(prism->corners.begin(), prism->corners.end());
    } else if (auto* cylinder = std::get_if<navmesh::CylinderObstacle>(&obstacle)) {
      cylinder->foot.x = -cylinder->foot.x;
    }
  }
  return other;
}

}  // namespace forewalk::agents
