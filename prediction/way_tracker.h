// Ways that keep their names: which way of this frame is which way of the last one.
//
// A prediction graph is made anew every frame, its terminals in the order the search found them.
// Here a way gets an id that it keeps as long as it is the same way, matched by what it ends in and
// never by its order. As the user walks, a way ahead grows at its far end and a way behind is cut
// shorter: so the same way is the one whose last metre holds the old end, or whose end lies on the
// last metre of the old way. A way that ends in a dead end ends in the same place. Where the
// method knows the front that a way ends in (front_arc.h), being on the front is being at its end:
// where two fronts become one, its middle is new and its ends are not. Where ways end in a meeting,
// and now go on as one for a step or two beyond it, that one is the same as either.
//
// A new way that has just come out of the side of a known one was one with it until now, and a way
// that was that short when it vanished is one with the way it left: such are splits and merges. In
// a graph by fronts hardly a way comes from anywhere else.
//
// Matching is one to one, the closest pair first (ties by id, then by order), as in greedy data
// association in multi-target tracking. It depends on positions alone, so that a replay is
// bit-equal.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prediction/front_arc.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// Name of a way. Never used twice by one tracker.
enum class WayId : std::uint32_t {};
inline constexpr WayId kNoWay{0xffffffffu};
constexpr std::uint32_t index(WayId id) { return static_cast<std::uint32_t>(id); }

struct WayTrackerSettings {
  float gate = 0.5f;    ///< how far an end may lie off the other way, metres, > 0: a person's width
  float linger = 2.0f;  ///< a way that vanished keeps its name for so many metres walked, and may
                        ///< come back; only then it is reported dead or merged; >= 0
  std::uint32_t ways = 512;  ///< most ways of one frame and most that linger, >= 1
};

/// One way of the frame at hand.
struct TrackedWay {
  WayId id;
  NodeId terminal;      ///< in the graph of this frame
  std::int32_t before;  ///< index of the way it continues in the last frame's ways(), or of the one
                        ///< that it was split from; -1: neither
  bool born;            ///< new in this frame
};

enum class WayChange : std::uint8_t {
  kBirth,   ///< `way` is new and comes from nowhere known
  kDeath,   ///< `way` is gone and no way took its place
  kSplit,   ///< `way` is new; up to now it was one with `other`
  kMerge,   ///< `way` is gone; from now on it is one with `other`
  kReturn,  ///< `way` is back that had vanished a moment ago, neither died nor was born
};

struct WayEvent {
  WayChange change;
  WayId way;
  WayId other;  ///< kNoWay unless split or merge
};

/// Names the ways of frame after frame. One per user; not shared between threads. A few hundred
/// bytes per way, sized at the start; allocates nothing afterwards.
class WayTracker {
 public:
  explicit WayTracker(const WayTrackerSettings& settings = {});

  /// Names the terminals of `graph`, which follows the one given last. Any number of metres may lie
  /// between, but ends that moved farther than about two metres are not found again.
  ///
  /// Off the navmesh (kSourceOffMesh) there are no ways for the time being: those there were come
  /// back by name when the user does. Terminals beyond `settings.ways` are not named, and
  /// limitReached() says so. Costs O(pairs of ways whose ends are close).
  void update(const PredictionGraph& graph);

  /// Forgets all ways; ids go on.
  void restart();

  /// In the order of graph.terminals. This and events() live until the next update.
  std::span<const TrackedWay> ways() const { return ways_; }
  /// What happened in the last update: deaths and merges by id, then the others by order of ways().
  std::span<const WayEvent> events() const { return events_; }
  bool limitReached() const { return limitReached_; }

 private:
  static constexpr int kTail = 5;            // points of a tail
  static constexpr float kTailStep = 0.25f;  // metres between them
  /// Where a way ends.
  struct Tail {
    std::array<glm::vec2, kTail> points;  // its last metre, the end first
    FrontLine front;
    glm::vec2 low, high;  // the box that the front lies in
    glm::vec2 branch;     // where it left the others
    float height;         // of the end
    bool deadEnd;
    bool isShort;   // it has hardly left the others
    bool fromJoin;  // ways came together where it begins
    bool isMeeting;
  };
  /// A way that had a name when the last update was over.
  struct Known {
    WayId id;
    Tail tail;
    std::int32_t order;  // in the last frame's ways, or -1 while it lingers
    float gone;          // metres walked since it vanished
    WayId beside;        // the way that it had just left when it was there last, or kNoWay
    WayId mergedInto;    // while it lingers
  };
  struct Pair {
    float cost;
    std::uint32_t known, fresh;
  };

  static Tail tailOf(const PredictionGraph& graph, std::size_t order);
  static float distanceToFront(glm::vec2 place, const Tail& tail);
  float cost(const Tail& before, const Tail& now, float moved) const;
  bool isFar(const Tail& before, const Tail& now, float moved) const;
  void pairUp(std::uint32_t known, float moved);
  void nameAll();
  void giveUp(float moved, bool offMesh);
  void announce(const PredictionGraph& graph);
  std::int32_t besideOf(const PredictionGraph& graph, std::uint32_t fresh, bool knownOnly) const;

  WayTrackerSettings settings_;
  std::uint32_t nextId_ = 0;
  bool limitReached_ = false;
  bool started_ = false;
  glm::vec2 lastPlan_{0.0f};
  std::vector<Known> known_;
  std::vector<Known> kept_;  // of the next frame
  std::vector<Tail> tails_;  // per fresh way
  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> knownTaken_;
  std::vector<TrackedWay> ways_;
  std::vector<WayEvent> events_;
};

}  // namespace forewalk::prediction
