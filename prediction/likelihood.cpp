#include "prediction/likelihood.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace forewalk::prediction {

namespace {

constexpr double kFollowSeconds = 0.2;  // of WalkingMotion
constexpr double kMoving = 0.1;         // m/s; below, directions are noise
constexpr double kPause = 1.0;          // seconds; a longer frame is a pause
constexpr float kNear = 1.0f, kFar = 3.0f;
constexpr double kSeen = 0.75;   // metres; who was so close has been there
constexpr double kRecent = 6.0;  // metres walked
constexpr double kLog2 = 0.693147180559945309417232;
constexpr double kNothing = -1e9;  // log probability of what cannot be

glm::dvec2 unit(glm::dvec2 v) {
  const double length = glm::length(v);
  return length > 1e-9 ? v / length : glm::dvec2(0.0);
}

/// Log of the modified Bessel function I0: the von Mises normalisation (Abramowitz and Stegun
/// 9.8.1, 9.8.2, by their leading terms; error below 2e-7).
double logBessel0(double x) {
  if (x < 3.75) {
    const double t = (x / 3.75) * (x / 3.75);
    return std::log(
        1.0 + t * (3.5156229 +
                   t * (3.0899424 +
                        t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
  }
  const double t = 3.75 / x;
  const double series =
      0.39894228 +
      t * (0.01328592 +
           t * (0.00225319 +
                t * (-0.00157565 +
                     t * (0.00916281 +
                          t * (-0.02057706 +
                               t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))));
  return x - 0.5 * std::log(x) + std::log(series);
}

/// Log of a density of directions over the uniform one: von Mises about the way, mixed.
double logRatio(double cosine, double concentration, double normal, double uniformShare) {
  return std::log(uniformShare + (1.0 - uniformShare) * std::exp(concentration * cosine - normal));
}

glm::dvec2 towards(const PredictionGraph& graph, NodeId terminal, float s) {
  return unit(glm::dvec2(pointAlong(graph, terminal, s).plan) - glm::dvec2(graph.source.plan));
}

}  // namespace

void WalkingMotion::update(glm::vec2 plan, double seconds) {
  const glm::dvec2 now(plan);
  if (started_ && seconds > 0.0) {
    const double follow = 1.0 - std::exp(-seconds / kFollowSeconds);
    velocity_ += follow * ((now - plan_) / seconds - velocity_);
    if (glm::length(velocity_) > kMoving) direction_ = unit(velocity_);
  } else if (!started_) {
    velocity_ = glm::dvec2(0.0);
    direction_ = glm::dvec2(0.0);
    started_ = true;
  }
  plan_ = now;
}

void PathSoFar::add(glm::vec2 plan) {
  if (count_ == 0) {
    places_[0] = plan;
    count_ = 1;
    return;
  }
  // A long step leaves a place every half metre too, so that the frame rate does not matter.
  for (int i = 0; i < kMost; ++i) {
    const glm::vec2 last = places_[static_cast<std::size_t>((count_ - 1) % kMost)];
    const float left = glm::distance(last, plan);
    const auto step = static_cast<float>(kStep);
    if (left < step) return;
    // Room to grow without end: only the remainder and whether it wrapped matter.
    if (count_ == 1 << 30) count_ = kMost + (1 << 30) % kMost;
    places_[static_cast<std::size_t>(count_++ % kMost)] = last + (step / left) * (plan - last);
  }
}

PathSoFar::Been PathSoFar::beenAt(glm::vec2 plan) const {
  Been been{0.0, 0.0};
  const int known = std::min(count_, kMost);
  for (int back = 0; back < known; ++back) {
    const glm::vec2 place = places_[static_cast<std::size_t>((count_ - 1 - back) % kMost)];
    const double apart = static_cast<double>(glm::distance(place, plan));
    if (apart > 2.0 * kSeen) continue;
    const double here = std::clamp(2.0 - apart / kSeen, 0.0, 1.0);
    double& kind = back * kStep < kRecent ? been.recent : been.earlier;
    kind = std::max(kind, here);
  }
  return been;
}

WayFilter::WayFilter(std::size_t ways) {
  memory_.reserve(ways);
  next_.reserve(ways);
  probabilities_.reserve(ways);
}

void WayFilter::restart() {
  memory_.clear();
  probabilities_.clear();
  none_ = 1.0;
}

void WayFilter::step(std::span<const WayFacts> ways, const Walked& walked,
                     const LikelihoodParameters& p) {
  assert(ways.size() <= probabilities_.capacity());
  // What of the memory is kept: forgetting is first order in metres and in seconds.
  const double metresLost = walked.metres / p.forgetMetres;
  const double secondsLost = walked.seconds / p.forgetSeconds;
  const double keep = std::exp(-metresLost - secondsLost);
  // The share of the loss that walking makes up for by new evidence; time alone only forgets.
  const double loss = metresLost + secondsLost;
  const double learn = loss > 0.0 ? (1.0 - keep) * metresLost / loss : 0.0;
  const bool walks = glm::dot(walked.direction, walked.direction) > 0.0;
  const double keepLook = std::exp(-walked.seconds / p.lookSeconds);

  const double normal = walks ? logBessel0(p.concentration) : 0.0;
  const double headNormal = walked.head ? logBessel0(p.head) : 0.0;
  const double gazeNormal = walked.gaze ? logBessel0(p.gaze) : 0.0;
  next_.clear();
  probabilities_.clear();
  const double logNone = std::log(p.noneShare);
  double most = logNone;
  for (const WayFacts& way : ways) {
    const glm::dvec2 ahead = unit((1.0 - p.farShare) * way.near + p.farShare * way.far);
    const double said =
        walks ? logRatio(glm::dot(walked.direction, ahead), p.concentration, normal, p.turnsRound)
              : 0.0;
    double looks = 0.0;
    if (walked.head) {
      looks += logRatio(glm::dot(*walked.head, ahead), p.head, headNormal, p.turnsRound);
    }
    if (walked.gaze) {
      looks += logRatio(glm::dot(*walked.gaze, ahead), p.gaze, gazeNormal, p.turnsRound);
    }
    Memory memory;
    if (way.before >= 0 && static_cast<std::size_t>(way.before) < memory_.size()) {
      const Memory& before = memory_[static_cast<std::size_t>(way.before)];
      memory.walked = keep * before.walked + (walks ? learn * said : 0.0);
      memory.looked = keepLook * before.looked + (1.0 - keepLook) * looks;
    } else {
      // Nobody has watched this way: what is seen now stands for what would have been.
      memory.walked = walks && walked.metres > 0.0 ? said * metresLost / loss : 0.0;
      memory.looked = looks;
    }
    next_.push_back(memory);
    double log = p.steady * memory.walked + memory.looked;
    log -= p.branchSplit * way.branchLog;
    log += p.retrace * way.retrace + p.revisit * way.revisit;
    if (way.deadEnd) log += way.distance < kArrived ? kNothing : p.deadEnd;
    probabilities_.push_back(log);
    most = std::max(most, log);
  }
  none_ = std::exp(logNone - most);
  double sum = none_;
  for (double& log : probabilities_) {
    log = std::exp(log - most);
    sum += log;
  }
  for (double& probability : probabilities_) probability /= sum;
  none_ /= sum;
  std::swap(memory_, next_);
}

double progress(double speed, double seconds, const LikelihoodParameters& p) {
  const double now = p.paceMemory * (1.0 - std::exp(-seconds / p.paceMemory));
  return speed * now + p.cruise * (seconds - now);
}

WayLikelihood::WayLikelihood(const LikelihoodParameters& parameters,
                             const WayTrackerSettings& settings)
    : parameters_(parameters), tracker_(settings), filter_(settings.ways) {
  facts_.reserve(settings.ways);
}

void WayLikelihood::restart() {
  tracker_.restart();
  motion_.restart();
  path_.restart();
  filter_.restart();
}

void WayLikelihood::update(const PredictionGraph& graph, const Evidence& evidence) {
  const glm::vec2 plan = graph.source.plan;
  if (evidence.seconds > kPause) motion_.restart();
  tracker_.update(graph);
  walked_ = {};
  walked_.seconds = evidence.seconds;
  if ((graph.flags & kSourceOffMesh) == 0) {
    motion_.update(plan, evidence.seconds);
    path_.add(plan);
    // By velocity, not by places: a head sways, and the more so the more frames there are.
    walked_.metres = glm::length(motion_.velocity()) * evidence.seconds;
  }
  walked_.direction = motion_.direction();
  if (evidence.head) walked_.head = unit(*evidence.head);
  if (evidence.gaze) walked_.gaze = unit(*evidence.gaze);

  facts_.clear();
  for (const TrackedWay& way : tracker_.ways()) {
    const Node& node = graph.node(way.terminal);
    WayFacts facts;
    facts.near = towards(graph, way.terminal, kNear);
    facts.far = towards(graph, way.terminal, kFar);
    facts.distance = static_cast<double>(node.distance);
    facts.deadEnd = node.reason != TerminalReason::kHorizon;
    for (NodeId at = node.prev; at != kNoNode; at = graph.node(at).prev) {
      const std::uint32_t children = graph.node(at).childCount;
      if (children == 2) {
        facts.branchLog += kLog2;  // as most branches
      } else if (children > 2) {
        facts.branchLog += std::log(static_cast<double>(children));
      }
    }
    const PathSoFar::Been been = path_.beenAt(node.plan);
    facts.retrace = been.recent;
    facts.revisit = been.earlier;
    facts.before = way.before;
    facts_.push_back(facts);
  }
  filter_.step(facts_, walked_, parameters_);
}

glm::dvec2 WayLikelihood::placeAfter(const PredictionGraph& graph, double seconds) const {
  const std::span<const TrackedWay> ways = tracker_.ways();
  return expectedPlace(
      glm::dvec2(graph.source.plan), motion_.velocity(), probabilities(), none(), seconds,
      parameters_, [&](std::size_t i, double s) {
        return glm::dvec2(pointAlong(graph, ways[i].terminal, static_cast<float>(s)).plan);
      });
}

}  // namespace forewalk::prediction
