// forewalk experiment: all walks of a plan, on all cores, into a folder that can be gone on with.
#include "service/experiment/campaign.h"

#include <fmt/format.h>

#include <atomic>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "service/cli/verb.h"
#include "service/console.h"
#include "service/experiment/statistics.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/timing.h"

namespace forewalk::cli {
namespace {

using service::CampaignEnd;
using service::Experiment;

constexpr int kStopped = 130;  // exit status, as a shell gives it for Ctrl-C

struct ExperimentOptions {
  std::filesystem::path plan;
  std::filesystem::path out;
  std::string shard = "1/1";
  unsigned threads = 0;
  bool untimed = false;
  bool check = false;
};

// A signal handler can reach nothing else.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

/// Ctrl-C and SIGTERM end a campaign softly while this lives; a second one ends the program.
class SoftInterrupt {
 public:
  SoftInterrupt() {
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, remember);
  }
  ~SoftInterrupt() {
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  }
  SoftInterrupt(const SoftInterrupt&) = delete;
  SoftInterrupt& operator=(const SoftInterrupt&) = delete;

 private:
  static void remember(int signal) {
    interrupted = true;
    std::signal(signal, SIG_DFL);
  }
};

std::string timeLeft(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s left", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min left", seconds / 60.0);
  return fmt::format("{:.1f} h left", seconds / 3600.0);
}

struct Shard {
  std::size_t i = 1, n = 1;
};

/// "i/n" with 1 <= i <= n.
std::optional<Shard> shardOf(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto i = std::from_chars(text.data(), end, shard.i);
  if (i.ec != std::errc() || i.ptr == end || *i.ptr != '/') return std::nullopt;
  const auto n = std::from_chars(i.ptr + 1, end, shard.n);
  if (n.ec != std::errc() || n.ptr != end) return std::nullopt;
  if (shard.i < 1 || shard.i > shard.n) return std::nullopt;
  return shard;
}

/// For Option::check.
std::string checkShard(const std::string& text) {
  return shardOf(text) ? "" : fmt::format("\"{}\" is no share; give i/n, such as 3/8", text);
}

tl::expected<void, Error> run(const ExperimentOptions& options) {
  if (!options.check) {
    // Scenes take their time.
    if (auto sound = service::checkWritable(options.out / "rows.jsonl"); !sound) return sound;
  }
  std::optional<service::ProgressBar> bar("reading the scenes");
  navmesh::BuildRun build;
  build.forEach = service::onThreads(options.threads);
  build.progress = [&](std::size_t done, std::size_t total) { bar->update(done, total); };
  const auto experiment = Experiment::load(options.plan, build);
  bar.reset();
  if (!experiment) return tl::unexpected(experiment.error());
  const service::ExperimentPlan& plan = experiment->plan();
  if (options.check) {
    fmt::print("{}: sound, {} runs.\n", options.plan.string(), plan.runCount());
    return {};
  }

  service::CampaignSettings settings;
  settings.out = options.out;
  settings.version = FOREWALK_VERSION;
  settings.threads = options.threads;
  const Shard shard = *shardOf(options.shard);
  settings.shard = shard.i;
  settings.shards = shard.n;
  const service::Stopwatch watch;
  if (!options.untimed) settings.microseconds = [&] { return watch.microseconds(); };
  const SoftInterrupt soft;
  settings.interrupted = [] { return interrupted.load(); };
  bar.emplace("walking");
  std::size_t first = 0;
  settings.progress = [&](std::size_t done, std::size_t total) {
    if (first == 0) first = done;
    const double each = watch.microseconds() * 1e-6 / static_cast<double>(done - first + 1);
    bar->update(done, total, timeLeft(each * static_cast<double>(total - done)));
  };
  const tl::expected<CampaignEnd, Error> end = experiment->carryOut(settings);
  bar.reset();
  if (!end) return tl::unexpected(end.error());

  std::string words =
      fmt::format("{}: {} of {} runs done", options.out.string(), end->done, end->total);
  if (end->before > 0) words += fmt::format(", {} of them before", end->before);
  if (end->failed > 0)
    words += fmt::format("; {} failed, see their reasons in the rows", end->failed);
  if (end->stuck > 0) words += fmt::format("; {} ended because the walker was stuck", end->stuck);
  fmt::print("{}.\n", words);
  if (!end->finished()) {
    fmt::print("Stopped. The same command goes on from here.\n");
    throw CLI::RuntimeError(kStopped);
  } else if (settings.shards > 1) {
    fmt::print("Shard {} of {}. When all are done: forewalk merge FOLDER... --out FOLDER\n",
               settings.shard, settings.shards);
  } else {
    const auto results = service::readResults(options.out);
    if (!results) return tl::unexpected(results.error());
    fmt::print("{}", service::resetTable(*results));
    fmt::print("Figures and tests: forewalk report {}\n", options.out.string());
  }
  return {};
}

}  // namespace

Verb addExperiment(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "experiment", "Walk every combination of scenes, rooms, users, controllers and seeds");
  const auto options = std::make_shared<ExperimentOptions>();
  verb->add_option("PLAN", options->plan, "forewalk.experiment/1: what is to be compared")
      ->required();
  auto* out =
      verb->add_option("--out", options->out,
                       "Folder for the results; one with results of this plan is gone on with");
  verb->add_option("--shard", options->shard,
                   "Only part i of n: i/n, for n processes on any machines")
      ->check(checkShard)
      ->capture_default_str();
  verb->add_option("--threads", options->threads,
                   "How many to use, 0: all cores; the results do not depend on it")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_flag("--untimed", options->untimed, "Do not measure frames");
  auto* check = verb->add_flag("--check", options->check,
                               "Only say whether the plan is sound, and how many runs it has");
  out->excludes(check);
  verb->footer(
      "Example: two controllers in two rooms, ten walks each\n"
      "  {\"format\": \"forewalk.experiment/1\", \"name\": \"rooms\",\n"
      "   \"walk\": {\"limits\": \"laboratory\", \"stop\": {\"virtual_m\": 200}},\n"
      "   \"scenes\": [\"office.obj\"], \"users\": [{\"name\": \"visitor\", \"kind\": "
      "\"wander\"}],\n"
      "   \"rooms\": [{\"name\": \"4 m\", \"rectangle\": [4, 4]}, {\"name\": \"6 m\", "
      "\"rectangle\": [6, 6]}],\n"
      "   \"controllers\": [\"s2c\", \"s2c-predictive\"], \"seeds\": 10}\n"
      "  forewalk experiment plan.json --out results && forewalk report results\n"
      "Ctrl-C keeps what is done (exit status 130); the same command goes on from there. On a\n"
      "cluster: service/experiment/slurm/forewalk-array.sh. Every key is described in\n"
      "service/experiment/plan.h.");
  return {verb, [options] {
            if (!options->check && options->out.empty()) {
              throw CLI::ValidationError("--out", "is required: a folder for the results");
            }
            return run(*options);
          }};
}

}  // namespace forewalk::cli
