// Motion clips as JSON: what an engine's characters can do, for the model golaem.
//
//   {"format": "forewalk.clips/1",
//    "clips": [{"name": "stand", "speed_m_per_s": 0, "turn_deg_per_s": 0},
//              {"name": "walk", "speed_m_per_s": 1.3, "turn_deg_per_s": 0},
//              {"name": "walk left", "speed_m_per_s": 1.2, "turn_deg_per_s": 60},
//              {"name": "walk right", "speed_m_per_s": 1.2, "turn_deg_per_s": -60}]}
//
// speed_m_per_s, 0 to 20: how fast the clip walks as it was made. turn_deg_per_s, -1440 to 1440:
// how fast it turns, left positive; 0 where it is absent. name: the engine's, up to 200 bytes;
// blends name clips by their place in the list. 1 to 1000 clips, in any order. Motions between
// clips are blended, motions outside of what they span cannot be played: give turns to both sides,
// and a clip that stands.
//
// `forewalk trajectories --clips FILE` reads such a file; in a crowd the list stands in its place:
// "models": {"golaem": {"clips": [...]}}.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "agents/locomotion.h"
#include "navmesh/error.h"
#include "rdw/json_fields.h"

namespace forewalk::service {

/// Parses the text of such a file; `name` stands for it in messages. Fails when it is not JSON or
/// not this format, has a key that is not known, a value of the wrong kind or out of its range, no
/// clip or too many, or two with the same motion. Costs O(clips log clips).
[[nodiscard]] tl::expected<std::shared_ptr<const agents::LocomotionDatabase>, Error> parseClips(
    std::string_view text, const std::string& name);

/// The same of the list alone, which is the field `clips` of `fields`; null where that is absent or
/// was refused, which is told to the fields' problem.
std::shared_ptr<const agents::LocomotionDatabase> readClips(rdw::Fields& fields);

}  // namespace forewalk::service
