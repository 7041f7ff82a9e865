// forewalk sweep: the paper's figure, graph time against the horizon.
#include "service/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "service/cli/method_option.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/console.h"
#include "service/files.h"

namespace forewalk::cli {
namespace {

struct SweepOptions {
  SceneOptions scene;
  std::string horizons = "5:40:5";
  std::uint32_t starts = 25;
  std::uint32_t repeats = 9;
  std::uint64_t seed = 1;
  prediction::Method method = prediction::Method::kPolygon;
  std::filesystem::path out = "out/sweep";
};

tl::expected<void, Error> run(const SweepOptions& options) {
  service::SweepSettings settings;
  settings.horizons = parseSteps("--horizons", options.horizons);
  if (const float farthest = *std::max_element(settings.horizons.begin(), settings.horizons.end());
      farthest > 10000.0f) {
    throw CLI::ValidationError("--horizons",
                               fmt::format("{:g} m is out of range; give up to 10000 m", farthest));
  }
  settings.starts = options.starts;
  settings.repeats = options.repeats;
  settings.seed = options.seed;
  settings.method = options.method;
  const std::string csv = options.out.string() + ".csv";
  const std::string svg = options.out.string() + ".svg";
  for (const std::string& file : {csv, svg}) {
    if (auto writable = service::checkWritable(file); !writable) return writable;
  }
  auto world = loadWorld(options.scene);
  if (!world) return tl::unexpected(std::move(world.error()));
  std::vector<service::SweepRow> rows;
  {
    service::ProgressBar bar("timing graphs");
    rows = service::sweep((*world)->graph, settings,
                          [&](std::size_t done, std::size_t total) { bar.update(done, total); });
  }
  if (auto written = service::writeFile(csv, service::toCsv(rows)); !written) return written;
  if (auto written =
          service::writeFile(svg, service::toPlot(rows, options.scene.scene.stem().string()));
      !written) {
    return written;
  }
  fmt::print("Time per prediction graph, {} starts per horizon:\n", settings.starts);
  fmt::print("{:>9} {:>10} {:>10} {:>10} {:>9} {:>7}\n", "horizon m", "mean us", "median us",
             "99 % us", "polygons", "nodes");
  for (const service::SweepRow& row : rows) {
    fmt::print("{:>9g} {:>10.2f} {:>10.2f} {:>10.2f} {:>9.1f} {:>7.1f}\n", row.horizon, row.mean,
               row.median, row.p99, row.settled, row.nodes);
  }
  fmt::print(
      "The paper: 7500 us on average up to 20 m (Azmandian et al. 2016, Unity).\nWrote {} and {}\n",
      csv, svg);
  return {};
}

}  // namespace

Verb addSweep(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("sweep", "What a graph costs as the horizon grows: table and plot");
  const auto options = std::make_shared<SweepOptions>();
  addSceneOptions(*verb, options->scene);
  verb->add_option("--horizons", options->horizons, "from:to:step or a,b,c, metres")
      ->capture_default_str();
  verb->add_option("--starts", options->starts,
                   "Random starting points per horizon, spread by area")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  verb->add_option("--repeats", options->repeats,
                   "How often each start is timed; its median counts")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "Of the random starts")
      ->check(wholeNumber)
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  verb->add_option("--out", options->out, "Where to write: OUT.csv and OUT.svg")
      ->check([](const std::string& text) {
        const std::filesystem::path last = std::filesystem::path(text).filename();
        return last.empty() || last == "." || last == ".."
                   ? fmt::format("\"{}\" ends in no name; OUT.csv and OUT.svg are made of it", text)
                   : "";
      })
      ->capture_default_str();
  verb->footer(
      "Example:\n"
      "  forewalk sweep assets/scenes/museum.obj --horizons 5:40:5 --starts 25 --seed 1 --out "
      "out/sweep\n"
      "Columns of the CSV: horizon_m, starts, mean_us, median_us, p99_us and worst_us over the "
      "starts, the\n"
      "mean number of polygons settled, nodes, branch nodes and terminals, and a hash of all "
      "graphs, which\n"
      "is the same on every run.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
