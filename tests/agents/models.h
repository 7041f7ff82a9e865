// Every avoidance model there is, for the tests that all of them have to pass.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agents/models/caacd.h"
#include "agents/models/golaem.h"
#include "agents/models/hrvo.h"
#include "agents/models/orca.h"
#include "agents/models/social_forces.h"

namespace forewalk::agents::testing {

struct NamedModel {
  std::string name;
  std::function<std::unique_ptr<const Model>()> make;
  int fuzzedAgentSteps =
      2'500'000;  ///< ten million with the four of them; a slow model asks for fewer
};

/// A new model adds a line.
inline std::vector<NamedModel> allModels() {
  return {
      {"orca", [] { return makeOrca(); }},
      {"hrvo", [] { return makeHrvo(); }},
      {"golaem", [] { return makeGolaem(); }, 300'000},
      {"social-forces", [] { return makeSocialForces(); }},
      {"caacd", [] { return makeCaacd(); }},
  };
}

}  // namespace forewalk::agents::testing
