// One trajectory, rated by itself; and the tables that all share.
#include <algorithm>
#include <cmath>

#include "agents/trajectory_geometry.h"
#include "agents/trajectory_search.h"

namespace forewalk::agents {

float factorOfWeight(float weight) {
  return weight >= 0.0f ? 1.0f + 0.1f * weight : 1.0f / (1.0f - 0.1f * weight);
}

TrajectorySearch::Turn TrajectorySearch::turnOf(Command command, float step) {
  const float half = 0.5f * command.angular * step;
  const float sine = std::sin(half);
  // The chord of an arc is shorter than it by sin(x)/x of half the turn.
  const float shortened = std::abs(half) < 1e-3f ? 1.0f - half * half / 6.0f : sine / half;
  return {{std::cos(half), sine}, command.linear * step * shortened};
}

void TrajectorySearch::advance(const Turn& turn, glm::vec2& place, glm::vec2& direction) {
  const glm::vec2 middle = rotatedBy(direction, turn.half);
  place += turn.chord * middle;
  direction = rotatedBy(middle, turn.half);
}

void TrajectorySearch::prepare(const TrajectoryProblem& problem) {
  problem_ = problem;
  const std::uint32_t points = std::clamp(problem.points, 1u, kMostPoints);
  problem_.points = points;
  firstPoints_ = problem.second.empty() ? points : (points + 1) / 2;
  secondPoints_ = points - firstPoints_;
  if (secondPoints_ == 0) problem_.second = {};
  const bool somewhere = problem.towards != glm::vec2(0.0f);
  angular_ =
      problem.weights.angular && somewhere ? factorOfWeight(problem.weights.angularWeight) : 0.0f;
  fastest_ = 0.0f;
  for (const Command& command : problem_.first) fastest_ = std::max(fastest_, command.linear);
  for (const Command& command : problem_.second) fastest_ = std::max(fastest_, command.linear);
  prepareStraight();
  prepareSeconds();
  prepareSurroundings();
}

void TrajectorySearch::reserve(std::size_t first, std::size_t second, std::size_t points,
                               std::size_t discs, std::size_t walls) {
  straight_.reserve(points + 1);
  straightSpeed_.reserve(points + 1);
  pointWeight_.reserve(points + 1);
  discAt_.reserve((points + 1) * discs);
  discFar_.reserve(discs);
  wallFar_.reserve(walls);
  for (auto* row : {&secondX_, &secondY_, &secondDirX_, &secondDirY_, &placeX_, &placeY_}) {
    row->reserve(second * points);
  }
  secondSpeed_.reserve(second);
  cost_.reserve(second);
  open_.reserve(second);
  ends_.reserve(first);
  order_.reserve(first);
  hitEarly_.reserve(first);
  for (Reach* reach : {&reachOfFirst_, &reachOfSecond_}) {
    reach->discs.reserve(points * discs);
    reach->walls.reserve(points * walls);
    reach->starts.reserve(points + 1);
  }
}

// The walk that the course is compared with, and what could be worst.
void TrajectorySearch::prepareStraight() {
  const std::size_t size = problem_.points + 1;
  straight_.assign(size, glm::vec2(0.0f));
  straightSpeed_.assign(size, 0.0f);
  pointWeight_.assign(size, 1.0f);
  const float last = factorOfWeight(problem_.weights.futureWeight);
  const float comfort = problem_.towards == glm::vec2(0.0f) ? 0.0f : problem_.comfortSpeed;
  float worstCourse = 0.0f, worstSpeed = 0.0f, before = 0.0f;
  for (std::uint32_t point = 1; point <= problem_.points; ++point) {
    const float seconds = problem_.step * static_cast<float>(point);
    const float walked = std::min(comfort * seconds, problem_.remaining);
    straight_[point] = problem_.towards * walked;
    straightSpeed_[point] = (walked - before) / problem_.step;
    before = walked;
    if (problem_.points > 1) {
      pointWeight_[point] = 1.0f + (last - 1.0f) * static_cast<float>(point - 1) /
                                       static_cast<float>(problem_.points - 1);
    }
    worstCourse += pointWeight_[point] * (walked + fastest_ * seconds + 2.0f * angular_);
    worstSpeed += std::max(straightSpeed_[point], std::abs(fastest_ - straightSpeed_[point]));
  }
  courseScale_ = worstCourse > 0.0f ? 1.0f / worstCourse : 0.0f;
  speedScale_ = worstSpeed > 0.0f ? 1.0f / worstSpeed : 0.0f;
}

void TrajectorySearch::prepareSeconds() {
  const std::size_t seconds = problem_.second.size();
  const std::size_t size = seconds * secondPoints_;
  for (auto* row : {&secondX_, &secondY_, &secondDirX_, &secondDirY_, &placeX_, &placeY_}) {
    row->resize(size);
  }
  secondSpeed_.assign(seconds, 0.0f);
  cost_.resize(seconds);
  leastSecondSpeed_ = std::numeric_limits<float>::infinity();
  for (std::size_t j = 0; j < seconds; ++j) {
    const Turn turn = turnOf(problem_.second[j], problem_.step);
    glm::vec2 place(0.0f), direction(0.0f, 1.0f);
    for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
      advance(turn, place, direction);
      const std::size_t at = (k - 1) * seconds + j;
      secondX_[at] = place.x;
      secondY_[at] = place.y;
      secondDirX_[at] = direction.x;
      secondDirY_[at] = direction.y;
      secondSpeed_[j] += std::abs(problem_.second[j].linear - straightSpeed_[firstPoints_ + k]);
    }
    leastSecondSpeed_ = std::min(leastSecondSpeed_, secondSpeed_[j]);
  }
}

