// The comparison of all steering in one page: ours against the best that reacts, and against what
// somebody would need who knew the walk.
//
// Reads experiments (forewalk experiment), each with its plan; shards of one may be given alone. A
// cell is a room under a
// preset of limits; the walks of all its scenes and users count alike. The best that reacts is the
// controller with a reset, neither of which looks at the prediction graph, of the least mean in
// that cell: it is chosen afterwards, so it is a little better than any that one could have chosen
// before. Differences are taken walk by walk. The ceiling (rdw/clairvoyant.h) walks the same
// virtual ways, found by a walk under the first controller of the plan.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rdw/clairvoyant.h"
#include "rdw/reset_policy.h"
#include "service/console.h"
#include "service/experiment/campaign.h"
#include "service/experiment/statistics.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/plot.h"
#include "service/timing.h"

namespace forewalk {
namespace {

using service::Axis;
using service::Estimate;
using service::Metric;
using service::Selection;

struct Options {
  std::vector<std::string> sets;  // PLAN=FOLDER[,FOLDER...]
  std::filesystem::path out;
  std::string ours = "foresight, ahead";
  std::size_t ceilingWalks = 25;  // of a cell
  int width = 200;
  unsigned threads = 0;
};

/// An experiment that has been walked.
struct Set {
  std::string name;
  std::string folder;
  service::Experiment experiment;
  service::Results results;
  std::size_t ours = 0;
  std::vector<std::size_t> reactive;  // controllers of the plan
};

/// What a walk would have needed.
struct CeilingWalk {
  std::size_t run = 0;             // of ours
  double ours = 0.0, least = 0.0;  // resets per 100 m
  std::string failure{};
};

struct Cell {
  std::size_t set, room, limits;
  std::size_t best = 0;
  Estimate reacts{}, ours{}, none{};
  service::Comparison comparison{};
  std::vector<CeilingWalk> ceiling{};
  double least = 0.0, ratio = 0.0;  // means of the walks that have a ceiling
};

Error refused(std::string message) { return {ErrorCode::kSettingOutOfRange, std::move(message)}; }

const std::vector<service::Choice>& listOf(const Set& set, Axis axis) {
  return set.results.plan.choices[static_cast<std::size_t>(axis)];
}

bool looksAhead(const nlohmann::json& keys) {
  const auto controller = rdw::makeController(keys.value("controller", ""));
  const auto reset = rdw::makeReset(keys.value("reset", "two-one-turn"));
  return !controller || !reset || (*controller)->wantsPrediction() || (*reset)->wantsPrediction();
}

tl::expected<Set, Error> open(const std::string& text, const std::string& ours) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    return tl::unexpected(refused(fmt::format("\"{}\" is no PLAN.json=RESULTS.", text)));
  }
  auto experiment = service::Experiment::load(text.substr(0, equals));
  if (!experiment) return tl::unexpected(experiment.error());
  const std::vector<std::string> folders = CLI::detail::split(text.substr(equals + 1), ',');
  const std::string& folder = folders.front();
  auto results = service::readResults(folder);
  if (!results) return tl::unexpected(results.error());
  // Shards that lie beside each other are one experiment; some may be missing.
  for (std::size_t f = 1; f < folders.size(); ++f) {
    const auto more = service::readResults(folders[f]);
    if (!more) return tl::unexpected(more.error());
    if (!(more->manifest == results->manifest)) {
      return tl::unexpected(
          refused(fmt::format("{} and {}: belong to different experiments.", folder, folders[f])));
    }
    results->rows.insert(results->rows.end(), more->rows.begin(), more->rows.end());
  }
  std::sort(results->rows.begin(), results->rows.end(),
            [](const service::Row& a, const service::Row& b) { return a.run < b.run; });
  Set set{results->plan.name, folder, std::move(*experiment), std::move(*results), 0, {}};
  const auto& controllers = listOf(set, Axis::kController);
  set.ours = controllers.size();
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    if (controllers[c].name == ours) set.ours = c;
    if (!looksAhead(controllers[c].keys)) set.reactive.push_back(c);
  }
  if (set.ours == controllers.size() || set.reactive.empty()) {
    return tl::unexpected(
        refused(fmt::format("{}: needs a controller \"{}\" and one that reacts.", folder, ours)));
  }
  return set;
}

