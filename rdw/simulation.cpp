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
    if (!record.reset && frame.motion.usable()) {
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

}  // namespace

tl::expected<SimulationResult, Error> simulate(std::shared_ptr<const World> world,
                                               const SimulationConfig& config,
                                               const SimulationRun& run) {
  if (world != nullptr && world->graph.polygonCount() == 0) world = nullptr;
  if (const std::optional<Error> problem = firstProblem(world.get(), config)) {
    return tl::unexpected(*problem);
  }
  tl::expected<std::unique_ptr<Walker>, Error> made =
      makeWalker(world, config.user, config.start, config.session.snap,
                 config.session.space.centre(), config.rate, config.seed);
  if (!made) return tl::unexpected(made.error());
  Walker& walker = **made;

  SessionSettings settings = config.session;
  settings.start = walker.start();
  std::shared_ptr<const World> floor = world;
  if (world == nullptr) {
    floor = openPlane(walker.start().floor);
    settings.alwaysPredict = false;
    settings.openPlane = true;  // there are no ways to tell apart
  }
  tl::expected<Session, Error> session = Session::make(std::move(floor), std::move(settings));
  if (!session) return tl::unexpected(session.error());
  const TrackedSpace& space = config.session.space;

  Company* const company = run.company;
  std::shared_ptr<const navmesh::PolygonStates> states = config.session.states;
  if (company != nullptr) {
    const VirtualStart& at = walker.start();
    CompanyUser user{{glm::dvec2(navmesh::toPlan(at.floor)), static_cast<double>(at.heading)},
                     at.floor.y,
                     walker.target(),
                     config.user.walker.speed};
    if (auto begun = company->begin(user); !begun) return tl::unexpected(begun.error());
  }

  SimulationResult result;
  Account account;
  account.summary.controller = config.session.controller;
  account.summary.limits = config.session.limits;
  account.summary.horizon = static_cast<double>(config.session.horizon);
  account.summary.rate = config.rate;
  account.summary.seed = config.seed;
  account.summary.spaceArea = space.area();
  account.summary.timed = static_cast<bool>(run.microseconds);
  if (world != nullptr) {
    for (std::uint32_t i = 0; i < world->graph.polygonCount(); ++i) {
      account.summary.virtualArea +=
          static_cast<double>(navmesh::areaOf(world->graph, navmesh::PolygonId{i}));
    }
  }

  const double dt = 1.0 / config.rate;
  const double seconds = std::min(config.stop.seconds, kLongestWalk);
  const auto lastFrame = static_cast<std::uint64_t>(std::floor(seconds * config.rate + 1e-6));
  const auto framesPerReport = static_cast<std::uint64_t>(config.rate);
  StuckWatch watch;
  account.summary.end = WalkEnd::kSeconds;
  for (std::uint64_t k = 0; k <= lastFrame; ++k) {
    glm::dvec2 physicalStep{0.0};
    glm::dvec2 virtualStep{0.0};
    if (company != nullptr && follow(company->states(), *session, states) &&
        company->userAvoids()) {
      walker.avoidBlocked(states);
    }
    if (k > 0) {
      if (company != nullptr && company->userAvoids()) walker.makeWay(company->makeWay());
      const glm::dvec2 before = walker.body().position;
      walker.advance(dt, session->result(), session->redirection());
      physicalStep = walker.body().position - before;
      virtualStep = session->redirection().directionToVirtual(physicalStep);
    }
    FrameRecord record;
    record.t = static_cast<double>(k) / config.rate;
    const FrameResult& frame =
        runFrame(*session, walker.head(), record.t, run.microseconds, record);
    virtualStep += frame.injectedTranslation;
    describe(frame, space, record);
    if (company != nullptr) {
      const double translation = static_cast<double>(frame.gains.translation);
      company->follow(k, {frame.virtualPlan, frame.location.height, walker.target(),
                          config.user.walker.speed * translation});
      record.company = company->record();
    }
    account.add(record, frame, glm::length(virtualStep), glm::length(physicalStep),
                k > 0 ? dt : 0.0);
    if (run.microseconds) account.addTimes(record, frame.graph != nullptr);
    if (config.keepFrames) result.frames.push_back(record);

    const double metres = account.summary.virtualMetres;
    if (run.progress && k % framesPerReport == 0) {
      run.progress(std::min(1.0, std::max({metres / config.stop.virtualMetres,
                                           record.t / config.stop.seconds, walker.progress()})));
    }
    if (run.interrupted && k % framesPerReport == 0 && run.interrupted()) {
      account.summary.end = WalkEnd::kInterrupted;
      break;
    }
    if (metres >= config.stop.virtualMetres) {
      account.summary.end = WalkEnd::kMetres;
      break;
    }
    if (walker.finished()) {
      account.summary.end = WalkEnd::kFinished;
      break;
    }
    if (watch.stuck(metres, dt, walker.standing())) {
      account.summary.end = WalkEnd::kStuck;
      break;
    }
  }
  if (company != nullptr) account.summary.company = company->summary();
  result.summary = account.finish();
  return result;
}

}  // namespace forewalk::rdw
