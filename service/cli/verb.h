// A verb of the forewalk program: its options, and what it does once they are read.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::cli {

/// `options` belongs to the App it was added to. `run` is called at most once, after parsing.
/// Throws CLI::ValidationError for wrong usage that only shows then (exit status 2).
struct Verb {
  CLI::App* options;
  std::function<tl::expected<void, Error>()> run;
};

Verb addBuild(CLI::App& program);
Verb addPredict(CLI::App& program);
Verb addSweep(CLI::App& program);
Verb addSimulate(CLI::App& program);
Verb addDemo(CLI::App& program);

/// Reads "x,y,z" in metres. Throws CLI::ValidationError naming `option`.
glm::vec3 parsePosition(const std::string& option, const std::string& text);

/// Reads "from:to:step", or "a,b,c", of numbers > 0; at most 1000. Throws CLI::ValidationError.
std::vector<float> parseSteps(const std::string& option, const std::string& text);

}  // namespace forewalk::cli