Selection selectionOf(const Cell& cell) {
  return Selection{}.with(Axis::kRoom, cell.room).with(Axis::kLimits, cell.limits);
}

Estimate resetsOf(const Set& set, const Cell& cell, std::size_t controller) {
  return service::estimate(service::valuesOf(set.results,
                                             selectionOf(cell).with(Axis::kController, controller),
                                             Metric::kResetsPer100Metres));
}

Cell compared(const std::vector<Set>& sets, Cell cell, const Options& options) {
  const Set& set = sets[cell.set];
  for (const std::size_t c : set.reactive) {
    const Estimate resets = resetsOf(set, cell, c);
    if (cell.reacts.count == 0 || resets.mean < cell.reacts.mean) {
      cell.reacts = resets;
      cell.best = c;
    }
  }
  cell.none = resetsOf(set, cell, 0);
  cell.ours = resetsOf(set, cell, set.ours);
  cell.comparison = service::compareControllers(set.results, selectionOf(cell), cell.best, set.ours,
                                                Metric::kResetsPer100Metres);
  // Evenly among the walks, so that every scene and user has its share.
  std::vector<CeilingWalk> all;
  for (const service::Row& row : set.results.rows) {
    const auto chosen = set.results.plan.choicesOf(row.run);
    if (row.failed() || chosen[static_cast<std::size_t>(Axis::kController)] != set.ours ||
        chosen[static_cast<std::size_t>(Axis::kRoom)] != cell.room ||
        chosen[static_cast<std::size_t>(Axis::kLimits)] != cell.limits) {
      continue;
    }
    all.push_back({row.run, row[Metric::kResetsPer100Metres]});
  }
  const std::size_t wanted = std::min(options.ceilingWalks, all.size());
  for (std::size_t i = 0; i < wanted; ++i) {
    cell.ceiling.push_back(all[i * all.size() / wanted]);
  }
  return cell;
}

void findCeiling(const Set& set, const Options& options, CeilingWalk& walk) {
  constexpr double kApart = 0.25;  // metres between points of the way
  auto loaded = set.experiment.simulation(walk.run);
  if (!loaded) {
    walk.failure = loaded.error().message;
    return;
  }
  loaded->config.session.controller = "none";
  loaded->config.session.resetPolicy = "two-one-turn";
  loaded->config.session.alwaysPredict = false;
  loaded->config.keepFrames = true;
  const auto walked = service::simulate(*loaded);
  if (!walked) {
    walk.failure = walked.error().message;
    return;
  }
  std::vector<glm::dvec2> path;
  for (const rdw::FrameRecord& frame : walked->frames) {
    if (path.empty() || glm::distance(path.back(), frame.virtualPosition) > kApart) {
      path.push_back(frame.virtualPosition);
    }
  }
  rdw::ClairvoyantSettings settings;
  settings.width = options.width;
  const rdw::FrameRecord& first = walked->frames.front();
  const rdw::ClairvoyantWalk least =
      rdw::clairvoyant(path, first.virtualHeading, {first.physicalPosition, first.physicalHeading},
                       loaded->config.session.space, loaded->config.session.limits, settings);
  walk.least = 100.0 * static_cast<double>(least.resets.size()) / std::max(1.0, least.metres);
}

std::string ratioText(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f}", ratio) : "-";
}

double percent(const Cell& cell, double difference) {
  return 100.0 * difference / std::max(1e-9, cell.reacts.mean);
}

void print(const std::vector<Set>& sets, const std::vector<Cell>& cells) {
  fmt::print("{:<16} {:<10} {:<10} {:>5} {:>7} {:>7} {:<18} {:>7}  {:>22} {:>7} {:>6}\n", "walks",
             "limits", "room", "pairs", "none", "reacts", "which", "ours", "difference, 95 %",
             "ceiling", "ratio");
  for (const Cell& cell : cells) {
    const Set& set = sets[cell.set];
    const Estimate& d = cell.comparison.difference;
    fmt::print(
        "{:<16} {:<10} {:<10} {:>5} {:>7.2f} {:>7.2f} {:<18} {:>7.2f}  {:>+6.1f} % [{:>+5.1f}, "
        "{:>+5.1f}] {:>7.2f} {:>6}\n",
        set.name, listOf(set, Axis::kLimits)[cell.limits].name,
        listOf(set, Axis::kRoom)[cell.room].name, d.count, cell.none.mean, cell.reacts.mean,
        listOf(set, Axis::kController)[cell.best].name, cell.ours.mean, percent(cell, d.mean),
        percent(cell, d.low), percent(cell, d.high), cell.least, ratioText(cell.ratio));
  }
}

