// The walking simulation: a walker and a session, frame by frame, in a closed loop.
//
// The walker moves its body, the session answers with what the walker sees, and the walker's next
// move follows from that. No clock: frames come at a fixed rate of simulated time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/company.h"
#include "rdw/session.h"
#include "rdw/trace.h"
#include "rdw/walker.h"

namespace forewalk::rdw {

/// When a walk ends, besides the end of waypoints or recording, and being stuck. Whichever comes
/// first.
struct StopConditions {
  double virtualMetres = std::numeric_limits<double>::infinity();  ///< > 0
  double seconds = std::numeric_limits<double>::infinity();        ///< simulated, > 0
};

/// A walker is stuck when it wanted to walk for this long and came less than a metre further in the
/// virtual world, seconds. Its own pauses do not count.
inline constexpr double kStuckSeconds = 50.0;

struct SimulationConfig {
  SessionSettings session;  ///< `start` is overwritten by the walker's start
  User user;
  WalkStart start;  ///< `physical` defaults to the origin, facing -Z
  StopConditions stop;
  double rate = 90.0;      ///< frames per simulated second, [5, 1000]
  std::uint64_t seed = 1;  ///< of everything random
  bool keepFrames = true;  ///< false: only the summary, and no memory per frame
};

struct SimulationResult {
  std::vector<FrameRecord> frames;  ///< empty unless keepFrames
  Summary summary;
};

/// What the caller may bring along.
struct SimulationRun {
  std::function<double()> microseconds;  ///< a clock for the time columns; empty: they stay 0
  std::function<void(double done)>
      progress;                       ///< share of the walk, [0, 1], about every simulated second
  std::function<bool()> interrupted;  ///< asked as often; true ends the walk
  Company* company = nullptr;  ///< who else is in the building; null: nobody. Used for one walk
};

/// Walks. `world` may be null, which is an endless open plane: for controllers that need no
/// prediction.
///
/// In company, what others block is closed, or costs more, in the user's prediction from the next
/// frame on, whichever the method; a user who makes way (Company::userAvoids) walks around others
/// and around what is blocked, one who does not, and a recorded one, walks as if alone.
///
/// Fails when the company cannot begin, the session or the walker cannot be made (see
/// Session::make, makeWalker), a stop condition or the rate is out of range, an endless plan has no
/// stop condition, or a predictive controller has no navmesh (kSettingOutOfRange). Costs a frame of
/// the session a frame.
[[nodiscard]] tl::expected<SimulationResult, Error> simulate(
    std::shared_ptr<const navmesh::World> world, const SimulationConfig& config,
    const SimulationRun& run = {});

}  // namespace forewalk::rdw
