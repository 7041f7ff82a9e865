#include "service/experiment/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "prediction/svg.h"
#include "service/files.h"

namespace forewalk::service {
namespace {

using prediction::escapeXml;

constexpr std::string_view kStyle = R"(
  :root { color-scheme: light dark; --ink: #1d2733; --soft: #5a6675; --line: #d8dde2; --paper: #fdfcfa; --good: #16734f; --bad: #a8322f }
  @media (prefers-color-scheme: dark) { :root { --ink: #e6e9ed; --soft: #a3adb8; --line: #3a434d; --paper: #14181d; --good: #5fc79c; --bad: #f08a86 } }
  body { margin: 0 auto; padding: 2.5rem 1.5rem 5rem; max-width: 62rem; color: var(--ink); background: var(--paper);
    font: 16px/1.55 "Source Serif 4", Georgia, "Times New Roman", serif }
  h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .3rem } h2 { margin: 3rem 0 .6rem } h3 { margin: 2rem 0 .5rem }
  p.lead, figcaption, .note { color: var(--soft) }
  table { border-collapse: collapse; margin: .8rem 0; font: 14px/1.4 system-ui, sans-serif; font-variant-numeric: tabular-nums }
  caption { text-align: left; color: var(--soft); padding-bottom: .4rem }
  thead th { border-bottom: 1.5px solid var(--ink) } tbody tr:last-child > * { border-bottom: 1.5px solid var(--ink) }
  th, td { padding: .28rem .9rem .28rem 0; text-align: right; white-space: nowrap } th:first-child, td:first-child { text-align: left }
  td small { color: var(--soft) } .good { color: var(--good) } .bad { color: var(--bad) }
  .wide { overflow-x: auto } figure { margin: 1.2rem 0 } figure img { max-width: 100%; height: auto; border-radius: 4px }
  figcaption { font-size: .92rem } .walks { display: grid; grid-template-columns: repeat(auto-fill, minmax(19rem, 1fr)); gap: 1rem }
  .walks figure { margin: 0 } pre { font-size: 12.5px; overflow-x: auto; border: 1px solid var(--line); border-radius: 4px; padding: .8rem }
)";

/// A picture as a URL of its own, so that names inside of one drawing do not meet those of another.
std::string dataUrl(std::string_view svg) {
  std::string url = "data:image/svg+xml,";
  for (const char c : svg) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view(" -_.~:/=,;()!*'").find(c) != std::string_view::npos;
    if (plain && c != '\'') {
      url += c;
    } else {
      url += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return url;
}

void addFigure(std::string& page, const Figure& figure) {
  page += fmt::format(
      "<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0} <a href=\"figures/{2}.svg\">SVG</a>, "
      "<a href=\"figures/{2}.csv\">data</a></figcaption></figure>\n",
      escapeXml(figure.caption), dataUrl(figure.svg), figure.file);
}

const std::vector<Choice>& listOf(const Results& results, Axis axis) {
  return results.plan.choices[static_cast<std::size_t>(axis)];
}

std::string meanCell(const Estimate& e, int digits) {
  if (e.count == 0) return "<td>-</td>";
  if (e.count < 2) return fmt::format("<td>{:.{}f}</td>", e.mean, digits);
  return fmt::format("<td>{:.{}f} <small>[{:.{}f}, {:.{}f}]</small></td>", e.mean, digits, e.low,
                     digits, e.high, digits);
}

std::string pCell(double p) {
  return p < 0.001 ? "<td>&lt; 0.001</td>" : fmt::format("<td>{:.3f}</td>", p);
}

/// Rooms across, controllers down.
void addResetTable(std::string& page, const Results& results, const Block& block) {
  const auto& rooms = listOf(results, Axis::kRoom);
  const auto& controllers = listOf(results, Axis::kController);
  page +=
      "<div class=\"wide\"><table><caption>Resets per 100 m of virtual way: mean and 95 % "
      "interval</caption><thead><tr><th></th>";
  for (const Choice& room : rooms) page += fmt::format("<th>{}</th>", escapeXml(room.name));
  page += "</tr></thead><tbody>\n";
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    page += fmt::format("<tr><td>{}</td>", escapeXml(controllers[c].name));
    for (std::size_t r = 0; r < rooms.size(); ++r) {
      page += meanCell(estimate(valuesOf(
                           results, block.selection.with(Axis::kRoom, r).with(Axis::kController, c),
                           Metric::kResetsPer100Metres)),
                       2);
    }
    page += "</tr>\n";
  }
  page += "</tbody></table></div>\n";
}

/// Every controller against the baseline, room by room, with Holm's adjustment over the table.
void addTests(std::string& page, const Results& results, const Block& block, std::size_t baseline) {
  const auto& rooms = listOf(results, Axis::kRoom);
  const auto& controllers = listOf(results, Axis::kController);
  if (controllers.size() < 2) return;
  struct Line {
    std::size_t controller, room;
    Comparison comparison;
  };
  std::vector<Line> lines;
  std::vector<double> p;
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    if (c == baseline) continue;
    for (std::size_t r = 0; r < rooms.size(); ++r) {
      const Comparison comparison = compareControllers(
          results, block.selection.with(Axis::kRoom, r), baseline, c, Metric::kResetsPer100Metres);
      if (comparison.difference.count == 0) continue;  // no walk that both did
      lines.push_back({c, r, comparison});
      p.push_back(comparison.signedRank);
    }
  }
  const std::vector<double> adjusted = holm(p);
  page += fmt::format(
      "<div class=\"wide\"><table><caption>Against {}, on the same walks: difference in resets per "
      "100 m with its 95 % interval, Student's paired t-test, Wilcoxon's signed-rank test, and the "
      "latter "
      "adjusted for {} questions (Holm)</caption><thead><tr><th></th><th>room</th><th>pairs</th>"
      "<th>difference</th><th>relative</th><th>t-test, p</th><th>signed rank, "
      "p</th><th>adjusted</th></tr></thead><tbody>\n",
      escapeXml(controllers[baseline].name), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const Comparison& c = line.comparison;
    const bool sure = adjusted[i] < 0.05;
    page += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td>",
                        escapeXml(controllers[line.controller].name),
                        escapeXml(rooms[line.room].name), c.difference.count);
    page += meanCell(c.difference, 2);
    page += std::isfinite(c.relative) ? fmt::format("<td{}>{:+.0f} %</td>",
                                                    !sure              ? ""
                                                    : c.relative < 0.0 ? " class=\"good\""
                                                                       : " class=\"bad\"",
                                                    100.0 * c.relative)
                                      : "<td>-</td>";
    page += pCell(c.tTest) + pCell(c.signedRank) + pCell(adjusted[i]) + "</tr>\n";
  }
  page += "</tbody></table></div>\n";
}

/// All other metrics, means over all rooms.
void addMetrics(std::string& page, const Results& results, const Block& block) {
  constexpr Metric kShown[] = {Metric::kMetresBetweenResets,
                               Metric::kSecondsBetweenResets,
                               Metric::kVirtualMetres,
                               Metric::kPhysicalMetres,
                               Metric::kTranslation,
                               Metric::kRotation,
                               Metric::kRotationOffset,
                               Metric::kCurvature,
                               Metric::kOverThreshold,
                               Metric::kBorderMean,
                               Metric::kBorderLeast,
                               Metric::kFlipsPer100Metres,
                               Metric::kViolations,
                               Metric::kGraphNodes,
                               Metric::kWayInGraph,
                               Metric::kWayNll,
                               Metric::kWayFirst,
                               Metric::kWayRank};
  const auto& controllers = listOf(results, Axis::kController);
  page +=
      "<div class=\"wide\"><table><caption>Other measures: means over all "
      "rooms</caption><thead><tr><th></th>";
  for (const Choice& controller : controllers)
    page += fmt::format("<th>{}</th>", escapeXml(controller.name));
  page += "</tr></thead><tbody>\n";
  for (const Metric metric : kShown) {
    if (valuesOf(results, block.selection, metric).empty()) continue;  // nobody measured it
    page += fmt::format("<tr><td>{}</td>", escapeXml(infoOf(metric).words));
    for (std::size_t c = 0; c < controllers.size(); ++c) {
      const Estimate e =
          estimate(valuesOf(results, block.selection.with(Axis::kController, c), metric));
      page += e.count == 0 ? "<td>-</td>" : fmt::format("<td>{:.3g}</td>", e.mean);
    }
    page += "</tr>\n";
  }
  page += "</tbody></table></div>\n";
}

/// Whether all who walked together were treated alike.
void addUsers(std::string& page, const Results& results, const Block& block) {
  std::size_t users = 0;
  for (const Row& row : results.rows) {
    if (isIn(results.plan, row, block.selection)) users = std::max(users, row.users.size());
  }
  if (users < 2) return;
  const auto& controllers = listOf(results, Axis::kController);
  page +=
      "<div class=\"wide\"><table><caption>Each of the users who walked together: resets per 100 "
      "m, "
      "mean over all rooms and 95 % interval</caption><thead><tr><th></th>";
  for (std::size_t u = 1; u <= users; ++u) page += fmt::format("<th>user {}</th>", u);
  page += "</tr></thead><tbody>\n";
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    page += fmt::format("<tr><td>{}</td>", escapeXml(controllers[c].name));
    for (std::size_t u = 0; u < users; ++u) {
      std::vector<double> values;
      for (const Row& row : results.rows) {
        if (u < row.users.size() &&
            isIn(results.plan, row, block.selection.with(Axis::kController, c))) {
          values.push_back(row.users[u][Metric::kResetsPer100Metres]);
        }
      }
      page += meanCell(estimate(values), 2);
    }
    page += "</tr>\n";
  }
  page += "</tbody></table></div>\n";
}

