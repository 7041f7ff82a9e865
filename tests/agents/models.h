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
      {"orca", [] { return makeOrca(); }, 0x30471b6560cb7949ull},
      {"hrvo", [] { return makeHrvo(); }, 0xc47ceff7845f4e0dull},
      {"golaem", [] { return makeGolaem(); }, 0xf52f2bbd98a6f0a8ull, 300'000},
      {"social-forces", [] { return makeSocialForces(); }, 0xbc428dac5ff0376aull},
      {"caacd", [] { return makeCaacd(); }, 0x27607b39dfe9af5bull},
  };
}

}  // namespace forewalk::agents::testing
