// Scenes that crowds are compared on, as values: who stands where, wants to go where, and what is
// in the way.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "agents/crowd.h"

namespace forewalk::agents {

struct SceneAgent {
  AgentSpec spec;  ///< its model is set when the scene is put into a crowd
  glm::vec2 goal{0.0f};
};

struct CrowdScene {
  std::string name;
  std::vector<SceneAgent> agents;
  std::vector<navmesh::Obstacle> obstacles;
  std::vector<Wall> walls;     ///< fixed ones; walls.h
  float seconds = 0.1f;        ///< the tick it is published with
  float arrivalRadius = 0.1f;  ///< counted as arrived when so near to the goal, metres
};

/// Adds the scene's walls, obstacles and agents, all with `model`. Returns their ids, in order.
std::vector<AgentId> populate(const CrowdScene& scene, ModelId model, Crowd& crowd);

/// Whether all are within the scene's arrival radius of their goals.
bool allArrived(const CrowdScene& scene, std::span<const AgentId> ids, const Crowd& crowd);

/// `count` agents of radius 0.25 m and 1.3 m/s on a circle, each with its goal on the opposite
/// side: the circle example of the RVO2 library at a sixth of its size (0.84 m of the circle for
/// each).
CrowdScene circleScene(std::uint32_t count);

/// The blocks example of the RVO2 library as it is: four square blocks of 30 m with streets of 20 m
/// between them, and in each corner side x side agents of radius 2 m who go to the opposite corner
/// (side 5: 100 agents, 8: 256). Arrived within 20 m.
CrowdScene blocksScene(std::uint32_t side);

/// Two who walk towards each other in exact symmetry, 8 m apart.
CrowdScene headOnScene();

/// `count` agents at random places in a square with 4 m^2 each, with random goals in it.
CrowdScene randomScene(std::uint32_t count, std::uint64_t seed);

/// A set of parameters that CAACD was published with. Units of its world: 1 m and 1 s stand for its
/// unit of length and its frame.
struct CaacdSet {
  float mass;   ///< 1.0 to 2.0
  float speed;  ///< the largest, m/s: 0.4 to 1.2
  float force;  ///< the largest, mass * m/s^2: 0.02 to 0.20
};

/// Ten sets over the published ranges. The three that the source names come first: the two that it
/// found bad, then the one it found best; the other seven are one-by-one changes of that.
std::span<const CaacdSet> caacdSets();

/// The world that CAACD's collisions were counted in, as far as it was published: 120 x 120,
/// 1000 frames, 8 obstacles. What was not, declared here: bodies and obstacles of radius 1, all at
/// random places with 8 (the alert distance) from centre to centre, each avatar with one random
/// target that has as much room, where it stays. Obstacles are agents with kStatic. The step is 1
/// s.
CrowdScene caacdScene(std::uint32_t avatars, float speed, std::uint64_t seed);

/// The same scene seen in a mirror: x becomes -x. Walls and obstacles too.
CrowdScene mirrored(const CrowdScene& scene);

}  // namespace forewalk::agents
