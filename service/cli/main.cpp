// forewalk: one program with verbs. Exit status 0 done, 1 the input was refused, 2 wrong usage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "service/cli/verb.h"
#include "service/console.h"

namespace forewalk::cli {
namespace {

constexpr int kDone = 0, kRefused = 1, kWrongUsage = 2;

constexpr const char* kVerbs =
    "build, predict, sweep, simulate, fit, evaluate, animate, paths, trajectories, crowd, network, "
    "serve, replay, load, experiment, merge, report or demo";

// The verb that was given, or the program where none was.
const CLI::App& partOf(const CLI::App& program) {
  const auto verbs = program.get_subcommands();
  return verbs.empty() ? program : *verbs.front();
}

std::string nothingIsCalled(const CLI::App& program, const std::vector<std::string>& words) {
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    return word.size() > 1 && word[0] == '-';
  });
  if (option != words.end()) return fmt::format("there is no option {}", *option);
  if (words.empty()) return "something here was not understood";
  if (program.get_subcommands().empty()) {
    return fmt::format("there is no verb \"{}\"; give {}", words.front(), kVerbs);
  }
  return fmt::format("\"{}\" is one word too many", words.front());
}

// CLI11's own sentences are about its classes; these are about what was typed.
std::string inPlainWords(const CLI::App& program, const CLI::ParseError& error) {
  const std::string message = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    return nothingIsCalled(program, program.remaining(true));
  }
  const std::string convert = "Could not convert: ", is = " = ";
  if (const auto at = message.find(is); message.rfind(convert, 0) == 0 && at != message.npos) {
    const std::string option = message.substr(convert.size(), at - convert.size());
    const CLI::Option* known = partOf(program).get_option_no_throw(option);
    const bool whole = known != nullptr && known->get_type_name().rfind("UINT", 0) == 0;
    return fmt::format("{}: \"{}\" is no {}", option, message.substr(at + is.size()),
                       whole ? "whole number, 0 or more" : "number");
  }
  if (const auto at = message.find(": At Most 1 required but received "); at != message.npos) {
    return fmt::format("{} is given {} times; give it once", message.substr(0, at),
                       message.substr(message.rfind(' ') + 1));
  }
  if (const auto at = message.find(": 1 required "); at != message.npos) {
    return fmt::format("{} needs a value", message.substr(0, at));
  }
  return message;
}

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
      "Lengths are metres; positions are x,y,z in metres, y up (as the scene lies after --unit and "
      "--up).\n"
      "Exit status: 0 done, 1 the input was refused, 2 wrong usage, 130 stopped half-way "
      "(experiment).");
  const Verb verbs[] = {addBuild(program),    addPredict(program), addSweep(program),
                        addSimulate(program), addFit(program),     addEvaluate(program),
                        addAnimate(program),  addPaths(program),   addTrajectories(program),
                        addCrowd(program),    addNetwork(program), addServe(program),
                        addReplay(program),   addLoad(program),    addExperiment(program),
                        addMerge(program),    addReport(program),  addDemo(program)};
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
    return refuseUsage(program, fmt::format("a verb is missing: {}", kVerbs));
  } catch (const CLI::RuntimeError& stopped) {
    return stopped.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    return refuseUsage(program, inPlainWords(program, error));
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
