// Who walks beside the redirected user: the field `agents` of a forewalk.simulation/1 file.
//
//   "agents": {
//     "groups": [{"count": 12, "model": "orca", "start": "anywhere", "goal": "anywhere"},
//                {"start": {"points": [[12, 17.5]]}, "goal": "none"}],
//     "model": "social-forces", "models": {"orca": {"time_horizon_s": 3}},
//     "tick_s": 0.05, "projection": true, "seed": 1,
//     "user": {"radius_m": 0.25, "avoids": true, "model": "orca"},
//     "blocking": {"after_s": 1, "cost": "closed"}
//   }
//
// Everything but `groups` has a default. groups, model and models are those of forewalk.crowd/1
// (crowd_config.h).
// - tick_s: how often agents decide, a whole number of frames at least; in between they walk on.
// - seed: of their places and goals; without it, the walk's.
// - user: the body agents see, which they never expect to yield. avoids: whether a simulated user
//   makes way as `model` would, and walks around what is blocked; recorded users never do.
// - blocking: who has stood for after_s closes the ways that their body leaves no room in
//   (navmesh/standing.h), or prices them: "closed", "free" (nobody blocks anything) or metres that
//   a metre counts for. The user's prediction knows, and so do the agents' paths, where what is
//   closed costs 20: whoever has no other way squeezes through.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/polygon_states.h"
#include "service/crowd_config.h"

namespace forewalk::service {

struct CompanyConfig {
  CrowdConfig crowd;         ///< its `seconds` do not count
  float userRadius = 0.25f;  ///< metres
  bool userAvoids = true;
  std::string userModel = "orca";
  float blockAfter = 1.0f;  ///< seconds of standing
  bool blocks = true;
  float blockCost = navmesh::kClosed;  ///< of polygons: 1 to navmesh::kHighestCost, or kClosed
};

/// Parses the field's JSON; `name` stands for its file in messages, `scene` for what is walked in
/// (empty: an open plane), `seed` is the walk's. Fails as parseCrowd does. Costs O(size).
[[nodiscard]] tl::expected<CompanyConfig, Error> parseCompany(const std::string& json,
                                                              const std::string& name,
                                                              const std::string& scene,
                                                              std::uint64_t seed);

}  // namespace forewalk::service
