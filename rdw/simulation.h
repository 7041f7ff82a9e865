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
#include <span>
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
  float startHeight = 0.0f;         ///< of the virtual floor at the start, world y, metres
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

/// What users have in common who walk at the same time.
enum class Sharing : std::uint8_t {
  kRoom,   ///< one tracked space: controllers and resets see the others' bodies (other_user.h)
  kWorld,  ///< a virtual world, each in a room of their own
};

/// Several users at once, frame by frame: everybody sees the others where they were in the frame
/// before, so that the order of `users` makes no difference (but for rounding, from three on).
/// Whoever is done leaves the room. In `world`, users meet by way of `companies`, one per user, or
/// empty: they walk through each other. A result per user, in their order; `run.company` is not
/// used.
///
/// Fails as simulate, where there are none or more than kMostOthers + 1 users, or their rates
/// differ. Costs a frame of every session a frame.
[[nodiscard]] tl::expected<std::vector<SimulationResult>, Error> simulateTogether(
    std::shared_ptr<const navmesh::World> world, std::span<const SimulationConfig> users,
    Sharing sharing, const SimulationRun& run = {}, std::span<Company* const> companies = {});

/// Places for `users` in one room, as far from each other and from the walls as a grid of steps
/// finds, each looking at the room's centre; one user: the centre, facing -Z. O(users * corners),
/// some milliseconds.
///
/// Fails (kSettingOutOfRange) where two would stand nearer than a metre, or one nearer than a
/// quarter to a wall.
[[nodiscard]] tl::expected<std::vector<PlanarPose>, Error> placesInRoom(const TrackedSpace& space,
                                                                        std::size_t users);

/// The seed of the i-th user of a walk; the first has the walk's own.
std::uint64_t seedOfUser(std::uint64_t seed, std::size_t user);

}  // namespace forewalk::rdw
