// `forewalk.simulation/1`: a walking simulation as a JSON file.
//
//   {
//     "format": "forewalk.simulation/1",
//     "scene": "office.obj",
//     "import": {"metres_per_unit": 1, "up": "y"},
//     "build": {"radius_m": 0.25, "slope_deg": 45},
//     "space": {"rectangle": [6, 6]},
//     "limits": "steinicke",
//     "controller": "s2c-predictive",
//     "horizon_m": 10, "rate_hz": 90, "seed": 1, "predict_always": true,
//     "method": "polygon", "persistence_m": 0.75,
//     "resets": true,
//     "heading": "head",
//     "reset": {"policy": "two-one-turn", "trigger": "ahead", "reaction_s": 0.3,
//               "deceleration_m_per_s2": 3, "clearance_m": 0.2, "warning_s": 1},
//     "stop": {"virtual_m": 1000, "seconds": 3600},
//     "user": {"kind": "wander", "speed_m_per_s": 1, "turn_rate_deg_per_s": 90},
//     "start": {"position": [0, 0, 0], "heading_deg": 0},
//     "physical_start": {"position": [0, 0], "heading_deg": 0},
//     "agents": {...}
//   }
//
// Everything but `format` and `user.kind` has a default.
// - scene: a scene or .fwmesh; without one, an open plane.
// - build: radius_m, height_m, climb_m, slope_deg, cell_m, cell_height_m, region_min_m2,
//   region_merge_m2, edge_max_m, edge_error_m, detail_sample_m, detail_error_m, corners_max,
//   partition, tile_m (navmesh/build/settings.h).
// - space: as in forewalk.space/1, or the name of a file with a tracked space.
// - limits: the name of a preset, or an object with preset, translation_min, translation_max,
//   rotation_min, rotation_max, curvature_max_per_m, bending_min, bending_max.
// - method: how prediction graphs are made, polygon or front (prediction/prediction_graph.h);
//   persistence_m: graphs by fronts take shorter ways for a part of the one they leave.
// - heading: what controllers take for it: head, chest or walking (rdw/controller.h).
// - reset: the name of a reset (rdw/resets/README.md), or an object; trigger: ahead, or border, as
//   the published simulations do it (rdw/reset.h).
// - user, by kind:
//     waypoints  "waypoints": [[x, y, z], ...], or a file of OpenRDW's (rdw/openrdw_walk.h), whose
//                points lie as high as the start; "loop": false
//     wander     "goal_distance_min_m": 3
//     legs       "leg_min_m": 2, "leg_max_m": 8, "turn_deg": 90, "turn": "either_side" or "uniform"
//     sawtooth   "leg_m": 5, "turn_deg": 140
//     circle, figure-eight   "radius_m": 5
//     corridors  "leg_m": 5
//     recorded   "walks": "walks.csv", "walker": "u0" (without: the first); or, recorded by
//                OpenRDW, "walks": "user_virtual_positions.csv", "intervals":
//                "sampling_intervals.csv"
//   and of all: speed_m_per_s, turn_rate_deg_per_s, stop_angle_deg, reaction_s,
//   acceleration_m_per_s2, deceleration_m_per_s2, pause_min_s, pause_max_s, look_amplitude_deg,
//   look_period_s, bob_m, sway_m, eye_height_m, corner_margin_m (rdw/walker.h).
//   Several walk at once: "count": 3 of a kind, each with a seed of their own (recorded: the next
//   walkers of the file), or "together": [{a user}, ...] in place of a kind; and "share": "room"
//   (one room, virtual worlds of their own; the default) or "world" (one virtual world, in which
//   they make way for each other, rooms of their own: each of `together` may have a "space"). In a
//   room they begin as far apart as they can (placesInRoom), and in a world on a plane 3 m apart.
// - agents: who else is in the building; service/company_config.h describes it.
// Positions are world axes, metres; degrees only where a name says so.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/scene.h"
#include "navmesh/build/settings.h"
#include "navmesh/error.h"
#include "rdw/simulation.h"

namespace forewalk::rdw {

/// Who walks.
struct UserFile {
  User user;
  std::string walks;      ///< file whose walk goes into the Recorded plan; empty: none
  std::string walker;     ///< which walk of it; empty: the first
  std::string intervals;  ///< file with the times of `walks`, which is OpenRDW's then; empty: none
  std::string waypoints;  ///< file whose points go into the Waypoints plan; empty: none
  std::size_t count = 1;  ///< how many of them walk, [1, kMostOthers + 1]
  std::string space;      ///< tracked space file to read into `room`; empty: it is set
  TrackedSpace room;      ///< the simulation's, or their own
};

/// What the file says. The files it names are for the caller to read: nothing here touches the
/// disk.
struct SimulationFile {
  std::string scene;  ///< scene or .fwmesh; empty: an open plane
  navmesh::ImportSettings import;
  navmesh::BuildSettings build;
  std::string
      space;  ///< tracked space file to read into simulation.session.space; empty: it is set
  std::vector<UserFile> users;  ///< at least one; simulation.user is the first
  Sharing sharing = Sharing::kRoom;
  std::string agents;  ///< JSON of the field, for who knows what it means; empty: absent
  SimulationConfig simulation;
};

/// Parses the bytes of such a file; `name` stands for it in messages.
///
/// Fails when it is not JSON (kDataDamaged, with the line), not this format (kFormatUnknown,
/// kFormatUnsupported), has a key that is not known here (kDataDamaged, with the nearest known
/// one), a value of the wrong kind (kDataDamaged) or outside its range (kSettingOutOfRange). Costs
/// O(size).
[[nodiscard]] tl::expected<SimulationFile, Error> parseSimulation(std::span<const std::byte> bytes,
                                                                  const std::string& name);

}  // namespace forewalk::rdw
