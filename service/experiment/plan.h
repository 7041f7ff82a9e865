// `forewalk.experiment/1`: which walks are to be compared, as a JSON file.
//
//   {
//     "format": "forewalk.experiment/1",
//     "name": "steering in a museum",
//     "walk": {"horizon_m": 10, "stop": {"virtual_m": 200}},
//     "scenes": ["museum.obj", "plane",
//                {"name": "fine", "scene": "museum.obj", "build": {"cell_m": 0.05}}],
//     "rooms": [{"name": "4 m x 4 m", "rectangle": [4, 4]}, "laboratory.txt"],
//     "users": [{"name": "visitor", "kind": "wander", "pause_max_s": 5},
//               {"name": "three in a room", "kind": "wander", "count": 3}],
//     "controllers": ["none", "s2c", "s2c-predictive"],
//     "resets": ["two-one-turn", "r2g"],
//     "limits": ["steinicke", "toolkit"],
//     "variants": [{"name": "10 m"}, {"name": "20 m", "horizon_m": 20}],
//     "seeds": 50, "traces": "first"
//   }
//
// Every run is a `forewalk.simulation/1` (rdw/simulation_config.h): the keys of `walk`, then those
// of one entry of each list, a later one in place of an earlier one, then a seed. The runs are all
// the ways to take one entry of each list; lists that are left out change nothing. Seeds vary
// fastest, then variants, limits, resets, controllers, users, rooms and scenes.
// - scenes: a file, "plane" for an open plane, or an object of `name` and the keys scene, import,
// build, start.
// - rooms: a file with a tracked space, or an object of `name` and the keys of forewalk.space/1.
// - users: an object of `name` and the keys of `user`, with which several may walk at once: in one
//   room, or in rooms of their own and one virtual world. The toolkits' paths are kinds of user:
//   90-degree turns {"kind": "legs"}, random turns {"kind": "legs", "turn": "uniform", "turn_deg":
//   180}, straight {"kind": "legs", "turn_deg": 0}, sawtooth, circle, figure-eight, corridors.
// - controllers: as in a simulation, or an object of `name` and any keys of a simulation: a
//   controller with the reset that goes with it.
// - resets, limits: as in a simulation, or an object of `name` and the keys of `reset` or `limits`.
// - variants: an object of `name` and any keys of a simulation.
// - seeds: how many (1, 2, ...), or a list of them.
// - traces: "none", "first" (of the seeds) or "all": whose frames are written as CSV.
// - prediction_quality: "used" (where controller or reset look at predictions; the default), "all"
//   (wherever there is a scene) or "none": whether it is measured how well ways were foreseen.
// Files lie beside the plan unless their paths are absolute.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::service {

/// What runs differ in, slowest first.
enum class Axis : std::uint8_t { kScene, kRoom, kUser, kController, kReset, kLimits, kVariant };
inline constexpr std::size_t kAxes = 7;

/// "scene", "room", ...: columns of the results.
std::string_view nameOf(Axis axis);

/// One entry of a list: its name, and the keys of a simulation that it sets.
struct Choice {
  std::string name;
  nlohmann::json keys;
};

enum class Traces : std::uint8_t { kNone, kFirst, kAll };
enum class QualityOf : std::uint8_t { kUsed, kAll, kNone };

/// A plan that was read. Indices of runs go from 0 to runCount() - 1.
struct ExperimentPlan {
  std::string name;
  std::string text;  ///< the file as it was: what a manifest keeps
  nlohmann::json walk;
  std::array<std::vector<Choice>, kAxes> choices;  ///< at least one of each; by Axis
  std::vector<std::uint64_t> seeds;                ///< at least one
  Traces traces = Traces::kFirst;
  QualityOf quality = QualityOf::kUsed;

  std::size_t runCount() const;
  /// Which entry of each list run `run` takes.
  std::array<std::size_t, kAxes> choicesOf(std::size_t run) const;
  std::uint64_t seedOf(std::size_t run) const { return seeds[run % seeds.size()]; }
  bool isFirstSeed(std::size_t run) const { return run % seeds.size() == 0; }
  const Choice& choice(Axis axis, std::size_t i) const {
    return choices[static_cast<std::size_t>(axis)][i];
  }
  /// The `forewalk.simulation/1` of such entries, without a seed.
  nlohmann::json simulationOf(const std::array<std::size_t, kAxes>& chosen) const;
};

/// The most runs a plan may have; more is a slip of the pen.
inline constexpr std::size_t kMostRuns = 10'000'000;

/// Parses the bytes of such a file; `name` stands for it in messages.
///
/// Fails when it is not JSON (kDataDamaged, with the line), not this format (kFormatUnknown,
/// kFormatUnsupported), has a key that is not known here, a value of the wrong kind or two entries
/// of one name in a list (kDataDamaged), or more than kMostRuns runs (kTooLarge). What the
/// simulations themselves say is checked by checkExperiment. Costs O(size).
[[nodiscard]] tl::expected<ExperimentPlan, Error> parseExperiment(std::span<const std::byte> bytes,
                                                                  const std::string& name);

}  // namespace forewalk::service
