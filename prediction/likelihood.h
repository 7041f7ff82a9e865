// Which way will they take? A probability for every way of a prediction graph, and for none of
// them.
//
// A recursive Bayes filter over the ways of a WayTracker, with forgetting (power steady model,
// Smith, J. R. Stat. Soc. B 41, 1979; exponential forgetting of log-likelihoods). Evidence is the
// walking direction against the direction of a way's first metres: a von Mises likelihood (the
// circular normal, usual for headings) mixed with a uniform one, for people turn round. It is
// weighed by metres walked, so it adds up along the path, and somebody who stops to look around
// loses nothing but what time forgets. Head and gaze speak by seconds instead, where they are
// known. The prior of a way: mass splits at branches; a way back along the path that was just
// walked, or one that ends within the horizon, is less likely. Corridor width is not looked at.
//
// All rates are per metre and per second and integrated exactly, so that the frame rate hardly
// matters.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "prediction/prediction_graph.h"
#include "prediction/way_tracker.h"

namespace forewalk::prediction {

/// The few numbers of the likelihood. Defaults are those of assets/likelihood/default.json, fitted
/// on twelve recorded walks; head and gaze cannot be fitted there and are cautious guesses.
struct LikelihoodParameters {
  double concentration = 3.349;  ///< of walking directions about the way taken (von Mises), >= 0
  double farShare = 0.4933;  ///< how much of the direction is that at 3 m, the rest at 1 m, [0, 1]
  double turnsRound = 0.06465;   ///< share of uniform directions, whatever the way, (0, 1]
  double forgetMetres = 0.4877;  ///< evidence is forgotten over so many metres walked, > 0
  double forgetSeconds = 12.59;  ///< and over so many seconds, > 0
  double steady = 0.6156;        ///< how much evidence a full memory is worth; 1: as that of one
                                 ///< direction, > 0
  double branchSplit = 0.1647;  ///< 0: ways are alike; 1: mass splits evenly at each branch; [0, 1]
  double deadEnd = -1.739;      ///< log odds of a way that ends within the horizon
  double retrace = -0.7097;     ///< log odds of the way back along the path just walked
  double revisit = -0.5454;     ///< log odds of a way that leads to where the user was before that
  double noneShare = 0.004512;  ///< prior odds of none of the ways, (0, 1)
  double head = 1.0;            ///< concentration of head directions about the way, >= 0
  double gaze = 0.5;            ///< the same of gaze directions
  double lookSeconds = 1.0;     ///< how long a look counts, > 0
  double paceMemory = 3.13;     ///< speed goes over to the cruise within so many seconds, > 0
  double cruise = 0.4463;       ///< mean speed of progress, m/s, >= 0
  double inertia = 2.094;  ///< motion beside the way ahead dies out within so many seconds, > 0
};

/// Velocity from positions: an exponential mean that follows within 0.2 s, whatever the frame rate.
class WalkingMotion {
 public:
  /// `plan` after `seconds` (> 0; the first call's are of no account). Finite.
  void update(glm::vec2 plan, double seconds);
  void restart() { started_ = false; }
  glm::dvec2 velocity() const { return velocity_; }  ///< m/s on the plan
  /// Unit direction of the last motion faster than 0.1 m/s; zero before there was any.
  glm::dvec2 direction() const { return direction_; }

 private:
  bool started_ = false;
  glm::dvec2 plan_{0.0}, velocity_{0.0}, direction_{0.0};
};

/// Where the user has been: a place every half metre, the last 64 m of them.
class PathSoFar {
 public:
  static constexpr int kMost = 128;
  static constexpr double kStep = 0.5;  ///< metres

  void add(glm::vec2 plan);
  void restart() { count_ = 0; }
  struct Been {
    double recent;   ///< 1: there within the last 6 m walked, else 0; smooth in between
    double earlier;  ///< the same of all metres before
  };
  /// Whether the user has been within 0.75 m of `plan`. O(kMost).
  Been beenAt(glm::vec2 plan) const;

 private:
  std::array<glm::vec2, kMost> places_{};
  int count_ = 0;  // since the start
};

/// What the filter looks at in a way.
struct WayFacts {
  glm::dvec2 near{0.0};      ///< unit direction from the user to 1 m along the way
  glm::dvec2 far{0.0};       ///< the same to 3 m
  double distance = 0.0;     ///< length of the way, metres
  double branchLog = 0.0;    ///< sum of log(ways on) over its branches
  double retrace = 0.0;      ///< PathSoFar::Been where it ends
  double revisit = 0.0;      ///< the same
  std::int32_t before = -1;  ///< index of the way it continues in the last step; -1: none
  bool deadEnd = false;      ///< it goes no farther than it is known: not cut at the horizon
};

/// What happened since the last step.
struct Walked {
  double metres = 0.0;                   ///< >= 0
  double seconds = 0.0;                  ///< >= 0
  glm::dvec2 direction{0.0};             ///< of walking, unit; zero: not known
  std::optional<glm::dvec2> head, gaze;  ///< unit, on the plan
};

/// Dead ends nearer than this are where the user stands already, no way to go; metres.
inline constexpr double kArrived = 1.0;

/// The filter itself, on facts. Replays exactly; parameters can be fitted on recorded facts.
class WayFilter {
 public:
  /// `ways`: most ways of one step.
  explicit WayFilter(std::size_t ways);
  void restart();

