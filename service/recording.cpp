#include "service/recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "navmesh/plan.h"
#include "prediction/distance_field.h"
#include "prediction/front_arc.h"
#include "prediction/front_graph.h"
#include "service/parallel.h"

namespace forewalk::service {

namespace {

using prediction::PredictionGraph;

constexpr double kExitGate = 1.5;     // metres from where the walk leaves to the way's end
constexpr double kEndReached = 0.5;   // metres
constexpr double kSamePlace = 0.1;    // metres
constexpr double kLongestPath = 8.0;  // metres of a way that are kept

glm::dvec2 unit(glm::dvec2 v) {
  const double length = glm::length(v);
  return length > 1e-9 ? v / length : glm::dvec2(0.0);
}

/// Off by how much a walk may be that leans over the navmesh's border.
constexpr navmesh::SnapLimits kSnap{0.5f, 2.2f, 2.2f};

/// A graph that says that there is none.
PredictionGraph nowhere(float horizon, glm::vec2 plan) {
  PredictionGraph graph;
  graph.horizon = horizon;
  graph.flags = prediction::kSourceOffMesh;
  graph.source.plan = plan;
  return graph;
}

/// Mean distance of the walk from frame `from` to frame `to` off the taut path of a way.
double meanOffPath(const PredictionGraph& graph, std::size_t terminal,
                   const std::vector<std::optional<navmesh::Location>>& places, std::size_t from,
                   std::size_t to) {
  constexpr float kStep = 0.5f;
  const prediction::NodeId node = graph.terminals[terminal];
  double sum = 0.0, count = 0.0;
  for (std::size_t f = from; f <= to; ++f) {
    if (!places[f]) continue;
    float nearest = std::numeric_limits<float>::infinity();
    for (float s = 0.0f; s < graph.node(node).distance + kStep; s += kStep) {
      nearest = std::min(
          nearest, glm::distance(prediction::pointAlong(graph, node, s).plan, places[f]->plan));
    }
    sum += static_cast<double>(nearest);
    count += 1.0;
  }
  return sum / count;
}

void settle(Sample& sample, const PredictionGraph& graph, const prediction::DistanceField& field,
            const std::vector<std::optional<navmesh::Location>>& places, double rate) {
  sample.outcome = Outcome::kUnsettled;
  std::vector<std::size_t> near;
  std::vector<prediction::FrontLine> fronts;
  for (std::size_t i = 0; i < graph.terminals.size(); ++i) {
    fronts.push_back(prediction::frontLine(graph, i));
  }
  for (std::size_t f = sample.frame; f < places.size(); ++f) {
    if (!places[f]) continue;
    const bool out = field.distanceAt(places[f]->polygon, places[f]->plan) >= graph.horizon;
    double nearest = std::numeric_limits<double>::infinity();
    const auto distanceTo = [&](std::size_t i) {
      const prediction::Node& node = graph.node(graph.terminals[i]);
      const bool goesOn = node.reason == prediction::TerminalReason::kHorizon;
      if (goesOn != out || (!goesOn && static_cast<double>(node.distance) < prediction::kArrived)) {
        return std::numeric_limits<double>::infinity();
      }
      return static_cast<double>(prediction::distanceToLine(places[f]->plan, fronts[i]));
    };
    for (std::size_t i = 0; i < graph.terminals.size(); ++i) {
      nearest = std::min(nearest, distanceTo(i));
    }
    if (!out && nearest > kEndReached) continue;
    sample.settledAfter = static_cast<double>(f - sample.frame) / rate;
    sample.outcome = nearest <= (out ? kExitGate : kEndReached) ? Outcome::kTaken : Outcome::kNoWay;
    if (sample.outcome == Outcome::kNoWay) return;
    // Ways that come from two sides end in one place: the walk tells by which it came.
    near.clear();
    for (std::size_t i = 0; i < graph.terminals.size(); ++i) {
      if (distanceTo(i) <= nearest + kSamePlace) near.push_back(i);
    }
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : near) {
      const double off = near.size() > 1 ? meanOffPath(graph, i, places, sample.frame, f) : 0.0;
      if (off < least) {
        least = off;
        sample.taken = i;
      }
    }
    return;
  }
}

}  // namespace

WayTurnover& WayTurnover::operator+=(const WayTurnover& other) {
  metres += other.metres;
  frames += other.frames;
  ways += other.ways;
  births += other.births;
  deaths += other.deaths;
  splits += other.splits;
  merges += other.merges;
  returns += other.returns;
  return *this;
}

glm::dvec2 alongPath(const std::vector<glm::dvec2>& path, double s) {
  const double at = s / kPathStep;
  const auto piece = static_cast<std::size_t>(std::max(0.0, at));
  if (piece + 1 >= path.size()) return path.back();
  return path[piece] + (at - static_cast<double>(piece)) * (path[piece + 1] - path[piece]);
}

GraphMaker polygonMethod(const navmesh::World& world) {
  const auto scratch = std::make_shared<prediction::Scratch>(world.graph);
  return
      [&world, scratch](const navmesh::Location& source, float horizon) -> const PredictionGraph& {
        return prediction::predict(world.graph, source, horizon, *scratch);
      };
}

GraphMaker frontMethod(const navmesh::World& world) {
  struct Memory {
    prediction::FrontIndex index;
    prediction::FrontScratch scratch;
    explicit Memory(const navmesh::NavGraph& graph)
        : index(prediction::makeFrontIndex(graph)), scratch(graph, index) {}
  };
  const auto memory = std::make_shared<Memory>(world.graph);
  return
      [&world, memory](const navmesh::Location& source, float horizon) -> const PredictionGraph& {
        return prediction::predictFronts(world.graph, source, horizon, memory->scratch);
      };
}

