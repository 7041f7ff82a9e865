// A verb of the forewalk program: its options, and what it does once they are read.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::cli {

/// `options` belongs to the App it was added to. `run` is called at most once, after parsing.
/// Throws CLI::ValidationError for wrong usage that only shows then (exit status 2), and
/// CLI::RuntimeError with the exit status where it was stopped half-way and has said so.
struct Verb {
  CLI::App* options;
  std::function<tl::expected<void, Error>()> run;
};

Verb addBuild(CLI::App& program);
Verb addPredict(CLI::App& program);
Verb addSweep(CLI::App& program);
Verb addSimulate(CLI::App& program);
Verb addDemo(CLI::App& program);
Verb addFit(CLI::App& program);
Verb addEvaluate(CLI::App& program);
Verb addAnimate(CLI::App& program);
Verb addPaths(CLI::App& program);
Verb addTrajectories(CLI::App& program);
Verb addCrowd(CLI::App& program);
Verb addServe(CLI::App& program);
Verb addReplay(CLI::App& program);
Verb addLoad(CLI::App& program);
Verb addNetwork(CLI::App& program);
Verb addExperiment(CLI::App& program);
Verb addMerge(CLI::App& program);
Verb addReport(CLI::App& program);

/// For Option::check: why `text` is no whole number from 0 on, or "". (CLI11 lets -1 pass as the
/// largest 64-bit number.)
std::string wholeNumber(const std::string& text);

/// For Option::check: why nothing can be written to `text`, or "".
std::string fileName(const std::string& text);

/// Throws CLI::ValidationError where two outputs of a verb both go to stdout.
void refuseBothToStdout(const std::string& option, const std::filesystem::path& one,
                        const std::string& other, const std::filesystem::path& two);

/// Reads "x,y,z" in metres. Throws CLI::ValidationError naming `option`.
glm::vec3 parsePosition(const std::string& option, const std::string& text);

/// Reads "from:to:step", or "a,b,c", of numbers > 0; at most 1000. Throws CLI::ValidationError.
std::vector<float> parseSteps(const std::string& option, const std::string& text);

}  // namespace forewalk::cli
