#include "prediction/way_tracker.h"

#include <algorithm>
#include <cmath>

namespace forewalk::prediction {

namespace {

constexpr float kStorey = 1.5f;  // ends whose heights differ by more are on two storeys, metres
constexpr std::uint32_t kPairs = 16;  // room for so many close pairs per way
// A dead end and a cut end are seldom one way, but may be: the horizon comes to reach the dead end.
constexpr float kOtherReason = 0.2f;  // metres

float distanceToPiece(glm::vec2 point, glm::vec2 a, glm::vec2 b) {
  const glm::vec2 ab = b - a;
  const float squared = glm::dot(ab, ab);
  const float share =
      squared > 0.0f ? std::clamp(glm::dot(point - a, ab) / squared, 0.0f, 1.0f) : 0.0f;
  return glm::distance(point, a + share * ab);
}

}  // namespace

WayTracker::WayTracker(const WayTrackerSettings& settings) : settings_(settings) {
  known_.reserve(2 * settings.ways);
  kept_.reserve(2 * settings.ways);
  tails_.reserve(settings.ways);
  pairs_.reserve(static_cast<std::size_t>(kPairs) * settings.ways);
  knownTaken_.reserve(2 * settings.ways);
  ways_.reserve(settings.ways);
  events_.reserve(4 * settings.ways);
}

void WayTracker::restart() {
  known_.clear();
  ways_.clear();
  events_.clear();
  started_ = false;
}

WayTracker::Tail WayTracker::tailOf(const PredictionGraph& graph, std::size_t order) {
  const NodeId terminal = graph.terminals[order];
  const Node& node = graph.node(terminal);
  Tail tail{{}, node.plan, node.plan, node.height, node.reason != TerminalReason::kHorizon};
  if (graph.fronts.size() == graph.terminals.size()) {
    tail.left = graph.fronts[order].from;
    tail.right = graph.fronts[order].to;
  }
  tail.points[0] = node.plan;
  for (int i = 1; i < kTail; ++i) {
    const float s = node.distance - kTailStep * static_cast<float>(i);
    tail.points[static_cast<std::size_t>(i)] =
        s > 0.0f ? pointAlong(graph, terminal, s).plan : graph.source.plan;
  }
  return tail;
}

float WayTracker::distanceToTail(glm::vec2 point, const Tail& tail) {
  float least = glm::distance(point, tail.points[0]);
  for (std::size_t i = 1; i < kTail; ++i) {
    least = std::min(least, distanceToPiece(point, tail.points[i - 1], tail.points[i]));
  }
  return least;
}

float WayTracker::apartFrom(const Tail& a, const Tail& b) {
  // A front bulges, so the middles of two may be closer than a middle is to the other's chord.
  return std::min({distanceToPiece(a.points[0], b.left, b.right),
                   distanceToPiece(b.points[0], a.left, a.right),
                   glm::distance(a.points[0], b.points[0])});
}

float WayTracker::cost(const Tail& before, const Tail& now, float moved) const {
  const float apart = apartFrom(before, now);
  // Where ends lie close by they tell two ways apart that run side by side; the tails do where an
  // end has run ahead.
  const float end = std::max(0.0f, apart - moved);
  const float along = std::min(
      {distanceToTail(before.points[0], now), distanceToTail(now.points[0], before), apart});
  return 0.5f * (end + along) + (before.deadEnd != now.deadEnd ? kOtherReason : 0.0f);
}

void WayTracker::update(const PredictionGraph& graph) {
  events_.clear();
  const float moved = started_ ? glm::distance(graph.source.plan, lastPlan_) : 0.0f;
  started_ = true;
  lastPlan_ = graph.source.plan;
  const bool offMesh = (graph.flags & kSourceOffMesh) != 0;
  limitReached_ = graph.terminals.size() > settings_.ways;
  const std::size_t count =
      offMesh ? 0 : std::min<std::size_t>(graph.terminals.size(), settings_.ways);

  tails_.clear();
  for (std::size_t i = 0; i < count; ++i) tails_.push_back(tailOf(graph, i));
  pairs_.clear();
  for (std::uint32_t k = 0; k < known_.size(); ++k) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Tail& before = known_[k].tail;
      const float reach = settings_.gate + kTailStep * (kTail - 1) + moved;
      if (apartFrom(before, tails_[i]) > reach) continue;
      if (std::abs(before.height - tails_[i].height) > kStorey) continue;
      const float price = cost(before, tails_[i], moved + known_[k].gone);
      if (price > settings_.gate) continue;
      if (pairs_.size() == static_cast<std::size_t>(kPairs) * settings_.ways) {
        limitReached_ = true;
        continue;
      }
      pairs_.push_back({price, k, i});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), [this](const Pair& a, const Pair& b) {
    // One that lingers gives way to one that was there a frame ago.
    const bool lingersA = known_[a.known].order < 0, lingersB = known_[b.known].order < 0;
    if (lingersA != lingersB) return lingersB;
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.known != b.known) return known_[a.known].id < known_[b.known].id;
    return a.fresh < b.fresh;
  });

  ways_.clear();
  for (std::size_t i = 0; i < count; ++i) ways_.push_back({kNoWay, graph.terminals[i], -1, false});
  knownTaken_.assign(known_.size(), 0);
  for (const Pair& pair : pairs_) {
    TrackedWay& way = ways_[pair.fresh];
    if (way.id != kNoWay || knownTaken_[pair.known] != 0) continue;
    way.id = known_[pair.known].id;
    way.before = known_[pair.known].order;
    knownTaken_[pair.known] = 1;
  }

  // What is left over: the closest way on the other side says whether it was a split or a merge.
  kept_.clear();
  for (std::uint32_t k = 0; k < known_.size(); ++k) {
    if (knownTaken_[k] != 0) continue;
    Known gone = known_[k];
    if (gone.order >= 0) {
      gone.order = -1;
      gone.gone = 0.0f;
      gone.mergedInto = kNoWay;
      const auto into = std::find_if(pairs_.begin(), pairs_.end(),
                                     [k](const Pair& pair) { return pair.known == k; });
      if (into != pairs_.end()) gone.mergedInto = ways_[into->fresh].id;
    } else {
      gone.gone += moved;
    }
    const bool full = kept_.size() >= settings_.ways;
    if (full) limitReached_ = true;
    if (full || (gone.gone >= settings_.linger && !offMesh)) {
      const bool merged = gone.mergedInto != kNoWay;
      events_.push_back({merged ? WayChange::kMerge : WayChange::kDeath, gone.id, gone.mergedInto});
    } else {
      kept_.push_back(gone);
    }
  }
  std::sort(events_.begin(), events_.end(),
            [](const WayEvent& a, const WayEvent& b) { return a.way < b.way; });
  for (std::uint32_t i = 0; i < count; ++i) {
    TrackedWay& way = ways_[i];
    if (way.id != kNoWay) {
      if (way.before < 0) events_.push_back({WayChange::kReturn, way.id, kNoWay});
    } else {
      way.id = WayId{nextId_++};
      way.born = true;
      const auto from = std::find_if(pairs_.begin(), pairs_.end(), [this, i](const Pair& pair) {
        return pair.fresh == i && known_[pair.known].order >= 0;
      });
      if (from == pairs_.end()) {
        events_.push_back({WayChange::kBirth, way.id, kNoWay});
      } else {
        way.before = known_[from->known].order;
        events_.push_back({WayChange::kSplit, way.id, known_[from->known].id});
      }
    }
    kept_.push_back({way.id, tails_[i], static_cast<std::int32_t>(i), 0.0f, kNoWay});
  }
  std::swap(known_, kept_);
}

}  // namespace forewalk::prediction
