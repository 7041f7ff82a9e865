// A picture of what somebody in a crowd chooses from: all sampled trajectories, free ones from
// green to red by penalty, dismissed ones grey, the chosen one on top.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "agents/models/golaem.h"
#include "agents/scenes.h"
#include "navmesh/error.h"

namespace forewalk::service {

struct TrajectoryPictureSettings {
  std::uint32_t agent = 0;              ///< which of the scene's
  float seconds = 3.0f;                 ///< into the scene, >= 0
  agents::GolaemParameters parameters;  ///< of everybody's model
  std::string subtitle;                 ///< under the title
};

/// Runs the scene so far and draws the agent's choice as SVG, its surroundings as it sees them.
/// Fails (kSettingOutOfRange) where the scene has no such agent.
[[nodiscard]] tl::expected<std::string, Error> pictureTrajectories(
    const agents::CrowdScene& scene, const TrajectoryPictureSettings& settings);

/// The same of any situation. `radius` is the body's, metres.
std::string drawTrajectories(const agents::TrajectorySituation& situation, float radius,
                             const std::string& subtitle);

}  // namespace forewalk::service
