#include "rdw/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace forewalk::rdw {
namespace {

using navmesh::World;

constexpr double kLongestWalk = 86400.0;         // seconds; whatever the stop conditions say
constexpr double kTurning = 20.0 * kPi / 180.0;  // rad/s; slower is what curvature does by itself
constexpr double kProgress = 1.0;                // virtual metres that show that nobody is stuck
constexpr double kBodiesApart = 0.5;             // metres between the middles of two bodies

bool isEndless(const User& user) {
  if (const auto* waypoints = std::get_if<Waypoints>(&user.plan)) return waypoints->loop;
  return !std::holds_alternative<Recorded>(user.plan);
}

std::optional<Error> firstProblem(const World* world, const SimulationConfig& config) {
  const auto problem = [](std::string message) {
    return Error{ErrorCode::kSettingOutOfRange, std::move(message)};
  };
  if (!(config.rate >= 5.0 && config.rate <= 1000.0)) {
    return problem(
        fmt::format("rate is {:.6g} frames a second, it has to lie in [5, 1000].", config.rate));
  }
  if (!(config.stop.virtualMetres > 0.0) || !(config.stop.seconds > 0.0)) {
    return problem(fmt::format("stop: {:.6g} m and {:.6g} s have to be above 0.",
                               config.stop.virtualMetres, config.stop.seconds));
  }
  if (isEndless(config.user) && std::isinf(config.stop.virtualMetres) &&
      std::isinf(config.stop.seconds)) {
    return problem(
        "stop: this user walks for ever; say after how many virtual metres or seconds to stop.");
  }
  if (world == nullptr) {
    const auto controller = makeController(config.session.controller);
    if (!controller) return controller.error();
    if (!(*controller)->steersWithoutGraph()) {
      return problem(
          fmt::format("controller {} steers by prediction and needs a navmesh; give a scene, or "
                      "take a reactive one.",
                      config.session.controller));
    }
  }
  return std::nullopt;
}

/// A session needs a floor: one square, larger than anybody walks, small enough for single
/// precision.
std::shared_ptr<const World> openPlane(glm::vec3 centre) {
  constexpr float kHalfSide = 16384.0f;  // metres
  navmesh::PolygonMesh square;
  for (const auto& [x, z] : {std::pair{-1.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, -1.0f}, {-1.0f, -1.0f}}) {
    square.vertices.push_back(centre + glm::vec3(x * kHalfSide, 0.0f, z * kHalfSide));
    square.ring.push_back(static_cast<std::uint32_t>(square.ring.size()));
  }
  square.ringStart.push_back(4);
  tl::expected<navmesh::NavGraph, Error> graph = navmesh::makeNavGraph(square);
  assert(graph);
  return std::make_shared<const World>(navmesh::makeWorld(std::move(*graph)));
}

/// Weighted mean.
struct Mean {
  double sum = 0.0;
  double weight = 0.0;
  void add(double value, double w) {
    sum += value * w;
    weight += w;
  }
  double or_(double fallback) const { return weight > 0.0 ? sum / weight : fallback; }
};

/// Sums up a walk frame by frame.
class Account {
 public:
  void add(const FrameRecord& record, const FrameResult& frame, double virtualStep,
           double physicalStep, double dt) {
    summary.frames += 1;
    summary.seconds = record.t;
    summary.virtualMetres += virtualStep;
    summary.physicalMetres += physicalStep;
    summary.resets = frame.resetCount;
    hash_.add(record);
    if (record.reset) summary.resetSeconds += dt;
    // The frame in which a reset ends is still turned by it.
    const bool resetting = std::exchange(wasReset_, record.reset) || record.reset;
    if (!resetting && frame.motion.usable()) {
      translation_.add(static_cast<double>(record.gains.translation), physicalStep);
      curvature_.add(std::abs(static_cast<double>(record.gains.curvature)), physicalStep);
      if (std::abs(frame.motion.turnRate) > kTurning) {
        const double rotation = static_cast<double>(record.gains.rotation);
        rotation_.add(rotation, std::abs(frame.motion.turn));
        rotationOffset_.add(std::abs(rotation - 1.0), std::abs(frame.motion.turn));
      }
    }
    const bool outside = record.borderDistance < 0.0;
    if (outside) {
      summary.violations += outside_ ? 0 : 1;
      summary.violationFrames += 1;
      summary.violationMetres += physicalStep;
      summary.violationDepth = std::max(summary.violationDepth, -record.borderDistance);
    }
    outside_ = outside;
    if (frame.graph != nullptr) graphNodes_.add(static_cast<double>(record.graphNodes), 1.0);
  }