  /// REQUIRES: no more ways than given above, `before` < the ways of the last step. O(ways),
  /// allocates nothing.
  void step(std::span<const WayFacts> ways, const Walked& walked,
            const LikelihoodParameters& parameters);

  /// Per way, in the order given; with none() they sum to 1.
  std::span<const double> probabilities() const { return probabilities_; }
  double none() const { return none_; }

 private:
  struct Memory {
    double walked = 0.0;  // forgetful mean of the log-likelihood of walking directions
    double looked = 0.0;  // the same of looks
  };
  std::vector<Memory> memory_, next_;
  std::vector<double> probabilities_;
  double none_ = 1.0;
};

/// Metres of progress within `seconds` for somebody who walks at `speed` m/s now.
double progress(double speed, double seconds, const LikelihoodParameters& parameters);

/// The expected place of a walker at `plan` with `velocity`, `seconds` ahead: along the ways by
/// their probabilities, none of them meaning straight on. `along(i, s)` is the plan point s metres
/// along way i. O(ways * along).
template <typename Along>
glm::dvec2 expectedPlace(glm::dvec2 plan, glm::dvec2 velocity,
                         std::span<const double> probabilities, double none, double seconds,
                         const LikelihoodParameters& parameters, Along along);

/// The same at `metres` of path ahead. `direction` is that of walking: what none of the ways means.
template <typename Along>
glm::dvec2 expectedPlaceAt(glm::dvec2 plan, glm::dvec2 direction,
                           std::span<const double> probabilities, double none, double metres,
                           Along along);

/// One frame's evidence.
struct Evidence {
  double seconds = 0.0;                  ///< since the last frame, >= 0
  std::optional<glm::dvec2> head, gaze;  ///< unit, on the plan; of any length but zero
};

/// Likelihoods for frame after frame: the filter, and all that it needs from graphs. One per user;
/// not shared between threads.
class WayLikelihood {
 public:
  explicit WayLikelihood(const LikelihoodParameters& parameters = {},
                         const WayTrackerSettings& settings = {});
  void restart();

  /// `graph` is this frame's, its source where the user is. Costs O(terminals * corners) and, per
  /// terminal, PathSoFar::kMost; allocates nothing. A pause (a frame later than a second) starts
  /// the velocity anew.
  void update(const PredictionGraph& graph, const Evidence& evidence);

  /// In the order of graph.terminals (up to the tracker's limit); with none() they sum to 1.
  std::span<const double> probabilities() const { return filter_.probabilities(); }
  double none() const { return filter_.none(); }
  std::span<const TrackedWay> ways() const { return tracker_.ways(); }
  const WayTracker& tracker() const { return tracker_; }
  const WalkingMotion& motion() const { return motion_; }

  /// What the filter was told in the last update.
  std::span<const WayFacts> facts() const { return facts_; }
  const Walked& walked() const { return walked_; }

  /// Expected plan point `seconds` ahead; `graph` is that of the last update.
  glm::dvec2 placeAfter(const PredictionGraph& graph, double seconds) const;

 private:
  LikelihoodParameters parameters_;
  WayTracker tracker_;
  WalkingMotion motion_;
  PathSoFar path_;
  WayFilter filter_;
  std::vector<WayFacts> facts_;
  Walked walked_;
};

template <typename Along>
glm::dvec2 expectedPlaceAt(glm::dvec2 plan, glm::dvec2 direction,
                           std::span<const double> probabilities, double none, double metres,
                           Along along) {
  glm::dvec2 place = none * (plan + metres * direction);
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (probabilities[i] > 0.0) place += probabilities[i] * along(i, metres);
  }
  return place;
}

template <typename Along>
glm::dvec2 expectedPlace(glm::dvec2 plan, glm::dvec2 velocity,
                         std::span<const double> probabilities, double none, double seconds,
                         const LikelihoodParameters& parameters, Along along) {
  const double speed = glm::length(velocity);
  const glm::dvec2 direction = speed > 1e-9 ? velocity / speed : glm::dvec2(0.0);
  const double metres = progress(speed, seconds, parameters);
  const glm::dvec2 place = expectedPlaceAt(plan, direction, probabilities, none, metres, along);
  // The body keeps on for a moment where it moves otherwise than the ways ahead.
  constexpr double kStart = 0.1;  // metres; what the ways do at once
  const glm::dvec2 start =
      (expectedPlaceAt(plan, direction, probabilities, none, kStart, along) - plan) / kStart;
  const double tau = parameters.inertia;
  return place + (velocity - speed * start) * (tau * (1.0 - std::exp(-seconds / tau)));
}

}  // namespace forewalk::prediction
