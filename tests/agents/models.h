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
  std::uint64_t golden = 0;  ///< hash of where a certain scene ends
  int fuzzedAgentSteps =
      2'500'000;  ///< ten million with the four of them; a slow model asks for fewer
};

/// A new model adds a line.
inline std::vector<NamedModel> allModels() {
  return {
      {"orca", [] { return makeOrca(); }, 0xda4a54efe8b26e0eull},
      {"hrvo", [] { return makeHrvo(); }, 0xa66883d6f265b052ull},
      {"golaem", [] { return makeGolaem(); }, 0x8e777f9439e54113ull, 300'000},
      {"social-forces", [] { return makeSocialForces(); }, 0x68d4415ff50fa672ull},
      {"caacd", [] { return makeCaacd(); }, 0xcee80e41af19d423ull},
  };
}

}  // namespace forewalk::agents::testing