void addTimes(std::string& page, const Results& results) {
  const auto& controllers = listOf(results, Axis::kController);
  const bool timed = std::any_of(results.rows.begin(), results.rows.end(), [](const Row& row) {
    return row.times[static_cast<std::size_t>(Timing::kFrameMedian)] > 0.0;
  });
  if (!timed) return;
  page +=
      "<h2>What a frame costs</h2><div class=\"wide\"><table><caption>Microseconds: the median of "
      "all walks' medians and 99th percentiles, the worst of all</caption>"
      "<thead><tr><th></th><th>graph, median</th><th>graph, 99 %</th><th>frame, "
      "median</th><th>frame, 99 %</th><th>worst frame</th></tr></thead><tbody>\n";
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    std::array<std::vector<double>, kTimings> times;
    for (const Row& row : results.rows) {
      if (row.failed() ||
          results.plan.choicesOf(row.run)[static_cast<std::size_t>(Axis::kController)] != c)
        continue;
      for (std::size_t i = 0; i < kTimings; ++i) times[i].push_back(row.times[i]);
    }
    const auto median = [&](Timing timing) {
      auto& values = times[static_cast<std::size_t>(timing)];
      return rdw::quantilesOf(values).median;
    };
    auto& worst = times[static_cast<std::size_t>(Timing::kFrameWorst)];
    page += fmt::format(
        "<tr><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.1f}</td><td>{:.0f}</"
        "td></tr>\n",
        escapeXml(controllers[c].name), median(Timing::kGraphMedian), median(Timing::kGraphP99),
        median(Timing::kFrameMedian), median(Timing::kFrameP99),
        worst.empty() ? 0.0 : *std::max_element(worst.begin(), worst.end()));
  }
  page += "</tbody></table></div>\n";
}