// Where everybody will be at each point, and from how far on they do not matter: further than
// contact or the personal space and what both may walk from one point to the next.
void TrajectorySearch::prepareSurroundings() {
  const TrajectoryWeights& weights = problem_.weights;
  const auto farFrom = [&](float contact, float hit, float space, glm::vec2 velocity) {
    const float both = (fastest_ + lengthOf(velocity.x, velocity.y)) * problem_.step;
    return std::max(hit + both, contact + space) * 1.0001f + 1e-4f;
  };
  discAt_.resize((problem_.points + 1) * problem_.discs.size());
  discFar_.resize(problem_.discs.size());
  wallFar_.resize(problem_.walls.size());
  for (std::size_t d = 0; d < problem_.discs.size(); ++d) {
    const PredictedDisc& disc = problem_.discs[d];
    discFar_[d] = farFrom(disc.contact, disc.hit,
                          disc.agent ? weights.agentSpace : weights.obstacleSpace, disc.velocity);
    for (std::uint32_t point = 0; point <= problem_.points; ++point) {
      discAt_[point * problem_.discs.size() + d] =
          disc.position + disc.velocity * (problem_.step * static_cast<float>(point));
    }
  }
  for (std::size_t w = 0; w < problem_.walls.size(); ++w) {
    const PredictedWall& wall = problem_.walls[w];
    wallFar_[w] = farFrom(wall.contact, wall.hit, weights.obstacleSpace, wall.velocity);
  }
}

float TrajectorySearch::courseAt(std::uint32_t point, glm::vec2 place, glm::vec2 direction) const {
  const float off = lengthOf(place.x - straight_[point].x, place.y - straight_[point].y);
  if (angular_ == 0.0f) return pointWeight_[point] * off;
  const float turned = lengthOf(direction.x - problem_.towards.x, direction.y - problem_.towards.y);
  return pointWeight_[point] * (off + angular_ * turned);
}

float TrajectorySearch::costOf(float course, float speed) const {
  return problem_.weights.course * (course * courseScale_) +
         problem_.weights.speed * (speed * speedScale_);
}

float TrajectorySearch::penaltyOf(float cost, const Near& near) const {
  return (cost + problem_.weights.agents * near.agents) +
         problem_.weights.obstacles * near.obstacles;
}

TrajectorySearch::Path TrajectorySearch::pathOfFirst(std::uint32_t first) const {
  const Command command = problem_.first[first];
  const Turn turn = turnOf(command, problem_.step);
  Path path;
  path.direction = problem_.heading;
  for (std::uint32_t point = 1; point <= firstPoints_; ++point) {
    advance(turn, path.place, path.direction);
    path.course += courseAt(point, path.place, path.direction);
    path.speed += std::abs(command.linear - straightSpeed_[point]);
  }
  return path;
}

// 1 at contact, 0 beyond the space; more than 1 only where bodies that overlap are allowed to part.
static float nearness(float distance, float contact, float space) {
  return std::max((contact + space - distance) / space, 0.0f);
}

