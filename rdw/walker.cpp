#include "rdw/walker.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <random>
#include <string_view>
#include <utility>

#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

using navmesh::Location;
using navmesh::PolygonId;
using navmesh::uniform;
using navmesh::World;

constexpr double kArrived = 0.01;   // metres; nearer than this a waypoint is reached
constexpr double kPassed = 0.25;    // the same for whoever makes way for others
constexpr double kWaiting = 0.05;   // m/s; whoever makes way and is left no more stands
constexpr double kStrayed = 0.3;    // metres beside the planned way at which it is planned anew
constexpr double kOverturn = 1e-4;  // radians turned beyond the end of a reset, so that
                                    // rounding cannot leave a remainder nobody turns
constexpr double kOverstep = 1e-4;  // metres stepped back beyond the end, for the same reason
constexpr double kStandingSpeed = 0.05;  // m/s; slower frames of a recording are standing
constexpr double kHurry = 5.0;           // m/s; a recorded walker who is behind the recording
constexpr int kGoalDraws = 32;           // then a near goal is taken
constexpr int kEventsPerFrame = 64;      // arrivals and turns; no honest frame has more

double distanceToSegment(glm::dvec2 point, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 way = b - a;
  const double squared = glm::dot(way, way);
  const double along =
      squared > 0.0 ? std::clamp(glm::dot(point - a, way) / squared, 0.0, 1.0) : 0.0;
  return glm::distance(point, a + along * way);
}

