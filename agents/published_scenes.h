// The scenes that the sources of the models name, as far as they are told.
//
// None of the sources gives positions: where things stand here is ours, drawn once by hand to the
// numbers that are given, and stays as it is so that results can be compared.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "agents/avatar_navigation.h"
#include "agents/scenes.h"

namespace forewalk::agents {

/// A box of an avatar's world; its number is its place in the scene, from 1.
struct AvatarObject {
  glm::vec2 centre, halfSize;  ///< metres
  float heading = 0.0f;        ///< radians
};

/// A scene of Ono's thesis: an avatar of radius 1 among boxes, which walks to `visits` (numbers of
/// objects) one after the other.
struct AvatarScene {
  std::string_view name;
  glm::vec2 start;
  std::span<const AvatarObject> objects;
  std::span<const std::uint32_t> visits;
};

/// The two initial scenes (one box in the way; a row of boxes with gaps) and the three test scenes
/// with 8, 10 and 20 objects. The numbers of objects are the thesis's, positions and sizes ours: no
/// two boxes leave a gap that an avatar would only just miss (2.2 to 2.6 m with the margin).
std::span<const AvatarScene> avatarScenes();

/// Puts a scene's objects into an avatar's world.
AvatarNavigation populate(const AvatarScene& scene, const AvatarParameters& parameters = {},
                          std::uint64_t seed = 1);

/// The city block of the virtual-agents paper: two streets that cross, a fountain in the middle
/// that nobody may cross, a patio with two pillars; 18 virtual agents, and 3 humans who walk to and
/// fro. Where everybody sets out and wants to go is drawn from the seed, in the areas of
/// assets/crowds/city_block.json. 60 x 50 m around the fountain.
CrowdScene cityBlockScene(std::uint64_t seed);

/// `count` agents on a circle of `radius` metres, each with its goal on the opposite side: all meet
/// in the middle, and there is room to pass between those who have arrived. Speeds of 1.1 to 1.5
/// m/s are drawn from the seed. Ours.
CrowdScene meetingScene(std::uint32_t count, float radius, std::uint64_t seed);

/// The cells to find paths over in it: the whole block, half a metre each.
CellSettings cityBlockCells();

}  // namespace forewalk::agents
