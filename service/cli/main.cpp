// forewalk: one program with verbs. Exit status 0 done, 1 the input was refused, 2 wrong usage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <string>

#include "service/cli/verb.h"
#include "service/console.h"

namespace forewalk::cli {
namespace {

constexpr int kDone = 0, kRefused = 1, kWrongUsage = 2;

int refuseUsage(const CLI::App& program, const std::string& message) {
  std::string name = program.get_name();
  for (const CLI::App* verb : program.get_subcommands()) name += " " + verb->get_name();
  std::string sentence = message;
  while (!sentence.empty() && (sentence.back() == '.' || sentence.back() == '\n'))
    sentence.pop_back();
  service::printError(fmt::format("{}. See {} --help.", sentence, name));
  return kWrongUsage;
}

int run(int argc, char** argv) {
  CLI::App program(
      "Redirected walking that knows where the user can go next: builds navmeshes from scenes, "
      "predicts "
      "the ways ahead, steers simulated users.",
      "forewalk");
  program.set_version_flag("--version", "forewalk " FOREWALK_VERSION);
  program.require_subcommand(0, 1);
  program.footer(
      "Each verb explains itself: forewalk predict --help.\n"
      "Lengths are metres; positions are x,y,z in scene axes, y up.\n"
      "Exit status: 0 done, 1 the input was refused, 2 wrong usage.");
  const Verb verbs[] = {addBuild(program), addPredict(program), addSweep(program),
                        addSimulate(program), addDemo(program)};
  try {
    program.parse(argc, argv);
    for (const Verb& verb : verbs) {
      if (!verb.options->parsed()) continue;
      if (const auto result = verb.run(); !result) {
        service::printError(result.error().message);
        return kRefused;
      }
      return kDone;
    }
    return refuseUsage(program, "a verb is missing: build, predict, sweep, simulate or demo");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    return refuseUsage(program, error.what());
  }
}

}  // namespace
}  // namespace forewalk::cli

int main(int argc, char** argv) {
  try {
    return forewalk::cli::run(argc, argv);
  } catch (const std::bad_alloc&) {
    forewalk::service::printError(
        "memory is exhausted. Try a coarser --cell or smaller tiles (--tile 32).");
  } catch (const std::exception& error) {
    forewalk::service::printError(error.what());
  }
  return forewalk::cli::kRefused;
}