  void addTimes(const FrameRecord& record, bool graph) {
    if (graph) graphTimes_.push_back(record.predictMicroseconds);
    frameTimes_.push_back(record.frameMicroseconds);
  }

  Summary finish() {
    summary.meanTranslation = translation_.or_(1.0);
    summary.meanCurvature = curvature_.or_(0.0);
    summary.meanRotation = rotation_.or_(1.0);
    summary.meanRotationOffset = rotationOffset_.or_(0.0);
    summary.meanGraphNodes = graphNodes_.or_(0.0);
    summary.graphMicroseconds = quantilesOf(graphTimes_);
    summary.frameMicroseconds = quantilesOf(frameTimes_);
    summary.traceHash = hash_.value();
    return summary;
  }

  Summary summary;

 private:
  TraceHash hash_;
  Mean translation_, rotation_, rotationOffset_, curvature_, graphNodes_;
  std::vector<double> graphTimes_;
  std::vector<double> frameTimes_;
  bool outside_ = false;
  bool wasReset_ = false;
};

/// Tells a walker who is stuck from one who rests.
class StuckWatch {
 public:
  bool stuck(double virtualMetres, double dt, bool standing) {
    if (virtualMetres - mark_ >= kProgress) {
      mark_ = virtualMetres;
      wanted_ = 0.0;
    }
    if (!standing) wanted_ += dt;
    return wanted_ >= kStuckSeconds;
  }

 private:
  double mark_ = 0.0;    // virtual metres at the last sign of progress
  double wanted_ = 0.0;  // seconds of wanting to walk since
};

/// One frame of the session, timed where there is a clock.
const FrameResult& runFrame(Session& session, const HeadPose& head, double t,
                            const std::function<double()>& clock, FrameRecord& record) {
  if (!clock) return session.frame(head, t);
  const double begin = clock();
  session.locate(head, t);
  const double located = clock();
  session.predict();
  const double predicted = clock();
  const FrameResult& result = session.steer();
  const double end = clock();
  record.predictMicroseconds = predicted - located;
  record.steerMicroseconds = end - predicted;
  record.frameMicroseconds = end - begin;
  return result;
}

/// Takes the company's states of the world into a session. Whether they changed.
bool follow(const std::shared_ptr<const navmesh::PolygonStates>& wanted, Session& session,
            std::shared_ptr<const navmesh::PolygonStates>& current) {
  if (wanted == current) return false;
  current = wanted;
  if (session.settings().method == prediction::Method::kPolygon) {
    std::shared_ptr<const navmesh::PolygonStates> next = wanted;
    session.setStates(next);
  } else {
    // Graphs by fronts know the states by their index.
    PreparedWorld next = prepareWorld(session.sharedWorld(), session.settings().prediction,
                                      session.settings().method, nullptr, wanted);
    session.enter(next);
  }
  return true;
}

void describe(const FrameResult& frame, const TrackedSpace& space, FrameRecord& record) {
  record.virtualPosition = frame.virtualPlan.position;
  record.virtualHeading = frame.virtualPlan.heading;
  record.physicalPosition = frame.physical.position;
  record.physicalHeading = frame.physical.heading;
  record.gains = frame.gains;
  record.injectedYaw = frame.injectedYaw;
  record.reset = frame.reset.turning;
  record.graphNodes = frame.graph ? static_cast<std::uint32_t>(frame.graph->nodes.size()) : 0u;
  record.borderDistance = space.signedDistance(frame.physical.position);
}

/// One user's walk between its first and its last frame.
class WalkInProgress {
 public:
  /// `world` null: an open plane. Fails as simulate.
  static tl::expected<std::unique_ptr<WalkInProgress>, Error> begin(
      const std::shared_ptr<const World>& world, const SimulationConfig& config,
      const SimulationRun& run, Company* company);

  bool over() const { return over_; }

  /// The next frame, among `others` who are where they were in the last one.
  void frame(std::span<const OtherUser> others);

  /// The user as others in the room see them, after the last frame.
  OtherUser body() const;

  double done() const;
  SimulationResult finish() &&;

 private:
  WalkInProgress(const SimulationConfig& config, const SimulationRun& run, Company* company,
                 std::unique_ptr<Walker> walker, Session session);
  void move(double dt, glm::dvec2& physicalStep, glm::dvec2& virtualStep);
  void endWith(WalkEnd end) {
    account_.summary.end = end;
    over_ = true;
  }

