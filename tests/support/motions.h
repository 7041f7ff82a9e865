// What controllers are told of somebody who walks at 1 m/s or turns, 60 frames a second.
#pragma once

#include <glm/glm.hpp>

#include "rdw/motion.h"

namespace forewalk::testing {

/// `turn`: of the head, radians a frame.
inline rdw::Motion turningOnTheSpot(double turn) {
  rdw::Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.turn = turn;
  motion.turnRate = turn * 60.0;
  return motion;
}

/// Along unit vector `direction`, physical.
inline rdw::Motion walking(glm::dvec2 direction, double turn = 0.0) {
  rdw::Motion motion = turningOnTheSpot(turn);
  motion.step = direction / 60.0;
  motion.distance = 1.0 / 60.0;
  motion.speed = 1.0;
  motion.walking = true;
  motion.walkingDirection = direction;
  return motion;
}

}  // namespace forewalk::testing
