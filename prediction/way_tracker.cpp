#include "prediction/way_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forewalk::prediction {

namespace {

constexpr float kStorey = 1.5f;  // ends whose heights differ by more are on two storeys, metres
constexpr std::uint32_t kPairs = 16;  // room for so many close pairs per way
// A dead end and a cut end are seldom one way, but may be: the horizon comes to reach the dead end.
constexpr float kOtherReason = 0.2f;  // metres
// A way that goes no farther beyond its branch has just left the others: the persistence of graphs
// by fronts and a step.
constexpr float kShort = 1.25f;         // metres
constexpr float kBeyondMeeting = 0.1f;  // metres; what it costs to go on where ways met

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
  const Node& branch = graph.node(node.prev);
  Tail tail{};
  tail.points[0] = node.plan;
  for (int i = 1; i < kTail; ++i) {
    const float s = node.distance - kTailStep * static_cast<float>(i);
    tail.points[static_cast<std::size_t>(i)] =
        s > 0.0f ? pointAlong(graph, terminal, s).plan : graph.source.plan;
  }
  tail.front = frontLine(graph, order);
  tail.low = tail.high = tail.front[0];
  for (const glm::vec2 point : tail.front) {
    tail.low = glm::min(tail.low, point);
    tail.high = glm::max(tail.high, point);
  }
  tail.branch = branch.plan;
  tail.height = node.height;
  tail.deadEnd = node.reason != TerminalReason::kHorizon;
  tail.isShort = node.distance - branch.distance < kShort;
  tail.fromJoin = branch.kind == NodeKind::kJoin;
  tail.isMeeting = node.reason == TerminalReason::kMeeting;
  return tail;
}

/// How far a place is from the front that a way ends in.
float WayTracker::distanceToFront(glm::vec2 place, const Tail& tail) {
  return tail.low == tail.high ? glm::distance(place, tail.low) : distanceToLine(place, tail.front);
}

/// What it costs to take two tails for those of one way; where that is more than the gate, some
/// cost that is, too.
float WayTracker::cost(const Tail& before, const Tail& now, float moved) const {
  const auto goesOn = [](const Tail& met, const Tail& beyond) {
    return met.isMeeting && beyond.isShort && beyond.fromJoin
               ? glm::distance(met.points[0], beyond.branch) + kBeyondMeeting
               : std::numeric_limits<float>::infinity();
  };
  const float beyond = std::min(goesOn(before, now), goesOn(now, before));
  const float apart =
      std::min(distanceToFront(before.points[0], now), distanceToFront(now.points[0], before));
  // Where ends lie close by they tell two ways apart that run side by side; the tails do where an
  // end has run ahead.
  const float end = std::max(0.0f, apart - moved);
  if (0.5f * end > settings_.gate) return beyond;
  const float along = apart == 0.0f
                          ? 0.0f
                          : std::min({distanceToLine(before.points[0], now.points),
                                      distanceToLine(now.points[0], before.points), apart});
  const float price = 0.5f * (end + along) + (before.deadEnd != now.deadEnd ? kOtherReason : 0.0f);
  return std::min(price, beyond);
}

/// Whether a pair of ways cannot but cost more than the gate: by the boxes that their fronts lie
/// in, which are farther from the ends than may be.
bool WayTracker::isFar(const Tail& before, const Tail& now, float moved) const {
  constexpr float kRounding = 1e-3f;  // metres
  const float most = 2.0f * settings_.gate + moved + kRounding;
  const auto isBeyond = [most](glm::vec2 end, const Tail& tail) {
    const glm::vec2 off = end - glm::clamp(end, tail.low, tail.high);
    return glm::dot(off, off) > most * most;
  };
  const auto mayGoOn = [](const Tail& met, const Tail& beyond) {
    return met.isMeeting && beyond.isShort && beyond.fromJoin;
  };
  return isBeyond(before.points[0], now) && isBeyond(now.points[0], before) &&
         !mayGoOn(before, now) && !mayGoOn(now, before);
}

/// Lists what a known way may go on as.
void WayTracker::pairUp(std::uint32_t k, float moved) {
  const Tail& before = known_[k].tail;
  for (std::uint32_t i = 0; i < tails_.size(); ++i) {
    const Tail& now = tails_[i];
    if (isFar(before, now, moved + known_[k].gone)) continue;
    if (std::abs(before.height - now.height) > kStorey) continue;
    const float price = cost(before, now, moved + known_[k].gone);
    if (price > settings_.gate) continue;
    if (pairs_.size() == static_cast<std::size_t>(kPairs) * settings_.ways) {
      limitReached_ = true;
      continue;
    }
    pairs_.push_back({price, k, i});
  }
}

