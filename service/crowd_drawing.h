// A walked crowd in pictures: the plan with everybody's way, and the same as a moving picture.
#pragma once

#include <span>
#include <string>

#include "agents/walls.h"
#include "navmesh/nav_graph.h"
#include "service/crowd_run.h"

namespace forewalk::service {

/// SVG of the ground with every agent's way, its start and where it ended, coloured by group.
/// `graph`: the navmesh, or null.
std::string crowdPlan(const CrowdResult& result, const CrowdConfig& config,
                      const navmesh::NavGraph* graph, const std::string& title,
                      const std::string& subtitle);

struct CrowdAnimationSettings {
  double from = 0.0;      ///< seconds after the start
  double seconds = 60.0;  ///< > 0; less where the walk ends before
  double step = 0.25;     ///< seconds between two places, even motion in between, >= the tick
};

/// SVG that plays by itself and over again (walk_animation.h): bodies in their size, humans with a
/// ring. A still from the middle where nothing moves. About 12 bytes an agent and step.
std::string animateCrowd(const CrowdResult& result, const CrowdConfig& config,
                         const navmesh::NavGraph* graph, const CrowdAnimationSettings& settings,
                         const std::string& title, const std::string& subtitle);

}  // namespace forewalk::service