tl::unexpected<Error> refused(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

/// A setting and the closed range it has to lie in.
struct Ranged {
  std::string_view name;
  double value, low, high;
  std::string_view unit;
};

std::optional<Error> firstOutOfRange(std::span<const Ranged> settings) {
  for (const Ranged& setting : settings) {
    if (setting.value >= setting.low && setting.value <= setting.high) continue;  // false for NaN
    return Error{
        ErrorCode::kSettingOutOfRange,
        fmt::format("user: {} is {:.6g} {}, it has to lie in [{:.6g}, {:.6g}] {}.", setting.name,
                    setting.value, setting.unit, setting.low, setting.high, setting.unit)};
  }
  return std::nullopt;
}

std::optional<Error> validate(const WalkerSettings& s) {
  const std::array<Ranged, 14> settings{{
      {"speed", s.speed, 0.01, 5.0, "m/s"},
      {"turn rate", s.turnRate, 0.01, 4.0 * kPi, "rad/s"},
      {"stop angle", s.stopAngle, 0.01, kPi, "rad"},
      {"reaction time", s.reactionTime, 0.0, 2.0, "s"},
      {"acceleration", s.acceleration, 0.1, 1e9, "m/s^2"},
      {"deceleration", s.deceleration, 0.1, 1e9, "m/s^2"},
      {"shortest pause", s.pauseMin, 0.0, 600.0, "s"},
      {"longest pause", s.pauseMax, s.pauseMin, 600.0, "s"},
      {"look amplitude", s.lookAmplitude, 0.0, 0.5 * kPi, "rad"},
      {"look period", s.lookPeriod, 0.5, 60.0, "s"},
      {"bob", s.bob, 0.0, 0.2, "m"},
      {"sway", s.sway, 0.0, 0.2, "m"},
      {"eye height", s.eyeHeight, 0.2, 3.0, "m"},
      {"corner margin", s.cornerMargin, 0.0, 2.0, "m"},
  }};
  return firstOutOfRange(settings);
}

/// Finds ways over the navmesh; straight ones where there is none.
class Router {
 public:
  Router(std::shared_ptr<const World> world, double cornerMargin)
      : world_(std::move(world)), cornerMargin_(cornerMargin) {
    if (world_ != nullptr) findWallCorners();
  }

  const World* world() const { return world_.get(); }
  void setStates(std::shared_ptr<const navmesh::PolygonStates> states) {
    states_ = std::move(states);
  }

  /// Replaces `path` with the points to walk to, `from` left out, `to` the last.
  void route(const Location& from, const Location& to, std::vector<glm::dvec2>& path) {
    path.clear();
    if (world_ != nullptr && findWay(from, to)) {
      navmesh::pullString(from.plan, to.plan, portals_, taut_);
      for (std::size_t i = 1; i < taut_.size(); ++i) path.emplace_back(taut_[i]);
    }
    if (path.empty()) path.emplace_back(to.plan);
  }

 private:
  bool findWay(const Location& from, const Location& to) {
    // Where all ways are blocked they lead through what blocks them, and one waits there.
    if (!(states_ != nullptr &&
          navmesh::findCorridor(world_->graph, from, to, scratch_, corridor_, states_.get())) &&
        !navmesh::findCorridor(world_->graph, from, to, scratch_, corridor_)) {
      return false;
    }
    portals_.clear();
    for (const std::uint32_t half : corridor_) {
      portals_.push_back(narrowed(world_->graph.portals[half]));
    }
    return true;
  }

  // People do not brush along corners: ends of portals that lie at a wall are moved in, by at most
  // a third of the width. Ends in the open are left alone, or the way would wind across a wide
  // floor.
  navmesh::Portal narrowed(navmesh::Portal portal) const {
    const glm::vec2 across = portal.right - portal.left;
    const double width = static_cast<double>(glm::length(across));
    if (width < 1e-6) return portal;
    const glm::vec2 shift = across * static_cast<float>(std::min(cornerMargin_ / width, 1.0 / 3.0));
    return {isAtWall(portal.left) ? portal.left + shift : portal.left,
            isAtWall(portal.right) ? portal.right - shift : portal.right};
  }

  static bool before(glm::vec2 a, glm::vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }

  bool isAtWall(glm::vec2 corner) const {
    return std::binary_search(wallCorners_.begin(), wallCorners_.end(), corner, before);
  }

  // Both ends of every edge that leads nowhere. Storeys above each other may share a place on the
  // plan; the worst that follows is a margin where none was needed.
  void findWallCorners() {
    const navmesh::NavGraph& graph = world_->graph;
    std::vector<bool> open;  // per edge of the polygon at hand
    for (std::uint32_t i = 0; i < graph.polygonCount(); ++i) {
      const std::span<const glm::vec2> ring = graph.ringOf(PolygonId{i});
      open.assign(ring.size(), false);
      for (std::uint32_t half = graph.portalStart[i]; half < graph.portalStart[i + 1]; ++half) {
        open[graph.portalEdge[half]] = true;
      }
      for (std::size_t edge = 0; edge < ring.size(); ++edge) {
        if (open[edge]) continue;
        wallCorners_.push_back(ring[edge]);
        wallCorners_.push_back(ring[(edge + 1) % ring.size()]);
      }
    }
    std::sort(wallCorners_.begin(), wallCorners_.end(), before);
  }

  std::shared_ptr<const World> world_;
  std::shared_ptr<const navmesh::PolygonStates> states_;  // null: all is open
  double cornerMargin_;
  std::vector<glm::vec2> wallCorners_;  // sorted
  navmesh::CorridorScratch scratch_;
  std::vector<std::uint32_t> corridor_;
  std::vector<navmesh::Portal> portals_;
  std::vector<glm::vec2> taut_;
};

/// Where to go next.
class Goals {
 public:
  virtual ~Goals() = default;
  /// The goal after `here`; nothing when there is none left.
  virtual std::optional<Location> next(const Location& here) = 0;
};

class WaypointGoals : public Goals {
 public:
  WaypointGoals(std::vector<Location> points, std::size_t first, bool loop)
      : points_(std::move(points)), next_(first), loop_(loop) {}

  std::optional<Location> next(const Location&) override {
    if (next_ == points_.size()) {
      if (!loop_) return std::nullopt;
      next_ = 0;
    }
    return points_[next_++];
  }

 private:
  std::vector<Location> points_;
  std::size_t next_;
  bool loop_;
};

/// Uniform places on a component of the navmesh.
class PlacesByArea {
 public:
  PlacesByArea(const World& world, std::uint32_t component) : world_(&world) {
    for (std::uint32_t i = 0; i < world.graph.polygonCount(); ++i) {
      if (world.graph.component[i] != component) continue;
      area_ += static_cast<double>(navmesh::areaOf(world.graph, PolygonId{i}));
      polygons_.push_back(PolygonId{i});
      areaUpTo_.push_back(area_);
    }
  }

  double area() const { return area_; }

  Location draw(std::mt19937_64& rng) const {
    const double at = uniform(rng) * area_;
    const auto found = std::upper_bound(areaUpTo_.begin(), areaUpTo_.end(), at);
    const std::size_t i =
        std::min(static_cast<std::size_t>(found - areaUpTo_.begin()), polygons_.size() - 1);
    const glm::vec2 plan = pointIn(world_->graph.ringOf(polygons_[i]), rng);
    return {polygons_[i], plan, navmesh::heightAt(world_->graph, polygons_[i], plan), false};
  }

 private:
  static glm::vec2 pointIn(std::span<const glm::vec2> ring, std::mt19937_64& rng) {
    double area = 0.0;  // twice
    for (std::size_t i = 2; i < ring.size(); ++i) {
      area += static_cast<double>(navmesh::turn(ring[0], ring[i - 1], ring[i]));
    }
    double at = uniform(rng) * area;
    const double u = std::sqrt(uniform(rng));  // the root makes the triangle's points uniform
    const double v = uniform(rng);
    std::size_t corner = 2;
    for (; corner + 1 < ring.size(); ++corner) {
      const double triangle =
          static_cast<double>(navmesh::turn(ring[0], ring[corner - 1], ring[corner]));
      if (at < triangle) break;
      at -= triangle;
    }
    const glm::dvec2 a{ring[0]};
    const glm::dvec2 b{ring[corner - 1]};
    const glm::dvec2 c{ring[corner]};
    return glm::vec2((1.0 - u) * a + u * ((1.0 - v) * b + v * c));
  }

  const World* world_;
  std::vector<PolygonId> polygons_;
  std::vector<double> areaUpTo_;
  double area_ = 0.0;
};

class WanderGoals : public Goals {
 public:
  WanderGoals(PlacesByArea places, double distanceMin, std::uint64_t seed)
      : places_(std::move(places)), distanceMin_(distanceMin), rng_(seed) {}

  std::optional<Location> next(const Location& here) override {
    Location goal = places_.draw(rng_);
    for (int draw = 1; draw < kGoalDraws; ++draw) {
      if (static_cast<double>(glm::distance(goal.plan, here.plan)) >= distanceMin_) break;
      goal = places_.draw(rng_);
    }
    return goal;
  }

 private:
  PlacesByArea places_;
  double distanceMin_;
  std::mt19937_64 rng_;
};

class LegGoals : public Goals {
 public:
  LegGoals(const Legs& legs, glm::dvec2 start, double heading, std::uint64_t seed)
      : legs_(legs), at_(start), heading_(heading), rng_(seed) {}

  std::optional<Location> next(const Location& here) override {
    const double length = uniform(rng_, legs_.lengthMin, legs_.lengthMax);
    at_ += length * directionOf(heading_);
    const double side = uniform(rng_);
    heading_ += legs_.eitherSide ? (side < 0.5 ? legs_.turn : -legs_.turn)
                                 : (2.0 * side - 1.0) * legs_.turn;
    return Location{navmesh::kNoPolygon, glm::vec2(at_), here.height, false};
  }

 private:
  Legs legs_;
  glm::dvec2 at_;
  double heading_;
  std::mt19937_64 rng_;
};

class CourseGoals : public Goals {
 public:
  CourseGoals(const Course& course, glm::dvec2 start, double heading, std::uint64_t seed)
      : points_(course, {start, heading}), rng_(seed) {}

  std::optional<Location> next(const Location& here) override {
    return Location{navmesh::kNoPolygon, glm::vec2(points_.next(rng_)), here.height, false};
  }

 private:
  CoursePoints points_;
  std::mt19937_64 rng_;
};

/// The way to turn in a reset: as begun, else as asked, else `liked`.
int sideOf(const ResetState& reset, int liked) {
  return reset.wanted != 0 ? reset.wanted : reset.direction != 0 ? reset.direction : liked;
}

/// Follows a planned way from goal to goal.
class PathWalker final : public Walker {
 public:
  PathWalker(const WalkerSettings& settings, const PlanarPose& physical, Router router,
             std::unique_ptr<Goals> goals, const Location& start, std::optional<double> heading,
             std::uint64_t seed)
      : Walker(settings, physical, seed),
        router_(std::move(router)),
        goals_(std::move(goals)),
        goal_(start),
        segmentFrom_(start.plan),
        rng_(seed) {
    planNextGoal();
    const glm::dvec2 toFirst = path_.empty() ? glm::dvec2(0.0, 1.0) : path_.front() - segmentFrom_;
    start_ = {start.position(), static_cast<float>(heading.value_or(headingOf(toFirst)))};
  }

  void avoidBlocked(std::shared_ptr<const navmesh::PolygonStates> states) override {
    router_.setStates(std::move(states));
    planAnew_ = true;
  }

  std::optional<glm::dvec2> target() const override {
    if (finished_ || pauseLeft_ > 0.0) return std::nullopt;
    return path_[next_];
  }

  void advance(double dt, const FrameResult& frame, const Redirection& redirection) override {
    standing_ = false;
    if (frame.reset.turning) {
      turnForReset(dt, frame.reset);
      return;
    }
    lookAround(dt);
    if (!finished_) walk(dt, frame, redirection);
    resetting_ = false;
  }

 private:
  // Goes on with the plan for `left` seconds. What the gains will do to this frame is not known
  // yet, so those of the last frame are expected; what is left over is corrected in the next.
  void walk(double left, const FrameResult& frame, const Redirection& redirection) {
    const double rotation = static_cast<double>(std::max(frame.gains.rotation, 0.1f));
    const double translation = static_cast<double>(std::max(frame.gains.translation, 0.1f));
    PlanarPose seen = redirection.toVirtual(body_);
    if (resetting_ && overshot(seen)) {
      arrive();
      if (finished_) return;
    }
    if (planAnew_ || distanceToSegment(seen.position, segmentFrom_, path_[next_]) > kStrayed) {
      planAnew_ = false;
      replan(seen, frame);
    }

    for (int event = 0; event < kEventsPerFrame && left > 0.0; ++event) {
      if (pauseLeft_ > 0.0) {
        const double pause = std::min(left, pauseLeft_);
        pauseLeft_ -= pause;
        left -= pause;
        speed_ = 0.0;
        standing_ = true;
        continue;
      }
      glm::dvec2 way = path_[next_] - seen.position;
      if (glm::length(way) < (makingWay_ ? kPassed : kArrived)) {
        arrive();
        if (finished_) return;
        continue;
      }
      double most = settings_.speed;
      if (makingWay_) {
        const double velocity = glm::length(*makingWay_);
        if (velocity < kWaiting) {
          speed_ = 0.0;
          return;
        }
        most = std::min(most, velocity / translation);
        way = *makingWay_ * (glm::length(way) / velocity);
      }
      const double error = angleBetween(directionOf(seen.heading), way);
      if (std::abs(error) > settings_.stopAngle) walking_ = false;
      const double needed = std::abs(error) / rotation;
      const double turned = std::min(needed, settings_.turnRate * left);
      turnBody(error < 0.0 ? -turned : turned);
      seen.heading += error < 0.0 ? -turned * rotation : turned * rotation;
      if (!walking_) {  // turning on the spot
        speed_ = 0.0;
        lastTurn_ = error < 0.0 ? -1 : 1;
        left -= turned / settings_.turnRate;
        walking_ = turned == needed;
        continue;
      }
      speed_ = std::min(speed_, most);
      const double settingOff = std::min(left, (most - speed_) / settings_.acceleration);
      const double reached = speed_ + settings_.acceleration * settingOff;
      const double mean =
          (0.5 * (speed_ + reached) * settingOff + reached * (left - settingOff)) / left;
      const double distance = std::min(mean * left, glm::length(way) / translation);
      const glm::dvec2 moved = distance * directionOf(body_.heading);
      step(moved);
      seen.position += translation * redirection.directionToVirtual(moved);
      const double walkedFor = distance / mean;
      speed_ = std::min(most, speed_ + settings_.acceleration * walkedFor);
      left -= walkedFor;
    }
  }

  // Nobody stops at once: a reaction, then braking, both straight on, then the turn.
  void turnForReset(double left, const ResetState& reset) {
    if (!resetting_) {
      resetting_ = true;
      reactionLeft_ = settings_.reactionTime;
      walking_ = false;
      stoppingWay_ =
          speed_ * settings_.reactionTime + speed_ * speed_ / (2.0 * settings_.deceleration);
    }
    const glm::dvec2 ahead = directionOf(body_.heading);
    const double reacting = std::min(left, reactionLeft_);
    reactionLeft_ -= reacting;
    left -= reacting;
    if (speed_ > 0.0) {
      const double braking = std::min(left, speed_ / settings_.deceleration);
      step((speed_ * (reacting + braking) - 0.5 * settings_.deceleration * braking * braking) *
           ahead);
      const bool stopped = braking < left;
      speed_ = stopped ? 0.0 : std::max(0.0, speed_ - settings_.deceleration * braking);
      left -= braking;
    }
    if (left <= 0.0) return;
    if (reset.back > 0.0) {
      step(-std::min(settings_.speed * left, reset.back + kOverstep) * ahead);
      return;
    }
    const double turned = std::min(settings_.turnRate * left, reset.remaining + kOverturn);
    turnBody(turned * sideOf(reset, lastTurn_));
  }

  // Whoever had to stop for a reset may have walked past the point they were going to. They do not
  // go back for it: in the reset's new direction that could lead out of the room again, and so for
  // ever.
  bool overshot(const PlanarPose& seen) const {
    const glm::dvec2 way = path_[next_] - seen.position;
    return glm::length(way) <= stoppingWay_ + kArrived &&
           glm::dot(way, directionOf(seen.heading)) <= 0.0;
  }

  void turnBody(double radians) { body_.heading = wrapAngle(body_.heading + radians); }

  void arrive() {
    segmentFrom_ = path_[next_];
    if (++next_ < path_.size()) return;
    pauseLeft_ = uniform(rng_, settings_.pauseMin, settings_.pauseMax);
    planNextGoal();
  }

  void planNextGoal() {
    const std::optional<Location> goal = goals_->next(goal_);
    if (!goal) {
      finished_ = true;
      return;
    }
    router_.route(goal_, *goal, path_);
    goal_ = *goal;
    next_ = 0;
  }

  void replan(const PlanarPose& seen, const FrameResult& frame) {
    segmentFrom_ = seen.position;
    if (router_.world() == nullptr || frame.location.polygon == navmesh::kNoPolygon) return;
    router_.route(frame.location, goal_, path_);
    next_ = 0;
  }

  Router router_;
  std::unique_ptr<Goals> goals_;
  Location goal_;                 // the one walked to
  std::vector<glm::dvec2> path_;  // to it, virtual plan
  std::size_t next_ = 0;          // point of `path_` walked to
  glm::dvec2 segmentFrom_;        // where the straight way to that point began
  std::mt19937_64 rng_;           // of pauses
  double pauseLeft_ = 0.0;        // seconds
  bool planAnew_ = false;         // the world has changed
  bool walking_ = false;          // false: turning on the spot
  bool resetting_ = false;
  double reactionLeft_ = 0.0;  // seconds
  double speed_ = 0.0;         // physical, m/s
  double stoppingWay_ = 0.0;   // walked on after the last reset began, metres
  int lastTurn_ = 1;  // the way of the last turn on the spot; resets are turned that way too
};

/// Walks a recording again.
class RecordedWalker final : public Walker {
 public:
  RecordedWalker(const WalkerSettings& settings, const PlanarPose& physical,
                 std::vector<WalkFrame> frames, float floorHeight, std::uint64_t seed)
      : Walker(settings, physical, seed), frames_(std::move(frames)) {
    start_ = {navmesh::toSpace(glm::vec2(frames_[0].plan), floorHeight),
              static_cast<float>(frames_[0].heading)};
  }

  void advance(double dt, const FrameResult& frame, const Redirection& redirection) override {
    standing_ = false;
    if (frame.reset.turning) {
      if (frame.reset.back > 0.0) {
        const double back = std::min(settings_.speed * dt, frame.reset.back + kOverstep);
        step(-back * direction_);
        return;
      }
      const double turned = std::min(settings_.turnRate * dt, frame.reset.remaining + kOverturn);
      body_.heading = wrapAngle(body_.heading + turned * sideOf(frame.reset, 1));
      return;
    }
    if (next_ == frames_.size()) {
      finished_ = true;
      return;
    }
    lookAround(dt);
    const WalkFrame& target = frames_[next_];
    standing_ = glm::distance(target.plan, frames_[next_ - 1].plan) < kStandingSpeed * dt;
    const PlanarPose seen = redirection.toVirtual(body_);
    const glm::dvec2 wanted = redirection.directionToPhysical(target.plan - seen.position) /
                              static_cast<double>(std::max(frame.gains.translation, 0.1f));
    // A recording that begins beside the navmesh is begun on it: whoever is behind hurries, but
    // runs no faster than a person.
    const double recorded = glm::distance(target.plan, frames_[next_ - 1].plan);
    const double most = std::max(kHurry * dt, 1.5 * recorded);
    step(wanted * std::min(1.0, most / std::max(glm::length(wanted), 1e-12)));
    if (frame.motion.walking) direction_ = frame.motion.walkingDirection;
    body_.heading =
        wrapAngle(body_.heading + wrapAngle(target.heading - seen.heading) /
                                      static_cast<double>(std::max(frame.gains.rotation, 0.1f)));
    ++next_;
    finished_ = next_ == frames_.size();
  }

  double progress() const override {
    return static_cast<double>(next_) / static_cast<double>(frames_.size());
  }

 private:
  std::vector<WalkFrame> frames_;
  std::size_t next_ = 1;
  glm::dvec2 direction_{0.0};  // of travel before a reset, physical
};

std::uint32_t largestComponent(const World& world) {
  std::vector<double> area(world.graph.componentCount, 0.0);
  for (std::uint32_t i = 0; i < world.graph.polygonCount(); ++i) {
    area[world.graph.component[i]] +=
        static_cast<double>(navmesh::areaOf(world.graph, PolygonId{i}));
  }
  return static_cast<std::uint32_t>(std::max_element(area.begin(), area.end()) - area.begin());
}

tl::expected<Location, Error> placeOf(const World* world, glm::vec3 floor,
                                      const navmesh::SnapLimits& snap, std::string_view what) {
  if (!std::isfinite(floor.x) || !std::isfinite(floor.y) || !std::isfinite(floor.z)) {
    return refused(ErrorCode::kSettingOutOfRange,
                   fmt::format("{} {},{},{} is not finite.", what, floor.x, floor.y, floor.z));
  }
  if (world == nullptr) {
    return Location{navmesh::kNoPolygon, navmesh::toPlan(floor), floor.y, false};
  }
  const std::optional<Location> found =
      navmesh::locate(world->graph, world->locations, floor, snap);
  if (!found) {
    return refused(
        ErrorCode::kPositionOffNavMesh,
        fmt::format("{} {},{},{} has no walkable polygon within {} m beside and {} m below or "
                    "{} m above it; move it onto the walkable floor.",
                    what, floor.x, floor.y, floor.z, snap.distance, snap.below, snap.above));
  }
  return *found;
}

}  // namespace