  const SimulationConfig& config_;
  const SimulationRun& run_;
  Company* company_;
  std::shared_ptr<const navmesh::PolygonStates> states_;
  std::unique_ptr<Walker> walker_;
  Session session_;
  SimulationResult result_;
  Account account_;
  StuckWatch watch_;
  std::uint64_t next_ = 0;  // frame
  std::uint64_t lastFrame_;
  bool over_ = false;
};

WalkInProgress::WalkInProgress(const SimulationConfig& config, const SimulationRun& run,
                               Company* company, std::unique_ptr<Walker> walker, Session session)
    : config_(config),
      run_(run),
      company_(company),
      states_(config.session.states),
      walker_(std::move(walker)),
      session_(std::move(session)),
      lastFrame_(static_cast<std::uint64_t>(
          std::floor(std::min(config.stop.seconds, kLongestWalk) * config.rate + 1e-6))) {
  Summary& summary = account_.summary;
  summary.controller = config.session.controller;
  summary.limits = config.session.limits;
  summary.horizon = static_cast<double>(config.session.horizon);
  summary.rate = config.rate;
  summary.seed = config.seed;
  summary.spaceArea = config.session.space.area();
  summary.timed = static_cast<bool>(run.microseconds);
  summary.end = WalkEnd::kSeconds;
}

tl::expected<std::unique_ptr<WalkInProgress>, Error> WalkInProgress::begin(
    const std::shared_ptr<const World>& world, const SimulationConfig& config,
    const SimulationRun& run, Company* company) {
  if (const std::optional<Error> problem = firstProblem(world.get(), config)) {
    return tl::unexpected(*problem);
  }
  tl::expected<std::unique_ptr<Walker>, Error> walker =
      makeWalker(world, config.user, config.start, config.session.snap,
                 config.session.space.centre(), config.rate, config.seed);
  if (!walker) return tl::unexpected(walker.error());
  const VirtualStart start = (*walker)->start();

  SessionSettings settings = config.session;
  settings.start = start;
  std::shared_ptr<const World> floor = world;
  if (world == nullptr) {
    floor = openPlane(start.floor);
    settings.alwaysPredict = false;
    settings.openPlane = true;  // there are no ways to tell apart
  }
  tl::expected<Session, Error> session = Session::make(std::move(floor), std::move(settings));
  if (!session) return tl::unexpected(session.error());

  if (company != nullptr) {
    CompanyUser user{{glm::dvec2(navmesh::toPlan(start.floor)), static_cast<double>(start.heading)},
                     start.floor.y,
                     (*walker)->target(),
                     config.user.walker.speed};
    if (auto begun = company->begin(user); !begun) return tl::unexpected(begun.error());
  }
  std::unique_ptr<WalkInProgress> walk(
      new WalkInProgress(config, run, company, std::move(*walker), std::move(*session)));
  walk->result_.startHeight = start.floor.y;
  if (world != nullptr) {
    for (std::uint32_t i = 0; i < world->graph.polygonCount(); ++i) {
      walk->account_.summary.virtualArea +=
          static_cast<double>(navmesh::areaOf(world->graph, navmesh::PolygonId{i}));
    }
  }
  return walk;
}

void WalkInProgress::move(double dt, glm::dvec2& physicalStep, glm::dvec2& virtualStep) {
  if (company_ != nullptr && company_->userAvoids()) walker_->makeWay(company_->makeWay());
  const glm::dvec2 before = walker_->body().position;
  walker_->advance(dt, session_.result(), session_.redirection());
  physicalStep = walker_->body().position - before;
  virtualStep = session_.redirection().directionToVirtual(physicalStep);
}

void WalkInProgress::frame(std::span<const OtherUser> others) {
  const std::uint64_t k = next_++;
  const double dt = 1.0 / config_.rate;
  glm::dvec2 physicalStep{0.0};
  glm::dvec2 virtualStep{0.0};
  if (company_ != nullptr && follow(company_->states(), session_, states_) &&
      company_->userAvoids()) {
    walker_->avoidBlocked(states_);
  }
  if (k > 0) move(dt, physicalStep, virtualStep);
  FrameRecord record;
  record.t = static_cast<double>(k) / config_.rate;
  session_.setOthers(others);
  const FrameResult& frame =
      runFrame(session_, walker_->head(), record.t, run_.microseconds, record);
  virtualStep += frame.injectedTranslation;
  describe(frame, config_.session.space, record);
  if (company_ != nullptr) {
    const double translation = static_cast<double>(frame.gains.translation);
    company_->follow(k, {frame.virtualPlan, frame.location.height, walker_->target(),
                         config_.user.walker.speed * translation});
    record.company = company_->record();
  }
  account_.add(record, frame, glm::length(virtualStep), glm::length(physicalStep),
               k > 0 ? dt : 0.0);
  if (run_.microseconds) account_.addTimes(record, frame.graph != nullptr);
  if (config_.keepFrames) result_.frames.push_back(record);

  const double metres = account_.summary.virtualMetres;
  if (metres >= config_.stop.virtualMetres) return endWith(WalkEnd::kMetres);
  if (walker_->finished()) return endWith(WalkEnd::kFinished);
  if (watch_.stuck(metres, dt, walker_->standing())) return endWith(WalkEnd::kStuck);
  if (k == lastFrame_) over_ = true;
}

OtherUser WalkInProgress::body() const {
  const FrameResult& frame = session_.result();
  return {frame.physical.position, frame.motion.speed * frame.motion.walkingDirection,
          directionOf(frame.physical.heading), kBodiesApart};
}

double WalkInProgress::done() const {
  const Summary& summary = account_.summary;
  return std::min(1.0, std::max({summary.virtualMetres / config_.stop.virtualMetres,
                                 summary.seconds / config_.stop.seconds, walker_->progress()}));
}

SimulationResult WalkInProgress::finish() && {
  if (!over_) account_.summary.end = WalkEnd::kInterrupted;
  if (company_ != nullptr) account_.summary.company = company_->summary();
  result_.summary = account_.finish();
  return std::move(result_);
}

}  // namespace

