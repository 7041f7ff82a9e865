// A walk as a moving picture: the building from above, the walker, their trail, and in every step
// the ways ahead with their likelihoods as width.
//
// One self-contained SVG that plays by itself and over again (SMIL: every browser, also within an
// <img>); where nothing moves, it is a still from the middle.
#pragma once

#include <string>

#include "navmesh/world.h"
#include "prediction/likelihood.h"
#include "rdw/walk_file.h"
#include "service/recording.h"

namespace forewalk::service {

struct WalkAnimationSettings {
  double from = 0.0;      ///< seconds after the walk's beginning; evidence adds up from there on
  double seconds = 30.0;  ///< > 0; less where the walk ends before
  double step = 0.2;      ///< seconds between two pictures of the ways, > 0
  float horizon = 8.0f;   ///< metres, > 0
};

/// The drawing. `method` makes the ways. Frames off the navmesh (by more than 0.5 m) show no ways.
/// Costs a prediction for each 1/15 s of the walk up to its end, about 1.5 kB a step.
std::string animateWalk(const navmesh::World& world, const rdw::Walk& walk,
                        const MethodFactory& method,
                        const prediction::LikelihoodParameters& likelihood,
                        const WalkAnimationSettings& settings, const std::string& title,
                        const std::string& subtitle);

}  // namespace forewalk::service
