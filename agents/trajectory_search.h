// Which way to walk for the next seconds: the best of many sampled trajectories.
//
// A trajectory holds one command (linear and angular velocity) for its first half and another for
// its second, or one for all of it. It is a row of points, one every `step` seconds, joined by
// chords. Each chord with the body's radius around it is a capsule; where a capsule meets an agent
// on its predicted way, or a wall, the trajectory is dismissed. The rest are rated by four
// penalties, each in [0, 1], and the least sum by weight wins:
//
//   obstacles, agents  how near it comes: 0 beyond the personal space, 1 at contact, at its worst
//                      point (above 1 only for bodies that overlap and part)
//   course             how far its points lie from those of a straight walk to the target at
//                      comfort speed (metres, and if wanted the angle between the directions, as
//                      the chord of the unit circle: radians for small ones), summed over the
//                      points, over the worst that could be reached
//   speed              the difference from the speed of that straight walk, likewise
//
// Equal sums: the first of the first commands, then of the second. When all are dismissed, the one
// that walks freely for the most points is taken, of those the one with the least sum of course and
// speed; and when none gets as far as the first point, nothing is.
//
// The search gives to the last bit what rating all of them gives, which tests compare. It rates
// first halves in the order of a lower bound of all that can follow, stops when that exceeds the
// best, drops all that follows a first half that hits, rates second halves by course and speed
// before looking at what is in the way, and looks only at what can be reached by then.
//
// The model is the navigation of Golaem's crowds, as its manual describes it (models/golaem.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "agents/locomotion.h"

namespace forewalk::agents {

/// Whoever or whatever is round, walking on as it does now. `position` is from the body, metres on
/// the plan; `contact` the distance between the centres at touch.
struct PredictedDisc {
  glm::vec2 position{0.0f};
  glm::vec2 velocity{0.0f};  ///< m/s
  float contact = 0.5f;      ///< metres, > 0
  /// Nearer than this at any time dismisses, and nearer than `keep` at a point. Both are `contact`,
  /// but less for bodies that touch already, so that they may part, a little nearer on the way.
  float hit = 0.5f;
  float keep = 0.5f;
  bool agent = true;  ///< which of the two penalties it is counted for
};

/// A wall's segment, from the body; `contact` is how far the body's centre has to stay away.
struct PredictedWall {
  glm::vec2 from{0.0f};
  glm::vec2 to{0.0f};
  glm::vec2 velocity{0.0f};
  float contact = 0.25f;
  float hit = 0.25f;
  float keep = 0.25f;
};

struct TrajectoryWeights {
  float obstacles = 1.0f;  ///< >= 0, as all four
  float agents = 1.0f;
  float course = 4.0f;
  float speed = 0.5f;
  float agentSpace = 0.6f;     ///< personal space beyond touch, metres, > 0
  float obstacleSpace = 0.3f;  ///< the same for obstacles
  bool angular = true;         ///< whether directions count for the course
  /// How directions count against metres, and the last point against the first (linear in
  /// between): +1 is 1.1 times, -5 is 1/1.5 times.
  float angularWeight = 0.0f;
  float futureWeight = 0.0f;
};

/// 1 + w/10 for w >= 0, 1/(1 - w/10) below.
float factorOfWeight(float weight);

/// What is to be searched. Seen from the body: it stands at (0, 0).
struct TrajectoryProblem {
  glm::vec2 heading{0.0f, 1.0f};    ///< where it looks, unit vector
  std::span<const Command> first;   ///< for the first half
  std::span<const Command> second;  ///< for the second; empty: the first is held throughout
  std::uint32_t points = 10;        ///< 1 to kMostPoints; the first half has the odd one
  float step = 0.25f;               ///< seconds from point to point, > 0
  glm::vec2 towards{0.0f};          ///< to the target, unit vector; (0, 0): stay here
  float comfortSpeed = 0.0f;        ///< of the straight walk, m/s
  float remaining = 0.0f;           ///< the straight walk ends after so many metres
  std::span<const PredictedDisc> discs;
  std::span<const PredictedWall> walls;
  TrajectoryWeights weights;
};

inline constexpr std::uint32_t kMostPoints = 64;

struct TrajectoryScore {
  float course = 0.0f, speed = 0.0f, agents = 0.0f, obstacles = 0.0f;  ///< penalties, unweighted
  float penalty = 0.0f;        ///< their sum by weight; of a dismissed one course and speed only
  std::uint32_t hitPoint = 0;  ///< the capsule that hit, from 1; 0: free
};

struct TrajectoryChoice {
  enum class Kind : std::uint8_t {
    free,
    dismissed,  ///< none was free: the one that is so for longest
    none,       ///< not even that
  };
  Kind kind = Kind::none;
  std::uint32_t first = 0, second = 0;  ///< of the commands; second is 0 where there are none
  float penalty = 0.0f;                 ///< as TrajectoryScore::penalty
  std::uint32_t hitPoint = 0;
  bool operator==(const TrajectoryChoice&) const = default;
};

/// A search and the memory it works in, which grows to the largest problem and is then used again.
class TrajectorySearch {
 public:
  /// Takes a problem, whose spans have to live as long as questions are asked about it. Makes the
  /// tables that all trajectories share.
  void prepare(const TrajectoryProblem& problem);