Walker::Walker(const WalkerSettings& settings, const PlanarPose& physical, std::uint64_t seed)
    : settings_(settings), body_(physical) {
  std::mt19937_64 rng(seed ^ 0x9e3779b97f4a7c15u);  // apart from the draws of the plan
  for (double& phase : phase_) phase = uniform(rng, 0.0, 2.0 * kPi);
}

void Walker::lookAround(double dt) { looking_ += dt; }

void Walker::step(glm::dvec2 physical) {
  body_.position += physical;
  walked_ += glm::length(physical);
}

HeadPose Walker::head() const {
  // Two swings whose periods have no common multiple worth the name; they fade in, so that the walk
  // begins with a straight look.
  const double fade = std::min(1.0, looking_ / 2.0);
  const double angle = 2.0 * kPi * looking_ / settings_.lookPeriod;
  const double look =
      settings_.lookAmplitude * fade * fade * (3.0 - 2.0 * fade) *
      (0.65 * std::sin(angle + phase_[0]) + 0.35 * std::sin(2.618 * angle + phase_[1]));
  // A step is about as long as 0.7 m; two of them sway to both sides once.
  const double stride = kPi * walked_ / 0.7;
  const glm::dvec2 ahead = directionOf(body_.heading);
  const glm::dvec2 left{-ahead.y, ahead.x};
  const glm::dvec2 plan = body_.position + settings_.sway * std::sin(stride) * left;
  const double height = settings_.eyeHeight + settings_.bob * std::sin(2.0 * stride);
  const double half = 0.5 * (body_.heading + look);
  return {navmesh::toSpace(glm::vec2(plan), static_cast<float>(height)),
          glm::quat(static_cast<float>(std::cos(half)), 0.0f, static_cast<float>(std::sin(half)),
                    0.0f)};
}