tl::expected<std::vector<SimulationResult>, Error> simulateTogether(
    std::shared_ptr<const World> world, std::span<const SimulationConfig> users, Sharing sharing,
    const SimulationRun& run, std::span<Company* const> companies) {
  assert(companies.empty() || companies.size() == users.size());
  if (world != nullptr && world->graph.polygonCount() == 0) world = nullptr;
  if (users.empty() || users.size() > kMostOthers + 1) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("users: {} walk together, 1 to {} can.", users.size(), kMostOthers + 1)});
  }
  std::vector<std::unique_ptr<WalkInProgress>> walks;
  for (std::size_t i = 0; i < users.size(); ++i) {
    if (users[i].rate != users.front().rate) {
      return tl::unexpected(
          Error{ErrorCode::kSettingOutOfRange,
                fmt::format("rate: {:.6g} and {:.6g} frames a second; users who walk together have "
                            "one.",
                            users.front().rate, users[i].rate)});
    }
    auto begun =
        WalkInProgress::begin(world, users[i], run, companies.empty() ? nullptr : companies[i]);
    if (!begun) return tl::unexpected(begun.error());
    walks.push_back(std::move(*begun));
  }

  // All see where the others were in the last frame, so that it does not matter who is asked first.
  SharedSpace room(users.size());
  const bool meet = sharing == Sharing::kRoom && users.size() > 1;
  const auto framesPerReport = static_cast<std::uint64_t>(users.front().rate);
  bool somebodyWalks = true;
  for (std::uint64_t k = 0; somebodyWalks; ++k) {
    somebodyWalks = false;
    double done = 1.0;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      if (walks[i]->over()) continue;
      walks[i]->frame(meet ? room.othersOf(i) : std::span<const OtherUser>{});
      if (walks[i]->over()) continue;
      somebodyWalks = true;
      if (k % framesPerReport == 0) done = std::min(done, walks[i]->done());
    }
    for (std::size_t i = 0; meet && i < walks.size(); ++i) {
      if (walks[i]->over()) {
        room.leave(i);
      } else {
        room.place(i, walks[i]->body());
      }
    }
    if (k % framesPerReport != 0) continue;
    if (run.progress) run.progress(done);
    if (run.interrupted && run.interrupted()) break;
  }
  std::vector<SimulationResult> results;
  for (auto& walk : walks) results.push_back(std::move(*walk).finish());
  return results;
}

tl::expected<SimulationResult, Error> simulate(std::shared_ptr<const World> world,
                                               const SimulationConfig& config,
                                               const SimulationRun& run) {
  Company* const company[] = {run.company};
  auto results = simulateTogether(std::move(world), {&config, 1}, Sharing::kWorld, run, company);
  if (!results) return tl::unexpected(results.error());
  return std::move(results->front());
}

}  // namespace forewalk::rdw
