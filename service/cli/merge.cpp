// forewalk merge: the shards of an experiment to one folder of results.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "service/cli/verb.h"
#include "service/experiment/campaign.h"
#include "service/experiment/statistics.h"

namespace forewalk::cli {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out;
};

tl::expected<void, Error> run(const MergeOptions& options) {
  const auto merged = service::mergeShards(options.folders, options.out);
  if (!merged) return tl::unexpected(merged.error());
  fmt::print("{}: {} runs of {} shards.\n{}", options.out.string(), merged->rows.size(),
             options.folders.size(), service::resetTable(*merged));
  return {};
}

}  // namespace

Verb addMerge(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("merge", "Join the shards of an experiment");
  const auto options = std::make_shared<MergeOptions>();
  verb->add_option("FOLDER", options->folders,
                   "Results of forewalk experiment --shard i/n, all n of them")
      ->required();
  verb->add_option("--out", options->out, "Folder to write; the bytes are those of one process")
      ->required();
  verb->footer(
      "Example: forewalk merge results/1 results/2 results/3 --out results/all\n"
      "Runs that are missing or there twice are named, and nothing is written.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
