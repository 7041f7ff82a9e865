#include "service/crowd_models.h"

#include "agents/command_samples.h"
#include "agents/models/caacd.h"
#include "agents/models/golaem.h"
#include "agents/models/hrvo.h"
#include "agents/models/orca.h"
#include "agents/models/social_forces.h"
#include "service/clip_file.h"

namespace forewalk::service {
namespace {

using rdw::Fields;

template <typename Parameters>
void readNeighbours(Fields& fields, Parameters& p) {
  fields.number("neighbour_radius_m", 0.0, 1000.0, p.neighbourRadius);
  fields.integer("neighbour_count", 0, 1000, p.neighbourCount);
}

ModelMaker readOrca(Fields* fields) {
  agents::OrcaParameters p;
  if (fields != nullptr) {
    readNeighbours(*fields, p);
    fields->number("time_horizon_s", 0.01, 600.0, p.timeHorizon);
    fields->number("wall_horizon_s", 0.01, 600.0, p.wallHorizon);
  }
  return [p] { return agents::makeOrca(p); };
}

ModelMaker readHrvo(Fields* fields) {
  agents::HrvoParameters p;
  if (fields != nullptr) {
    readNeighbours(*fields, p);
    fields->number("time_horizon_s", 0.0, 600.0, p.timeHorizon);
    fields->number("wall_horizon_s", 0.01, 600.0, p.wallHorizon);
    fields->number("uncertainty_m_per_s", 0.0, 10.0, p.uncertainty);
    fields->number("collision_weight_m", 0.0, 1000.0, p.collisionWeight);
    fields->boolean("preferred_only", p.preferredOnly);
  }
  return [p] { return agents::makeHrvo(p); };
}

ModelMaker readSocialForces(Fields* fields) {
  agents::SocialForceParameters p;
  if (fields != nullptr) {
    readNeighbours(*fields, p);
    fields->number("relaxation_s", 0.01, 60.0, p.relaxation);
    fields->number("social_strength_m_per_s2", 0.0, 1e4, p.socialStrength);
    fields->number("social_range_m", 0.001, 100.0, p.socialRange);
    fields->number("wall_strength_m_per_s2", 0.0, 1e4, p.wallStrength);
    fields->number("wall_range_m", 0.001, 100.0, p.wallRange);
    fields->number("friend_attraction_m_per_s2", 0.0, 1e4, p.friendAttraction);
    fields->number("friend_attraction_range_m", 0.001, 100.0, p.friendAttractionRange);
    fields->number("contact_stiffness_per_s2", 0.0, 1e5, p.contactStiffness);
    fields->number("friction", 0.0, 100.0, p.friction);
    fields->number("bias_strength_m_per_s2", 0.0, 1e4, p.biasStrength);
    fields->number("bias_range_m", 0.001, 100.0, p.biasRange);
    fields->number("bias_s", 0.0, 60.0, p.biasSeconds);
    fields->boolean("literal", p.literal);
  }
  return [p] { return agents::makeSocialForces(p); };
}

ModelMaker readCaacd(Fields* fields) {
  agents::CaacdParameters p;
  if (fields != nullptr) {
    readNeighbours(*fields, p);
    fields->number("mass", 1e-3, 1e3, p.mass);
    fields->number("force", 1e-4, 1e6, p.force);
    fields->number("precaution", 1.0, 100.0, p.precaution);
    fields->number("alert", 1.0, 100.0, p.alert);
    fields->number("horizon_s", 0.01, 600.0, p.horizon);
    fields->number("slowest", 0.0, 1.0, p.slowest);
    fields->boolean("literal", p.literal);
  }
  return [p] { return agents::makeCaacd(p); };
}

ModelMaker readGolaem(Fields* fields) {
  agents::GolaemParameters p;
  if (fields != nullptr) {
    p.clips = readClips(*fields);
    fields->integer("neighbour_count", 0, 1000, p.neighbourCount);
    fields->integer("linear_samples", 1, agents::kMostSamples, p.linearSamples);
    fields->integer("angular_samples", 1, agents::kMostSamples, p.angularSamples);
    fields->number("spacing", 0.0, 20.0, p.spacing);
    fields->number("side_offset", -1.0, 1.0, p.sideOffset);
    fields->boolean("dual", p.dual);
    fields->number("boldness", 0.0, 1.0, p.boldness);
    fields->number("shortest_look_s", 0.1, 60.0, p.shortestLook);
    fields->number("longest_look_s", 0.1, 60.0, p.longestLook);
    fields->number("period_s", 0.0, 10.0, p.period);
    fields->boolean("literal", p.literal);
  }
  return [p] { return agents::makeGolaem(p); };
}

}  // namespace

std::span<const RegisteredModel> registeredModels() {
  static constexpr RegisteredModel kModels[] = {{"orca", readOrca},
                                                {"social-forces", readSocialForces},
                                                {"hrvo", readHrvo},
                                                {"golaem", readGolaem},
                                                {"caacd", readCaacd}};
  return kModels;
}

}  // namespace forewalk::service