/// What did not go as it should, named.
void addTroubles(std::string& page, const Results& results) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> lines;
  std::size_t failed = 0, stuck = 0;
  for (const Row& row : results.rows) {
    const bool isStuck = row.end == rdw::nameOf(rdw::WalkEnd::kStuck);
    if (!row.failed() && !isStuck) continue;
    ++(row.failed() ? failed : stuck);
    if (lines.size() < kMost) {
      lines.push_back(
          fmt::format("run {}: {}", row.run,
                      row.failed() ? row.reason : "stuck: no virtual progress for 50 s"));
    }
  }
  const std::size_t missing = results.manifest.runs - results.rows.size();
  if (failed + stuck + missing == 0) return;
  page += fmt::format(
      "<h2>What did not go well</h2><p>{} runs failed, in {} the walker was stuck, {} are "
      "missing.</p><ul>\n",
      failed, stuck, missing);
  for (const std::string& line : lines) page += fmt::format("<li>{}</li>\n", escapeXml(line));
  if (failed + stuck > kMost) page += fmt::format("<li>and {} more</li>\n", failed + stuck - kMost);
  page += "</ul>\n";
}

}  // namespace

tl::expected<std::size_t, Error> writeReport(const Results& results,
                                             const std::filesystem::path& folder,
                                             const std::string& baseline,
                                             const std::filesystem::path& out) {
  const auto& controllers = listOf(results, Axis::kController);
  std::size_t first = 0;
  if (!baseline.empty()) {
    const auto found = std::find_if(controllers.begin(), controllers.end(),
                                    [&](const Choice& choice) { return choice.name == baseline; });
    if (found == controllers.end()) {
      std::vector<std::string> names;
      for (const Choice& choice : controllers) names.push_back(choice.name);
      return tl::unexpected(
          Error{ErrorCode::kSettingOutOfRange,
                fmt::format("baseline \"{}\" is no controller of this experiment; it has {}.",
                            baseline, fmt::join(names, ", "))});
    }
    first = static_cast<std::size_t>(found - controllers.begin());
  }
  if (std::all_of(results.rows.begin(), results.rows.end(),
                  [](const Row& row) { return row.failed(); })) {
    return tl::unexpected(Error{ErrorCode::kDataDamaged,
                                fmt::format("{}: holds no run that succeeded.", folder.string())});
  }
  double metres = 0.0;
  for (const Row& row : results.rows) metres += row[Metric::kVirtualMetres];
  const std::string title = results.plan.name.empty() ? "Experiment" : results.plan.name;
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">"
      "<title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n<p class=\"lead\">{2} "
      "walks of {3:.0f} m in all, forewalk {4}.</p>\n",
      escapeXml(title), kStyle, results.rows.size(), metres, escapeXml(results.manifest.version));

  std::size_t count = 0;
  const auto add = [&](std::string& text, const Figure& figure) -> tl::expected<void, Error> {
    ++count;
    addFigure(text, figure);
    return writeFile(out / "figures" / (figure.file + ".svg"), figure.svg).and_then([&] {
      return writeFile(out / "figures" / (figure.file + ".csv"), figure.csv);
    });
  };
  const std::vector<Block> blocks = blocksOf(results);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    page += fmt::format("<h2>{}</h2>\n", escapeXml(block.title.empty() ? "Results" : block.title));
    addResetTable(page, results, block);
    for (const Figure& figure : resetFigures(results, block, b + 1)) {
      if (auto written = add(page, figure); !written) return tl::unexpected(written.error());
    }
    addTests(page, results, block, first);
    addMetrics(page, results, block);
    addUsers(page, results, block);
    if (auto written = add(page, heatFigure(results, block, b + 1)); !written) {
      return tl::unexpected(written.error());
    }
    const std::vector<Figure> walks = walkFigures(results, folder, block, b + 1);
    if (walks.empty()) continue;
    page += "<div class=\"walks\">\n";
    for (const Figure& figure : walks) {
      if (auto written = add(page, figure); !written) return tl::unexpected(written.error());
    }
    page += "</div>\n";
  }
  addTimes(page, results);
  addTroubles(page, results);
  page +=
      "<h2>How to repeat it</h2>\n<p>Save the plan beside the files that it names, and run "
      "<code>forewalk experiment plan.json --out results</code>"
      " and <code>forewalk report results</code>. The same version gives the same bytes, on any "
      "number of threads or "
      "machines.</p>\n<table><thead><tr><th>file</th><th>hash</th></tr></thead><tbody>\n";
  for (const InputFile& input : results.manifest.inputs) {
    page +=
        fmt::format("<tr><td>{}</td><td>{:016x}</td></tr>\n", escapeXml(input.name), input.hash);
  }
  page += fmt::format("</tbody></table>\n<pre>{}</pre>\n</body></html>\n",
                      escapeXml(results.manifest.plan));
  if (auto written = writeFile(out / "index.html", page); !written)
    return tl::unexpected(written.error());
  return count;
}

}  // namespace forewalk::service