bool TrajectorySearch::lookAtDisc(std::uint32_t which, std::uint32_t point, glm::vec2 from,
                                  glm::vec2 to, Near& near) const {
  const std::size_t discs = problem_.discs.size();
  const glm::vec2 after = to - discAt_[point * discs + which];
  const float squared = after.x * after.x + after.y * after.y;
  const float far = discFar_[which];
  if (squared > far * far) return false;
  const PredictedDisc& disc = problem_.discs[which];
  const glm::vec2 before = from - discAt_[(point - 1) * discs + which];
  if (squared < disc.keep * disc.keep) return true;
  if (squaredDistanceToOrigin(before, after) < disc.hit * disc.hit) return true;
  const float space = disc.agent ? problem_.weights.agentSpace : problem_.weights.obstacleSpace;
  const float reach = disc.contact + space;
  if (squared >= reach * reach) return false;
  float& worst = disc.agent ? near.agents : near.obstacles;
  worst = std::max(worst, nearness(std::sqrt(squared), disc.contact, space));
  return false;
}

bool TrajectorySearch::lookAtWall(std::uint32_t which, std::uint32_t point, glm::vec2 from,
                                  glm::vec2 to, Near& near) const {
  const PredictedWall& wall = problem_.walls[which];
  // As the wall sees it, which may move.
  const glm::vec2 before = from - wall.velocity * (problem_.step * static_cast<float>(point - 1));
  const glm::vec2 after = to - wall.velocity * (problem_.step * static_cast<float>(point));
  const float squared = squaredDistanceTo(wall.from, wall.to, after);
  const float far = wallFar_[which];
  if (squared > far * far) return false;
  if (squared < wall.keep * wall.keep) return true;
  if (squaredDistanceBetween(before, after, wall.from, wall.to) < wall.hit * wall.hit) return true;
  const float space = problem_.weights.obstacleSpace;
  const float reach = wall.contact + space;
  if (squared >= reach * reach) return false;
  near.obstacles = std::max(near.obstacles, nearness(std::sqrt(squared), wall.contact, space));
  return false;
}

glm::vec2 TrajectorySearch::secondPlace(const Path& end, std::uint32_t k,
                                        std::uint32_t second) const {
  const std::size_t at = (k - 1) * problem_.second.size() + second;
  const glm::vec2 d = end.direction;
  return {end.place.x + turnedByX(secondX_[at], secondY_[at], d.x, d.y),
          end.place.y + turnedByY(secondX_[at], secondY_[at], d.x, d.y)};
}

TrajectoryScore TrajectorySearch::score(std::uint32_t first, std::uint32_t second) const {
  const Path end = pathOfFirst(first);
  TrajectoryScore result;
  Near near;
  const auto look = [&](std::uint32_t point, glm::vec2 from, glm::vec2 to) {
    if (result.hitPoint != 0) return;
    bool hit = false;
    for (std::uint32_t d = 0; d < problem_.discs.size(); ++d) {
      hit = lookAtDisc(d, point, from, to, near) || hit;
    }
    for (std::uint32_t w = 0; w < problem_.walls.size(); ++w) {
      hit = lookAtWall(w, point, from, to, near) || hit;
    }
    if (hit) result.hitPoint = point;
  };
  const Turn turn = turnOf(problem_.first[first], problem_.step);
  glm::vec2 place(0.0f), direction = problem_.heading;
  for (std::uint32_t point = 1; point <= firstPoints_; ++point) {
    const glm::vec2 from = place;
    advance(turn, place, direction);
    look(point, from, place);
  }
  float course = 0.0f, speed = 0.0f;
  for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
    const glm::vec2 from = place;
    place = secondPlace(end, k, second);
    const std::size_t at = (k - 1) * problem_.second.size() + second;
    const glm::vec2 d = end.direction;
    course += courseAt(firstPoints_ + k, place,
                       {turnedByX(secondDirX_[at], secondDirY_[at], d.x, d.y),
                        turnedByY(secondDirX_[at], secondDirY_[at], d.x, d.y)});
    look(firstPoints_ + k, from, place);
  }
  if (secondPoints_ > 0) speed = secondSpeed_[second];
  result.course = (end.course + course) * courseScale_;
  result.speed = (end.speed + speed) * speedScale_;
  result.agents = near.agents;
  result.obstacles = near.obstacles;
  const float cost = costOf(end.course + course, end.speed + speed);
  result.penalty = result.hitPoint != 0 ? cost : penaltyOf(cost, near);
  return result;
}

void TrajectorySearch::trace(std::uint32_t first, std::uint32_t second,
                             std::vector<glm::vec2>& points) const {
  points.clear();
  const Turn turn = turnOf(problem_.first[first], problem_.step);
  Path end;
  end.direction = problem_.heading;
  for (std::uint32_t point = 1; point <= firstPoints_; ++point) {
    advance(turn, end.place, end.direction);
    points.push_back(end.place);
  }
  for (std::uint32_t k = 1; k <= secondPoints_; ++k) {
    points.push_back(secondPlace(end, k, second));
  }
}

}  // namespace forewalk::agents