/// Gives names to the ways that are known, the closest pair first.
void WayTracker::nameAll() {
  std::sort(pairs_.begin(), pairs_.end(), [this](const Pair& a, const Pair& b) {
    // One that lingers gives way to one that was there a frame ago.
    const bool lingersA = known_[a.known].order < 0, lingersB = known_[b.known].order < 0;
    if (lingersA != lingersB) return lingersB;
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.known != b.known) return known_[a.known].id < known_[b.known].id;
    return a.fresh < b.fresh;
  });
  knownTaken_.assign(known_.size(), 0);
  for (const Pair& pair : pairs_) {
    TrackedWay& way = ways_[pair.fresh];
    if (way.id != kNoWay || knownTaken_[pair.known] != 0) continue;
    way.id = known_[pair.known].id;
    way.before = known_[pair.known].order;
    knownTaken_[pair.known] = 1;
  }
}

/// Lets the known ways linger that no way of this frame goes on, and reports those that are gone
/// for good.
void WayTracker::giveUp(float moved, bool offMesh) {
  const auto isThere = [this](WayId id) {
    return id != kNoWay && std::any_of(ways_.begin(), ways_.end(),
                                       [id](const TrackedWay& way) { return way.id == id; });
  };
  for (std::uint32_t k = 0; k < known_.size(); ++k) {
    if (knownTaken_[k] != 0) continue;
    Known gone = known_[k];
    if (gone.order >= 0) {
      gone.order = -1;
      gone.gone = 0.0f;
      gone.mergedInto = kNoWay;
      const auto into = std::find_if(pairs_.begin(), pairs_.end(),
                                     [k](const Pair& pair) { return pair.known == k; });
      if (into != pairs_.end()) {
        gone.mergedInto = ways_[into->fresh].id;
      } else if (isThere(gone.beside)) {
        gone.mergedInto = gone.beside;
      }
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
}

/// The way that fresh way `i` has just left, by its order; -1: none. Where it ends in a meeting
/// that another has just come to, the one that the other left: the two were one beyond a join.
/// `knownOnly`: of those that were there a frame ago.
std::int32_t WayTracker::besideOf(const PredictionGraph& graph, std::uint32_t i,
                                  bool knownOnly) const {
  std::uint32_t leaves = i;
  if (!tails_[i].isShort) {
    if (!tails_[i].isMeeting) return -1;
    const auto met = std::find_if(tails_.begin(), tails_.end(), [&](const Tail& tail) {
      return tail.isMeeting && tail.isShort && tail.points[0] == tails_[i].points[0];
    });
    if (met == tails_.end()) return -1;
    leaves = static_cast<std::uint32_t>(met - tails_.begin());
  }
  const NodeId branch = graph.node(ways_[leaves].terminal).prev;
  if (graph.node(branch).kind == NodeKind::kSource) return -1;
  std::int32_t nearest = -1;
  float least = std::numeric_limits<float>::infinity();
  for (std::uint32_t other = 0; other < ways_.size(); ++other) {
    if (other == i || other == leaves) continue;
    if (knownOnly && (ways_[other].before < 0 || ways_[other].born)) continue;
    NodeId at = graph.node(ways_[other].terminal).prev;
    while (at > branch && at != kNoNode) at = graph.node(at).prev;  // parents come before children
    if (at != branch) continue;
    const float apart = glm::distance(tails_[other].points[0], tails_[i].points[0]);
    if (apart < least) {
      least = apart;
      nearest = static_cast<std::int32_t>(other);
    }
  }
  return nearest;
}

/// Names the ways that nobody knew, and reports who is new or back.
void WayTracker::announce(const PredictionGraph& graph) {
  for (std::uint32_t i = 0; i < ways_.size(); ++i) {
    TrackedWay& way = ways_[i];
    if (way.id != kNoWay) {
      if (way.before < 0) events_.push_back({WayChange::kReturn, way.id, kNoWay});
      continue;
    }
    way.id = WayId{nextId_++};
    way.born = true;
    const auto from = std::find_if(pairs_.begin(), pairs_.end(), [this, i](const Pair& pair) {
      return pair.fresh == i && known_[pair.known].order >= 0;
    });
    WayId other = kNoWay;
    if (from != pairs_.end()) {
      way.before = known_[from->known].order;
      other = known_[from->known].id;
    } else if (const std::int32_t beside = besideOf(graph, i, true); beside >= 0) {
      way.before = ways_[static_cast<std::size_t>(beside)].before;
      other = ways_[static_cast<std::size_t>(beside)].id;
    }
    events_.push_back({other == kNoWay ? WayChange::kBirth : WayChange::kSplit, way.id, other});
  }
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
  ways_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    tails_.push_back(tailOf(graph, i));
    ways_.push_back({kNoWay, graph.terminals[i], -1, false});
  }
  pairs_.clear();
  for (std::uint32_t k = 0; k < known_.size(); ++k) pairUp(k, moved);
  nameAll();
  kept_.clear();
  giveUp(moved, offMesh);
  announce(graph);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t beside = besideOf(graph, i, false);
    kept_.push_back({ways_[i].id, tails_[i], static_cast<std::int32_t>(i), 0.0f,
                     beside < 0 ? kNoWay : ways_[static_cast<std::size_t>(beside)].id, kNoWay});
  }
  std::swap(known_, kept_);
}

}  // namespace forewalk::prediction
