// The tables that the rows of an experiment are written as.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/experiment/results.h"
#include "service/files.h"

namespace forewalk::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<MetricInfo, kMetrics> kInfos{{
    {"resets", "resets"},
    {"resets_per_100_m", "resets per 100 m"},
    {"m_between_resets", "virtual metres between resets"},
    {"s_between_resets", "seconds between resets"},
    {"reset_s", "seconds in resets"},
    {"virtual_m", "virtual metres"},
    {"physical_m", "physical metres"},
    {"seconds", "seconds"},
    {"translation", "translation gain, mean"},
    {"rotation", "rotation gain, mean"},
    {"rotation_offset", "|rotation gain - 1|, mean"},
    {"curvature_per_m", "|curvature gain|, mean, 1/m"},
    {"over_threshold", "share of the time over the threshold"},
    {"border_mean_m", "distance from the border, mean, m"},
    {"border_least_m", "distance from the border, least, m"},
    {"flips_per_100_m", "steering flips per 100 m"},
    {"violations", "times outside the room"},
    {"violation_depth_m", "farthest outside the room, m"},
    {"graph_nodes", "nodes of the prediction graph, mean"},
    {"room_m2", "room, m^2"},
    {"way_samples", "moments whose way is known"},
    {"way_in_graph", "share of ways taken that the graph had"},
    {"way_junctions", "moments with a choice of ways"},
    {"way_nll", "-log likelihood of the way taken, mean, nats"},
    {"way_first", "share of ways taken that were the likeliest"},
    {"way_rank", "rank of the way taken, mean"},
}};

constexpr std::array<std::string_view, kTimings> kTimingColumns{
    "graph_us_median", "graph_us_p99", "graph_us_worst",
    "frame_us_median", "frame_us_p99", "frame_us_worst"};

/// A text cell of a CSV: quoted where it has to be.
std::string cell(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') quoted += c;
  }
  return quoted + '"';
}

/// As short as can be read back to the same number; nothing where nothing was measured.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

/// The columns that say which run a row is of.
std::string runColumns() {
  std::string text = "run";
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    text += fmt::format(",{}", nameOf(static_cast<Axis>(axis)));
  }
  return text + ",seed";
}

std::string runCells(const ExperimentPlan& plan, const Row& row) {
  std::string text = fmt::format("{}", row.run);
  const auto chosen = plan.choicesOf(row.run);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    text += fmt::format(",{}", cell(plan.choices[axis][chosen[axis]].name));
  }
  return text + fmt::format(",{}", plan.seedOf(row.run));
}

std::string metricColumns() {
  std::string text;
  for (const MetricInfo& info : kInfos) text += fmt::format(",{}", info.column);
  return text + ",trace_hash\n";
}

void addMetrics(Json& entry, const std::array<double, kMetrics>& values, std::uint64_t traceHash) {
  for (std::size_t i = 0; i < kMetrics; ++i) {
    entry[std::string(kInfos[i].column)] = values[i];  // null where it was not measured
  }
  entry["trace_hash"] = fmt::format("{:016x}", traceHash);
}

}  // namespace

const MetricInfo& infoOf(Metric metric) { return kInfos[static_cast<std::size_t>(metric)]; }

std::string resultsCsv(const ExperimentPlan& plan, std::span<const Row> rows) {
  std::string text = runColumns() + ",end,reason" + metricColumns();
  for (const Row& row : rows) {
    text += fmt::format("{},{},{}", runCells(plan, row), row.end, cell(row.reason));
    for (const double value : row.values) {
      text += fmt::format(",{}", row.failed() ? std::string() : number(value));
    }
    text += fmt::format(",{}\n", row.failed() ? "" : fmt::format("{:016x}", row.traceHash));
  }
  return text;
}

std::string usersCsv(const ExperimentPlan& plan, std::span<const Row> rows) {
  std::string text = runColumns() + ",user_number,end" + metricColumns();
  for (const Row& row : rows) {
    if (row.users.size() < 2) continue;
    for (std::size_t i = 0; i < row.users.size(); ++i) {
      const UserRow& user = row.users[i];
      text += fmt::format("{},{},{}", runCells(plan, row), i + 1, user.end);
      for (const double value : user.values) text += fmt::format(",{}", number(value));
      text += fmt::format(",{:016x}\n", user.traceHash);
    }
  }
  return text;
}

std::string resultsJson(const ExperimentPlan& plan, std::span<const Row> rows) {
  Json json{{"format", "forewalk.result-rows/1"}, {"name", plan.name}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    Json entry{{"run", row.run}};
    const auto chosen = plan.choicesOf(row.run);
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      entry[std::string(nameOf(static_cast<Axis>(axis)))] = plan.choices[axis][chosen[axis]].name;
    }
    entry["seed"] = plan.seedOf(row.run);
    entry["end"] = row.end;
    if (row.failed()) {
      entry["reason"] = row.reason;
    } else {
      addMetrics(entry, row.values, row.traceHash);
    }
    if (row.users.size() > 1) {
      entry["users"] = Json::array();
      for (const UserRow& user : row.users) {
        Json one{{"end", user.end}};
        addMetrics(one, user.values, user.traceHash);
        entry["users"].push_back(std::move(one));
      }
    }
    json["rows"].push_back(std::move(entry));
  }
  return json.dump(1) + '\n';
}

std::string timingCsv(std::span<const Row> rows) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "run");
  for (const std::string_view column : kTimingColumns) fmt::format_to(out, ",{}", column);
  fmt::format_to(out, "\n");
  for (const Row& row : rows) {
    if (row.failed()) continue;
    fmt::format_to(out, "{}", row.run);
    for (const double value : row.times) fmt::format_to(out, ",{:.3f}", value);
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

std::string traceStem(const ExperimentPlan& plan, std::size_t run, std::size_t user) {
  const std::size_t digits = fmt::format("{}", plan.runCount() - 1).size();
  return fmt::format("{:0{}}{}", run, digits, user == 0 ? "" : fmt::format("-{}", user + 1));
}

tl::expected<void, Error> writeTables(const std::filesystem::path& folder,
                                      const ExperimentPlan& plan, std::span<const Row> rows) {
  return writeFile(folder / "results.csv", resultsCsv(plan, rows))
      .and_then([&] { return writeFile(folder / "results.json", resultsJson(plan, rows)); })
      .and_then([&] { return writeFile(folder / "openrdw.csv", openRdwSummary(plan, rows)); })
      .and_then([&]() -> tl::expected<void, Error> {
        const bool several = std::any_of(rows.begin(), rows.end(),
                                         [](const Row& row) { return row.users.size() > 1; });
        if (!several) return {};
        return writeFile(folder / "users.csv", usersCsv(plan, rows));
      })
      .and_then([&] { return writeFile(folder / "timing.csv", timingCsv(rows)); });
}

}  // namespace forewalk::service
