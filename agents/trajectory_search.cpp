#include "agents/trajectory_search.h"

#include <algorithm>
#include <cmath>

#include "agents/trajectory_geometry.h"

namespace forewalk::agents {
namespace {

// Bounds are sums in another order than what they bound: they count this much less.
constexpr float kShare = 1e-5f, kRest = 1e-6f;

// So many second halves are looked at in the order of their costs; if those are all taken, the
// place is crowded, and finding the next cheapest costs more than looking.
constexpr int kInOrder = 12;

}  // namespace

// Of dismissed ones: walks longer, then costs less, then comes first.
static bool outlasts(const TrajectoryChoice& a, const TrajectoryChoice& b) {
  if (b.kind == TrajectoryChoice::Kind::none) return true;
  if (a.hitPoint != b.hitPoint) return a.hitPoint > b.hitPoint;
  if (a.penalty != b.penalty) return a.penalty < b.penalty;
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

static bool beats(const TrajectoryChoice& a, const TrajectoryChoice& b) {
  if (a.penalty != b.penalty) return a.penalty < b.penalty;
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

// Who hits before the first point has not walked at all.
static TrajectoryChoice settled(const TrajectoryChoice& dismissed) {
  return dismissed.hitPoint > 1 ? dismissed : TrajectoryChoice{};
}

TrajectoryChoice TrajectorySearch::bestByScores() const {
  const std::uint32_t seconds =
      std::max<std::uint32_t>(1, static_cast<std::uint32_t>(problem_.second.size()));
  TrajectoryChoice best, dismissed;
  best.penalty = std::numeric_limits<float>::infinity();
  for (std::uint32_t i = 0; i < problem_.first.size(); ++i) {
    for (std::uint32_t j = 0; j < seconds; ++j) {
      const TrajectoryScore rated = score(i, j);
      const auto kind =
          rated.hitPoint ? TrajectoryChoice::Kind::dismissed : TrajectoryChoice::Kind::free;
      const TrajectoryChoice candidate{kind, i, j, rated.penalty, rated.hitPoint};
      if (rated.hitPoint == 0 && beats(candidate, best)) best = candidate;
      if (rated.hitPoint != 0 && outlasts(candidate, dismissed)) dismissed = candidate;
    }
  }
  return best.kind == TrajectoryChoice::Kind::free ? best : settled(dismissed);
}

TrajectoryChoice TrajectorySearch::best() {
  lookedAt_ = 0;
  hitEarly_.clear();
  const std::uint32_t firsts = static_cast<std::uint32_t>(problem_.first.size());
  ends_.resize(firsts);
  order_.resize(firsts);
  for (std::uint32_t i = 0; i < firsts; ++i) {
    ends_[i] = pathOfFirst(i);
    order_[i] = {costOf(ends_[i].course + boundAfter(ends_[i]),
                        ends_[i].speed + (secondPoints_ ? leastSecondSpeed_ : 0.0f)),
                 i};
  }
  std::sort(order_.begin(), order_.end(), [](const Order& a, const Order& b) {
    return a.bound != b.bound ? a.bound < b.bound : a.first < b.first;
  });
  gatherReachable(glm::vec2(0.0f), 0, firstPoints_, reachOfFirst_);

  TrajectoryChoice best, dismissed;
  best.penalty = std::numeric_limits<float>::infinity();
  for (const Order& next : order_) {
    const float bound = next.bound - (kShare * next.bound + kRest);
    if (bound > best.penalty) break;
    Near near;
    const std::uint32_t hit = lookAtFirst(next.first, near);
    if (hit != 0) {
      // Whatever would follow is dismissed with it. Which of those costs least is only of interest
      // when nothing is free.
      if (hitEarly_.empty() || hit >= latestEarlyHit_) {
        if (hitEarly_.empty() || hit > latestEarlyHit_) hitEarly_.clear();
        latestEarlyHit_ = hit;
        hitEarly_.push_back(next.first);
      }
      continue;
    }
    if (penaltyOf(bound, near) > best.penalty) continue;
    if (secondPoints_ > 0) {
      trySeconds(next.first, near, best, dismissed);
      continue;
    }
    const Path& end = ends_[next.first];
    const TrajectoryChoice candidate{TrajectoryChoice::Kind::free, next.first, 0,
                                     penaltyOf(costOf(end.course, end.speed), near), 0};
    if (beats(candidate, best)) best = candidate;
  }
  if (best.kind == TrajectoryChoice::Kind::free) return best;
  settleEarlyHits(dismissed);
  return settled(dismissed);
}

void TrajectorySearch::trySeconds(std::uint32_t first, const Near& before, TrajectoryChoice& best,
                                  TrajectoryChoice& dismissed) {
  const Path& end = ends_[first];
  costsOfSecond(end);
  const std::uint32_t seconds = static_cast<std::uint32_t>(problem_.second.size());
  open_.clear();
  for (std::uint32_t j = 0; j < seconds; ++j) {
    if (penaltyOf(cost_[j], before) <= best.penalty) open_.push_back(j);
  }
  if (open_.empty()) return;
  gatherReachable(end.place, firstPoints_, firstPoints_ + secondPoints_, reachOfSecond_);
  for (int looked = 0; !open_.empty(); ++looked) {
    std::size_t at = open_.size() - 1;
    if (looked < kInOrder) {
      for (std::size_t k = 0; k + 1 < open_.size(); ++k) {
        if (cost_[open_[k]] < cost_[open_[at]]) at = k;
      }
    }
    const std::uint32_t j = open_[at];
    open_[at] = open_.back();
    open_.pop_back();
    if (penaltyOf(cost_[j], before) > best.penalty) {
      if (looked < kInOrder) return;  // the cheapest is too dear
      continue;
    }
    ++lookedAt_;
    Near near = before;
    const std::uint32_t hit = lookAtSecond(j, end.place, near);
    if (hit != 0) {
      const TrajectoryChoice candidate{TrajectoryChoice::Kind::dismissed, first, j, cost_[j], hit};
      if (outlasts(candidate, dismissed)) dismissed = candidate;
    } else {
      const TrajectoryChoice candidate{TrajectoryChoice::Kind::free, first, j,
                                       penaltyOf(cost_[j], near), 0};
      if (beats(candidate, best)) best = candidate;
    }
  }
}

void TrajectorySearch::settleEarlyHits(TrajectoryChoice& dismissed) {
  if (hitEarly_.empty()) return;
  if (dismissed.kind != TrajectoryChoice::Kind::none && dismissed.hitPoint > latestEarlyHit_)
    return;
  const std::uint32_t seconds = static_cast<std::uint32_t>(problem_.second.size());
  for (const std::uint32_t i : hitEarly_) {
    const Path& end = ends_[i];
    TrajectoryChoice candidate{TrajectoryChoice::Kind::dismissed, i, 0,
                               costOf(end.course, end.speed), latestEarlyHit_};
    if (secondPoints_ > 0) {
      costsOfSecond(end);
      candidate.second = static_cast<std::uint32_t>(
          std::min_element(cost_.begin(), cost_.begin() + seconds) - cost_.begin());
      candidate.penalty = cost_[candidate.second];
    }
    if (outlasts(candidate, dismissed)) dismissed = candidate;
  }
}

// Course and speed of every second half after a first half that ends so, and its points. Plain
// loops over all of them, which the compiler turns into vector instructions.
void TrajectorySearch::costsOfSecond(const Path& end) {
  const std::size_t seconds = problem_.second.size();
  const float dx = end.direction.x, dy = end.direction.y;
  float* course = cost_.data();
  std::fill_n(course, seconds, 0.0f);
  for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
    const std::size_t row = (k - 1) * seconds;
    const float *x = secondX_.data() + row, *y = secondY_.data() + row;
    const float *turnedX = secondDirX_.data() + row, *turnedY = secondDirY_.data() + row;
    float *placeX = placeX_.data() + row, *placeY = placeY_.data() + row;
    const glm::vec2 straight = straight_[firstPoints_ + k];
    const float weight = pointWeight_[firstPoints_ + k], angular = angular_;
    const float towardsX = problem_.towards.x, towardsY = problem_.towards.y;
    for (std::size_t j = 0; j < seconds; ++j) {
      placeX[j] = end.place.x + turnedByX(x[j], y[j], dx, dy);
      placeY[j] = end.place.y + turnedByY(x[j], y[j], dx, dy);
    }
    if (angular == 0.0f) {
      for (std::size_t j = 0; j < seconds; ++j) {
        course[j] += weight * lengthOf(placeX[j] - straight.x, placeY[j] - straight.y);
      }
      continue;
    }
    for (std::size_t j = 0; j < seconds; ++j) {
      const float off = lengthOf(placeX[j] - straight.x, placeY[j] - straight.y);
      const float turned = lengthOf(turnedByX(turnedX[j], turnedY[j], dx, dy) - towardsX,
                                    turnedByY(turnedX[j], turnedY[j], dx, dy) - towardsY);
      course[j] += weight * (off + angular * turned);
    }
  }
  const float* speed = secondSpeed_.data();
  for (std::size_t j = 0; j < seconds; ++j) {
    course[j] = costOf(end.course + course[j], end.speed + speed[j]);
  }
}

// No point of a second half can be nearer to the straight walk than this, whatever the command.
float TrajectorySearch::boundAfter(const Path& end) const {
  float sum = 0.0f;
  for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
    const std::uint32_t point = firstPoints_ + k;
    const float off = lengthOf(end.place.x - straight_[point].x, end.place.y - straight_[point].y);
    const float reach = fastest_ * problem_.step * static_cast<float>(k);
    if (off > reach) sum += pointWeight_[point] * (off - reach);
  }
  return sum;
}

void TrajectorySearch::gatherReachable(glm::vec2 from, std::uint32_t fromPoint,
                                       std::uint32_t toPoint, Reach& reach) const {
  reach.discs.clear();
  reach.walls.clear();
  reach.starts.clear();
  for (std::uint32_t point = fromPoint + 1; point <= toPoint; ++point) {
    reach.starts.push_back({static_cast<std::uint32_t>(reach.discs.size()),
                            static_cast<std::uint32_t>(reach.walls.size())});
    const float walked = fastest_ * problem_.step * static_cast<float>(point - fromPoint) * 1.0001f;
    const glm::vec2* at = discAt_.data() + point * problem_.discs.size();
    for (std::uint32_t d = 0; d < problem_.discs.size(); ++d) {
      const float far = walked + discFar_[d];
      const glm::vec2 off = at[d] - from;
      if (off.x * off.x + off.y * off.y <= far * far) reach.discs.push_back(d);
    }
    for (std::uint32_t w = 0; w < problem_.walls.size(); ++w) {
      const float far = walked + wallFar_[w];
      const PredictedWall& wall = problem_.walls[w];
      const glm::vec2 seen = from - wall.velocity * (problem_.step * static_cast<float>(point));
      if (squaredDistanceTo(wall.from, wall.to, seen) <= far * far) reach.walls.push_back(w);
    }
  }
  reach.starts.push_back({static_cast<std::uint32_t>(reach.discs.size()),
                          static_cast<std::uint32_t>(reach.walls.size())});
}

bool TrajectorySearch::lookAround(const Reach& reach, std::uint32_t row, std::uint32_t point,
                                  glm::vec2 from, glm::vec2 to, Near& near) const {
  const Reach::Start begin = reach.starts[row], end = reach.starts[row + 1];
  for (std::uint32_t d = begin.discs; d < end.discs; ++d) {
    if (lookAtDisc(reach.discs[d], point, from, to, near)) return true;
  }
  for (std::uint32_t w = begin.walls; w < end.walls; ++w) {
    if (lookAtWall(reach.walls[w], point, from, to, near)) return true;
  }
  return false;
}

std::uint32_t TrajectorySearch::lookAtFirst(std::uint32_t first, Near& near) const {
  if (reachOfFirst_.empty()) return 0;
  const Turn turn = turnOf(problem_.first[first], problem_.step);
  glm::vec2 place(0.0f), direction = problem_.heading;
  for (std::uint32_t point = 1; point <= firstPoints_; ++point) {
    const glm::vec2 from = place;
    advance(turn, place, direction);
    if (lookAround(reachOfFirst_, point - 1, point, from, place, near)) return point;
  }
  return 0;
}

std::uint32_t TrajectorySearch::lookAtSecond(std::uint32_t second, glm::vec2 end,
                                             Near& near) const {
  if (reachOfSecond_.empty()) return 0;
  const std::size_t seconds = problem_.second.size();
  glm::vec2 place = end;
  for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
    const glm::vec2 from = place;
    place = {placeX_[(k - 1) * seconds + second], placeY_[(k - 1) * seconds + second]};
    if (lookAround(reachOfSecond_, k - 1, firstPoints_ + k, from, place, near)) {
      return firstPoints_ + k;
    }
  }
  return 0;
}

}  // namespace forewalk::agents
