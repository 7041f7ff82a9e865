#include "rdw/course.h"

#include <cmath>

#include "navmesh/random.h"

namespace forewalk::rdw {

namespace {

// Of a circle. Its turns are walked, not turned on the spot.
constexpr int kChords = 72;

}  // namespace

glm::dvec2 CoursePoints::next(std::mt19937_64& rng) {
  double length = course_.size;
  double turn = 0.0;  // after this leg
  switch (course_.kind) {
    case CourseKind::kSawtooth:
      turn = count_ % 2 == 0 ? course_.turn : -course_.turn;
      break;
    case CourseKind::kCircle:
    case CourseKind::kFigureEight: {
      const bool right = course_.kind == CourseKind::kFigureEight && count_ / kChords % 2 == 1;
      const double step = (right ? -2.0 : 2.0) * kPi / kChords;
      length = 2.0 * course_.size * std::sin(kPi / kChords);
      heading_ += 0.5 * step;  // a chord, between two tangents
      turn = 0.5 * step;
      break;
    }
    case CourseKind::kCorridors: {
      length *= 1.0 + navmesh::uniformInt(rng, 3);
      int side = navmesh::uniformInt(rng, 2) == 0 ? 1 : -1;
      if (same_ == 2 && side == side_) side = -side;
      same_ = side == side_ ? same_ + 1 : 1;
      side_ = side;
      turn = 0.5 * kPi * side;
      break;
    }
  }
  ++count_;
  at_ += length * directionOf(heading_);
  heading_ += turn;
  return at_;
}

}  // namespace forewalk::rdw