std::string csv(const std::vector<Set>& sets, const std::vector<Cell>& cells) {
  std::string text =
      "walks,limits,room,pairs,none,reacts,which,ours,difference_percent,low_percent,high_percent,"
      "ceiling_walks,ceiling,ratio\n";
  for (const Cell& cell : cells) {
    const Set& set = sets[cell.set];
    const Estimate& d = cell.comparison.difference;
    text += fmt::format(
        "{},{},{},{},{:.4f},{:.4f},\"{}\",{:.4f},{:.2f},{:.2f},{:.2f},{},{:.4f},{}\n", set.name,
        listOf(set, Axis::kLimits)[cell.limits].name, listOf(set, Axis::kRoom)[cell.room].name,
        d.count, cell.none.mean, cell.reacts.mean, listOf(set, Axis::kController)[cell.best].name,
        cell.ours.mean, percent(cell, d.mean), percent(cell, d.low), percent(cell, d.high),
        cell.ceiling.size(), cell.least, ratioText(cell.ratio));
  }
  return text;
}

std::string figureOf(const std::vector<Set>& sets, const std::vector<Cell>& cells, std::size_t set,
                     std::size_t limits) {
  service::BarPlot plot;
  plot.title = fmt::format("Resets per 100 m: {}", sets[set].name);
  plot.subtitle = fmt::format("limits {}", listOf(sets[set], Axis::kLimits)[limits].name);
  plot.yName = "resets per 100 m";
  plot.barNames = {"no steering", "the best that reacts", "foresight", "clairvoyant"};
  for (std::size_t i = 0; i < plot.barNames.size(); ++i) {
    plot.colours.emplace_back(service::seriesColour(i));
  }
  for (const Cell& cell : cells) {
    if (cell.set != set || cell.limits != limits) continue;
    // The ceiling of the walks that have one, brought to the mean of all.
    const double least = std::isfinite(cell.ratio) ? cell.ours.mean / cell.ratio : 0.0;
    plot.groups.push_back({listOf(sets[set], Axis::kRoom)[cell.room].name,
                           {cell.none.mean, cell.reacts.mean, cell.ours.mean, least}});
  }
  return toSvg(plot);
}

std::string pageOf(const std::vector<Set>& sets, const std::vector<Cell>& cells,
                   const std::vector<std::string>& figures, const Options& options) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Steering "
      "compared</title><style>body{margin:2rem auto;max-width:62rem;padding:0 1.5rem;"
      "font:16px/1.5 Georgia,serif}table{border-collapse:collapse;font:14px system-ui,sans-serif;"
      "font-variant-numeric:tabular-nums}th,td{padding:.25rem .8rem .25rem 0;text-align:right}"
      "td:nth-child(-n+3),th:nth-child(-n+3){text-align:left}thead th{border-bottom:1.5px "
      "solid}svg{max-width:100%;height:auto}</style></head><body>\n<h1>Steering compared</h1>\n"
      "<p>Resets per 100 m of virtual way. The best that reacts is chosen in each room, "
      "afterwards; differences are taken walk by walk, with their 95 % interval. The ceiling is "
      "the fewest that a beam search finds which knows the whole walk.</p>\n";
  std::size_t figure = 0;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const Set& set = sets[s];
    const std::filesystem::path report = std::filesystem::path(set.folder) / "report";
    page += fmt::format("<h2>{}</h2>\n", set.name);
    if (std::filesystem::exists(report / "index.html")) {
      page += fmt::format(
          "<p><a href=\"{}/index.html\">Every controller, with tests, heat maps "
          "and walks</a></p>\n",
          std::filesystem::proximate(report, options.out).string());
    }
    page +=
        "<table><thead><tr><th>limits</th><th>room</th><th>best that reacts</th><th>none</th>"
        "<th>reacts</th><th>foresight</th><th>difference</th><th>ceiling ratio</th></tr></thead>\n";
    for (const Cell& cell : cells) {
      if (cell.set != s) continue;
      const Estimate& d = cell.comparison.difference;
      page += fmt::format(
          "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>"
          "<td>{:+.1f} % [{:+.1f}, {:+.1f}]</td><td>{}</td></tr>\n",
          listOf(set, Axis::kLimits)[cell.limits].name, listOf(set, Axis::kRoom)[cell.room].name,
          listOf(set, Axis::kController)[cell.best].name, cell.none.mean, cell.reacts.mean,
          cell.ours.mean, percent(cell, d.mean), percent(cell, d.low), percent(cell, d.high),
          ratioText(cell.ratio));
    }
    page += "</table>\n";
    for (std::size_t l = 0; l < listOf(set, Axis::kLimits).size(); ++l) page += figures[figure++];
  }
  return page + "</body></html>\n";
}