tl::expected<std::unique_ptr<Walker>, Error> makeWalker(std::shared_ptr<const World> world,
                                                        const User& user, const WalkStart& start,
                                                        const navmesh::SnapLimits& snap,
                                                        glm::dvec2 spaceCentre, double rate,
                                                        std::uint64_t seed) {
  if (world != nullptr && world->graph.polygonCount() == 0) world = nullptr;
  const WalkerSettings& settings = user.walker;
  if (const std::optional<Error> error = validate(settings)) return tl::unexpected(*error);
  const PlanarPose physical = start.physical.value_or(PlanarPose{spaceCentre, 0.0});
  if (!std::isfinite(start.heading.value_or(0.0)) || !std::isfinite(physical.heading) ||
      !std::isfinite(physical.position.x) || !std::isfinite(physical.position.y)) {
    return refused(ErrorCode::kSettingOutOfRange, "start: a heading or position is not finite.");
  }

  if (const auto* recorded = std::get_if<Recorded>(&user.plan)) {
    if (recorded->walk.samples.size() < 2) {
      return refused(ErrorCode::kSettingOutOfRange,
                     "user: the recorded walk is empty; read it first.");
    }
    return std::make_unique<RecordedWalker>(settings, physical, resample(recorded->walk, rate),
                                            start.floor ? start.floor->y : 0.0f, seed);
  }

  // The start: given, or what the plan has first.
  const auto* waypoints = std::get_if<Waypoints>(&user.plan);
  const auto* wander = std::get_if<Wander>(&user.plan);
  if (wander != nullptr && world == nullptr) {
    return refused(
        ErrorCode::kSettingOutOfRange,
        "user: wandering needs a navmesh to draw goals from; give a scene, or walk legs.");
  }
  const bool startsAtFirst = waypoints != nullptr && !start.floor;
  if (waypoints != nullptr && waypoints->points.size() < (startsAtFirst ? 2u : 1u)) {
    return refused(
        ErrorCode::kSettingOutOfRange,
        fmt::format("user: {} waypoints, {} needed; without a start the walk begins at the first.",
                    waypoints->points.size(), startsAtFirst ? "two are" : "one is"));
  }
  std::mt19937_64 rng(seed);
  const std::uint64_t startSeed = rng();
  const std::uint64_t goalSeed = rng();
  tl::expected<Location, Error> from;
  if (start.floor || waypoints != nullptr) {
    from =
        placeOf(world.get(), start.floor ? *start.floor : waypoints->points.front(), snap, "start");
  } else if (wander != nullptr) {
    std::mt19937_64 startRng(startSeed);
    from = PlacesByArea(*world, largestComponent(*world)).draw(startRng);
  }
  if (!from) return tl::unexpected(from.error());

  std::unique_ptr<Goals> goals;
  std::optional<double> heading = start.heading;
  if (waypoints != nullptr) {
    std::vector<Location> points;
    for (std::size_t i = 0; i < waypoints->points.size(); ++i) {
      const std::string what = fmt::format("waypoint {}", i);
      tl::expected<Location, Error> point = placeOf(world.get(), waypoints->points[i], snap, what);
      if (!point) return tl::unexpected(point.error());
      if (world != nullptr && world->graph.component[index(point->polygon)] !=
                                  world->graph.component[index(from->polygon)]) {
        return refused(
            ErrorCode::kPositionOffNavMesh,
            fmt::format("{} {},{},{} cannot be reached: it lies in component {} of the "
                        "navmesh, the start in component {}.",
                        what, waypoints->points[i].x, waypoints->points[i].y,
                        waypoints->points[i].z, world->graph.component[index(point->polygon)],
                        world->graph.component[index(from->polygon)]));
      }
      points.push_back(*point);
    }
    goals =
        std::make_unique<WaypointGoals>(std::move(points), startsAtFirst ? 1 : 0, waypoints->loop);
  } else if (wander != nullptr) {
    const std::array<Ranged, 1> ranged{
        {{"smallest distance of goals", wander->goalDistanceMin, 0.0, 1e4, "m"}}};
    if (const std::optional<Error> error = firstOutOfRange(ranged)) return tl::unexpected(*error);
    goals = std::make_unique<WanderGoals>(
        PlacesByArea(*world, world->graph.component[index(from->polygon)]), wander->goalDistanceMin,
        goalSeed);
  } else if (const auto* course = std::get_if<Course>(&user.plan)) {
    const std::array<Ranged, 2> ranged{{{"leg or radius", course->size, 0.1, 1e4, "m"},
                                        {"turn of a sawtooth", course->turn, 0.0, kPi, "rad"}}};
    if (const std::optional<Error> error = firstOutOfRange(ranged)) return tl::unexpected(*error);
    heading = heading.value_or(0.0);
    goals = std::make_unique<CourseGoals>(*course, glm::dvec2(from->plan), *heading, goalSeed);
    world = nullptr;  // as legs
  } else {
    const Legs& legs = std::get<Legs>(user.plan);
    const std::array<Ranged, 3> ranged{{{"shortest leg", legs.lengthMin, 0.1, 1e4, "m"},
                                        {"longest leg", legs.lengthMax, legs.lengthMin, 1e4, "m"},
                                        {"turn between legs", legs.turn, 0.0, kPi, "rad"}}};
    if (const std::optional<Error> error = firstOutOfRange(ranged)) return tl::unexpected(*error);
    heading = heading.value_or(0.0);
    goals = std::make_unique<LegGoals>(legs, glm::dvec2(from->plan), *heading, goalSeed);
    world = nullptr;  // legs are straight, whatever is in the way
  }
  return std::make_unique<PathWalker>(settings, physical,
                                      Router(std::move(world), settings.cornerMargin),
                                      std::move(goals), *from, heading, goalSeed);
}

}  // namespace forewalk::rdw