  /// Makes room for problems up to this size, so that nothing is allocated later.
  void reserve(std::size_t first, std::size_t second, std::size_t points, std::size_t discs,
               std::size_t walls);

  /// One trajectory, looked at all the way. O(points * (discs + walls)).
  TrajectoryScore score(std::uint32_t first, std::uint32_t second) const;

  /// Its points, without the first one at (0, 0). Replaces `points`.
  void trace(std::uint32_t first, std::uint32_t second, std::vector<glm::vec2>& points) const;

  /// The best of all.
  TrajectoryChoice best();

  /// The same by looking at each of them: what best() has to give.
  TrajectoryChoice bestByScores() const;

  /// How many second halves the last best() looked at for collisions.
  std::uint32_t lookedAt() const { return lookedAt_; }

 private:
  struct Path {  // what a walker has done by some point
    glm::vec2 place{0.0f};
    glm::vec2 direction{0.0f};  // of the body, unit vector
    float course = 0.0f;        // sums, not yet divided
    float speed = 0.0f;
  };
  struct Near {  // penalties of nearness so far, unweighted
    float agents = 0.0f, obstacles = 0.0f;
  };
  struct Turn {                  // of a command: half a step's turn, and the chord's length
    glm::vec2 half{1.0f, 0.0f};  // cosine, sine
    float chord = 0.0f;
  };
  struct Order {
    float bound;
    std::uint32_t first;
  };

  struct Reach {  // who and what can be near at each of some points
    struct Start {
      std::uint32_t discs, walls;
    };
    std::vector<std::uint32_t> discs, walls;
    std::vector<Start> starts;  // one a point, and the end
    bool empty() const { return discs.empty() && walls.empty(); }
  };

  static Turn turnOf(Command command, float step);
  static void advance(const Turn& turn, glm::vec2& place, glm::vec2& direction);
  void prepareStraight();
  void prepareSeconds();
  void prepareSurroundings();
  float courseAt(std::uint32_t point, glm::vec2 place, glm::vec2 direction) const;
  float costOf(float course, float speed) const;
  float penaltyOf(float cost, const Near& near) const;
  Path pathOfFirst(std::uint32_t first) const;
  glm::vec2 secondPlace(const Path& end, std::uint32_t k, std::uint32_t second) const;
  // The next five: whether the capsule (or at which point a trajectory) hits.
  bool lookAtDisc(std::uint32_t disc, std::uint32_t point, glm::vec2 from, glm::vec2 to,
                  Near& near) const;
  bool lookAtWall(std::uint32_t wall, std::uint32_t point, glm::vec2 from, glm::vec2 to,
                  Near& near) const;
  bool lookAround(const Reach& reach, std::uint32_t row, std::uint32_t point, glm::vec2 from,
                  glm::vec2 to, Near& near) const;
  std::uint32_t lookAtFirst(std::uint32_t first, Near& near) const;
  std::uint32_t lookAtSecond(std::uint32_t second, glm::vec2 end, Near& near) const;
  float boundAfter(const Path& end) const;
  void gatherReachable(glm::vec2 from, std::uint32_t fromPoint, std::uint32_t toPoint,
                       Reach& reach) const;
  void costsOfSecond(const Path& end);
  void trySeconds(std::uint32_t first, const Near& before, TrajectoryChoice& best,
                  TrajectoryChoice& dismissed);
  void settleEarlyHits(TrajectoryChoice& dismissed);

  TrajectoryProblem problem_;
  std::uint32_t firstPoints_ = 0, secondPoints_ = 0;
  float angular_ = 0.0f;                          // metres a radian; 0: directions do not count
  float fastest_ = 0.0f;                          // of all commands, m/s
  float courseScale_ = 0.0f, speedScale_ = 0.0f;  // 1 over the worst
  float leastSecondSpeed_ = 0.0f;
  // Per point, from 1 (0 is the start).
  std::vector<glm::vec2> straight_;  // of the walk to the target
  std::vector<float> straightSpeed_, pointWeight_;
  std::vector<glm::vec2> discAt_;         // [point * discs + disc]
  std::vector<float> discFar_, wallFar_;  // beyond this from a point, nothing happens near it
  // Second halves as seen from where they begin, looking along +y; [(point - 1) * seconds + second]
  std::vector<float> secondX_, secondY_, secondDirX_, secondDirY_;
  std::vector<float> secondSpeed_;  // sums
  // While searching.
  std::vector<Path> ends_;
  std::vector<Order> order_;
  Reach reachOfFirst_, reachOfSecond_;
  std::vector<float> cost_, placeX_, placeY_;
  std::vector<std::uint32_t> open_;
  std::vector<std::uint32_t> hitEarly_;  // first halves that hit at the latest such point
  std::uint32_t latestEarlyHit_ = 0;
  std::uint32_t lookedAt_ = 0;
};

}  // namespace forewalk::agents