tl::expected<void, Error> run(const Options& options) {
  std::vector<Set> sets;
  std::vector<Cell> cells;
  for (const std::string& text : options.sets) {
    auto set = open(text, options.ours);
    if (!set) return tl::unexpected(set.error());
    sets.push_back(std::move(*set));
    for (std::size_t l = 0; l < listOf(sets.back(), Axis::kLimits).size(); ++l) {
      for (std::size_t r = 0; r < listOf(sets.back(), Axis::kRoom).size(); ++r) {
        cells.push_back(compared(sets, Cell{sets.size() - 1, r, l}, options));
      }
    }
  }
  std::vector<std::pair<const Set*, CeilingWalk*>> walks;
  for (Cell& cell : cells) {
    for (CeilingWalk& walk : cell.ceiling) walks.emplace_back(&sets[cell.set], &walk);
  }
  {
    service::ProgressBar bar("the ceiling");
    std::mutex mutex;
    std::size_t done = 0;
    service::onThreads(options.threads)(walks.size(), [&](std::size_t i) {
      findCeiling(*walks[i].first, options, *walks[i].second);
      const std::lock_guard lock(mutex);
      bar.update(++done, walks.size());
    });
  }
  for (Cell& cell : cells) {
    double ours = 0.0;
    for (const CeilingWalk& walk : cell.ceiling) {
      if (!walk.failure.empty()) return tl::unexpected(refused(walk.failure));
      ours += walk.ours;
      cell.least += walk.least;
    }
    cell.ratio = ours / cell.least;
    cell.least /= static_cast<double>(std::max<std::size_t>(1, cell.ceiling.size()));
  }
  print(sets, cells);
  for (const Set& set : sets) {
    fmt::print("{}: {} of {} walks\n", set.name, set.results.rows.size(),
               set.results.manifest.runs);
  }
  if (options.out.empty()) return {};
  std::vector<std::string> figures;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (std::size_t l = 0; l < listOf(sets[s], Axis::kLimits).size(); ++l) {
      figures.push_back(figureOf(sets, cells, s, l));
      std::string file =
          fmt::format("{}_{}.svg", sets[s].name, listOf(sets[s], Axis::kLimits)[l].name);
      for (char& c : file) c = c == ' ' ? '_' : c;
      if (auto written = service::writeFile(options.out / file, figures.back()); !written) {
        return written;
      }
    }
  }
  return service::writeFile(options.out / "comparison.csv", csv(sets, cells)).and_then([&] {
    return service::writeFile(options.out / "index.html", pageOf(sets, cells, figures, options));
  });
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  forewalk::Options options;
  CLI::App program("Ours against the best that reacts and against the ceiling.",
                   "steering_comparison");
  program.add_option("SETS", options.sets, "PLAN.json=RESULTS[,SHARD...]")->required();
  program.add_option("--out", options.out, "Folder for the page, its table and its figures");
  program.add_option("--ours", options.ours, "The controller to compare")->capture_default_str();
  program.add_option("--ceiling-walks", options.ceilingWalks, "Of each cell; 0: no ceiling")
      ->capture_default_str();
  program.add_option("--width", options.width, "Of the ceiling's beam")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  program.add_option("--threads", options.threads, "0: all cores; results do not depend on it")
      ->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  if (const auto done = forewalk::run(options); !done) {
    forewalk::service::printError(done.error().message);
    return 1;
  }
  return 0;
}