MethodFactory factoryOf(prediction::Method method) {
  return method == prediction::Method::kFront ? frontMethod : polygonMethod;
}

RecordedWalk record(const navmesh::World& world, const rdw::Walk& walk, const MethodFactory& method,
                    const RecordingSettings& settings) {
  RecordedWalk recorded;
  recorded.walker = walk.walker;
  const std::vector<rdw::WalkFrame> walked = rdw::resample(walk, settings.rate);
  const double frameSeconds = 1.0 / settings.rate;

  std::vector<std::optional<navmesh::Location>> places;
  places.reserve(walked.size());
  std::optional<navmesh::Location> last;
  for (const rdw::WalkFrame& frame : walked) {
    const glm::vec3 position =
        navmesh::toSpace(glm::vec2(frame.plan), last ? last->height : settings.height);
    places.push_back(last
                         ? navmesh::locateFrom(world.graph, world.locations, *last, position, kSnap)
                         : navmesh::locate(world.graph, world.locations, position, kSnap));
    if (!places.back()) {
      ++recorded.offMesh;
      continue;
    }
    last = places.back();
    if (last->snapped) {
      ++recorded.snapped;
      recorded.worstSnap =
          std::max(recorded.worstSnap, glm::distance(glm::dvec2(last->plan), frame.plan));
    }
  }
  std::vector<double> pathLength(walked.size(), 0.0);
  for (std::size_t f = 1; f < walked.size(); ++f) {
    pathLength[f] = pathLength[f - 1] + glm::distance(walked[f].plan, walked[f - 1].plan);
  }

  const GraphMaker graphOf = method(world);
  const prediction::PortalEnds ends = prediction::makePortalEnds(world.graph);
  prediction::DistanceField field(world.graph, ends);
  prediction::WayLikelihood likelihood({}, settings.ways);
  const auto stride =
      static_cast<std::size_t>(std::max(1.0, std::round(settings.sampleEvery * settings.rate)));
  PredictionGraph none;
  recorded.frames.reserve(walked.size());
  for (std::size_t f = 0; f < walked.size(); ++f) {
    if (!places[f]) none = nowhere(settings.horizon, glm::vec2(walked[f].plan));
    const PredictionGraph& graph = places[f] ? graphOf(*places[f], settings.horizon) : none;
    likelihood.update(graph, {f == 0 ? 0.0 : frameSeconds, {}, {}});
    const std::span<const prediction::WayFacts> facts = likelihood.facts();
    recorded.frames.push_back({recorded.facts.size(), facts.size(), likelihood.walked(),
                               walked[f].plan, likelihood.motion().velocity()});
    recorded.facts.insert(recorded.facts.end(), facts.begin(), facts.end());

    WayTurnover& turnover = recorded.turnover;
    turnover.metres += likelihood.walked().metres;
    ++turnover.frames;
    turnover.ways += facts.size();
    for (const prediction::WayEvent& event : likelihood.tracker().events()) {
      turnover.births += event.change == prediction::WayChange::kBirth && f > 0;
      turnover.deaths += event.change == prediction::WayChange::kDeath;
      turnover.splits += event.change == prediction::WayChange::kSplit;
      turnover.merges += event.change == prediction::WayChange::kMerge;
      turnover.returns += event.change == prediction::WayChange::kReturn;
    }

    if (f % stride != 0 || !places[f] || facts.empty()) continue;
    if (!recorded.samples.empty()) {
      const RecordedFrame& before = recorded.frames[recorded.samples.back().frame];
      if (glm::distance(before.plan, walked[f].plan) < settings.spacing) continue;
    }
    Sample sample{};
    sample.frame = f;
    field.run(*places[f], settings.horizon);
    settle(sample, graph, field, places, settings.rate);
    const glm::dvec2 here(graph.source.plan);
    for (const prediction::TrackedWay& way : likelihood.ways()) {
      const prediction::Node& node = graph.node(way.terminal);
      sample.toEnd.push_back(unit(glm::dvec2(node.plan) - here));
      std::vector<glm::dvec2>& path = sample.paths.emplace_back();
      const double length = std::min(kLongestPath, static_cast<double>(node.distance));
      for (double s = 0.0; s < length + kPathStep; s += kPathStep) {
        path.emplace_back(prediction::pointAlong(graph, way.terminal, static_cast<float>(s)).plan);
      }
    }
    for (; sample.afterKnown < kSecondsAhead.size(); ++sample.afterKnown) {
      const double at = static_cast<double>(f) + kSecondsAhead[sample.afterKnown] * settings.rate;
      const auto piece = static_cast<std::size_t>(at);
      if (piece + 1 >= walked.size()) break;
      sample.after[sample.afterKnown] =
          glm::mix(walked[piece].plan, walked[piece + 1].plan, at - static_cast<double>(piece));
    }
    for (; sample.alongKnown < kMetresAhead.size(); ++sample.alongKnown) {
      const double length = pathLength[f] + kMetresAhead[sample.alongKnown];
      const auto at = std::lower_bound(pathLength.begin(), pathLength.end(), length);
      if (at == pathLength.end()) break;
      sample.along[sample.alongKnown] =
          walked[static_cast<std::size_t>(at - pathLength.begin())].plan;
    }
    recorded.samples.push_back(std::move(sample));
  }
  return recorded;
}

std::vector<RecordedWalk> recordAll(const navmesh::World& world, std::span<const rdw::Walk> walks,
                                    const MethodFactory& method, const RecordingSettings& settings,
                                    unsigned threads) {
  std::vector<RecordedWalk> recorded(walks.size());
  onThreads(threads)(walks.size(), [&](std::size_t w) {
    recorded[w] = record(world, walks[w], method, settings);
  });
  return recorded;
}

}  // namespace forewalk::service
