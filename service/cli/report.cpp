// forewalk report: the results of an experiment as one page, with its figures and their data.
#include "service/experiment/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "service/cli/verb.h"

namespace forewalk::cli {
namespace {

struct ReportOptions {
  std::filesystem::path results;
  std::filesystem::path out;
  std::string baseline;
};

tl::expected<void, Error> run(const ReportOptions& options) {
  const auto results = service::readResults(options.results);
  if (!results) return tl::unexpected(results.error());
  const auto out = options.out.empty() ? options.results / "report" : options.out;
  const auto written = service::writeReport(*results, options.results, options.baseline, out);
  if (!written) return tl::unexpected(written.error());
  fmt::print("{}\n{} figures, each as SVG with its data as CSV, lie beside it.\n",
             (out / "index.html").string(), *written);
  return {};
}

}  // namespace

Verb addReport(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("report", "A page of tables, tests and figures from an experiment");
  const auto options = std::make_shared<ReportOptions>();
  verb->add_option("RESULTS", options->results, "Folder of forewalk experiment or merge")
      ->required();
  verb->add_option("--out", options->out, "Folder to write; default: RESULTS/report");
  verb->add_option("--baseline", options->baseline,
                   "Controller that the others are tested against; default: the plan's first");
  verb->footer("Example: forewalk report results --baseline s2c");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
