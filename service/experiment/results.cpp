#include "service/experiment/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "rdw/gains.h"
#include "rdw/json_text.h"
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
    {"over_threshold", "share of metres over the threshold"},
    {"border_mean_m", "distance from the border, mean, m"},
    {"border_least_m", "distance from the border, least, m"},
    {"flips_per_100_m", "steering flips per 100 m"},
    {"violations", "times outside the room"},
    {"violation_depth_m", "farthest outside the room, m"},
    {"graph_nodes", "nodes of the prediction graph, mean"},
    {"room_m2", "room, m^2"},
}};

constexpr std::array<std::string_view, kTimings> kTimingColumns{
    "graph_us_median", "graph_us_p99", "graph_us_worst",
    "frame_us_median", "frame_us_p99", "frame_us_worst"};

constexpr std::string_view kManifestFormat = "forewalk.results/1";

/// Shares of walked metres over what people notice, distances from the border, flips, places.
void addFrames(std::span<const rdw::FrameRecord> frames, const rdw::TrackedSpace& space, Row& row) {
  static const rdw::GainLimits threshold = *rdw::gainLimitsByName("steinicke");
  constexpr float kRounding = 1e-4f;
  const glm::dvec2 low = space.lowerBound();
  const glm::dvec2 size = space.upperBound() - low;
  double metres = 0.0, over = 0.0, border = 0.0;
  double least = std::numeric_limits<double>::infinity();
  std::size_t flips = 0;
  float side = 0.0f;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const rdw::FrameRecord& frame = frames[i];
    border += frame.borderDistance;
    least = std::min(least, frame.borderDistance);
    const glm::dvec2 cell = (frame.physicalPosition - low) / size * static_cast<double>(kHeatSide);
    const auto column = static_cast<std::size_t>(std::clamp(cell.x, 0.0, kHeatSide - 1.0));
    const auto line = static_cast<std::size_t>(std::clamp(cell.y, 0.0, kHeatSide - 1.0));
    ++row.heat[line * kHeatSide + column];
    if (frame.reset || i == 0) continue;
    const double step = glm::distance(frame.physicalPosition, frames[i - 1].physicalPosition);
    const rdw::Gains& gains = frame.gains;
    const bool noticed = gains.translation < threshold.translationMin - kRounding ||
                         gains.translation > threshold.translationMax + kRounding ||
                         gains.rotation < threshold.rotationMin - kRounding ||
                         gains.rotation > threshold.rotationMax + kRounding ||
                         std::abs(gains.curvature) > threshold.curvatureMax + kRounding;
    metres += step;
    if (noticed) over += step;
    if (gains.curvature != 0.0f) {
      if (side * gains.curvature < 0.0f) ++flips;
      side = gains.curvature;
    }
  }
  const auto set = [&](Metric metric, double value) {
    row.values[static_cast<std::size_t>(metric)] = value;
  };
  const double count = std::max<double>(1.0, static_cast<double>(frames.size()));
  set(Metric::kOverThreshold, metres > 0.0 ? over / metres : 0.0);
  set(Metric::kBorderMean, border / count);
  set(Metric::kBorderLeast, frames.empty() ? 0.0 : least);
  set(Metric::kFlipsPer100Metres, metres > 0.0 ? 100.0 * static_cast<double>(flips) / metres : 0.0);
}

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

/// As short as can be read back to the same number.
std::string number(double value) { return fmt::format("{}", value); }

}  // namespace

const MetricInfo& infoOf(Metric metric) { return kInfos[static_cast<std::size_t>(metric)]; }

bool Row::sameAs(const Row& other) const {
  return run == other.run && end == other.end && reason == other.reason &&
         traceHash == other.traceHash && values == other.values && heat == other.heat;
}

Row rowOf(std::size_t run, const rdw::SimulationResult& result, const rdw::TrackedSpace& space) {
  const rdw::Summary& s = result.summary;
  Row row;
  row.run = run;
  row.end = rdw::nameOf(s.end);
  row.traceHash = s.traceHash;
  const auto set = [&](Metric metric, double value) {
    row.values[static_cast<std::size_t>(metric)] = value;
  };
  const auto resets = static_cast<double>(s.resets);
  set(Metric::kResets, resets);
  set(Metric::kResetsPer100Metres, s.resetsPer100Metres());
  set(Metric::kMetresBetweenResets, s.metresBetweenResets());
  set(Metric::kSecondsBetweenResets,
      s.resets > 0 ? (s.seconds - s.resetSeconds) / resets : s.seconds);
  set(Metric::kResetSeconds, s.resetSeconds);
  set(Metric::kVirtualMetres, s.virtualMetres);
  set(Metric::kPhysicalMetres, s.physicalMetres);
  set(Metric::kSeconds, s.seconds);
  set(Metric::kTranslation, s.meanTranslation);
  set(Metric::kRotation, s.meanRotation);
  set(Metric::kRotationOffset, s.meanRotationOffset);
  set(Metric::kCurvature, s.meanCurvature);
  set(Metric::kViolations, static_cast<double>(s.violations));
  set(Metric::kViolationDepth, s.violationDepth);
  set(Metric::kGraphNodes, s.meanGraphNodes);
  set(Metric::kRoomArea, s.spaceArea);
  if (s.timed) {
    row.times = {s.graphMicroseconds.median, s.graphMicroseconds.p99, s.graphMicroseconds.worst,
                 s.frameMicroseconds.median, s.frameMicroseconds.p99, s.frameMicroseconds.worst};
  }
  addFrames(result.frames, space, row);
  return row;
}

std::string lineOf(const Row& row) {
  Json json{{"run", row.run}, {"end", row.end}};
  if (row.failed()) {
    json["reason"] = row.reason;
  } else {
    json["hash"] = fmt::format("{:016x}", row.traceHash);
    json["values"] = row.values;
    json["times"] = row.times;
    json["heat"] = row.heat;
  }
  return json.dump() + '\n';
}

tl::expected<Row, Error> parseRow(std::string_view line, const std::string& where) {
  const auto refuse = [&] {
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged, where + ": is no row of an experiment; remove the line."});
  };
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) return refuse();
  try {
    Row row;
    row.run = json.at("run").get<std::size_t>();
    row.end = json.at("end").get<std::string>();
    if (row.failed()) {
      row.reason = json.at("reason").get<std::string>();
      return row;
    }
    const auto& hash = json.at("hash").get_ref<const std::string&>();
    const auto read = std::from_chars(hash.data(), hash.data() + hash.size(), row.traceHash, 16);
    if (read.ec != std::errc() || read.ptr != hash.data() + hash.size()) return refuse();
    row.values = json.at("values").get<decltype(row.values)>();
    row.times = json.at("times").get<decltype(row.times)>();
    row.heat = json.at("heat").get<decltype(row.heat)>();
    return row;
  } catch (const nlohmann::json::exception&) {
    return refuse();
  }
}

bool Manifest::operator==(const Manifest& other) const {
  const auto same = [](const InputFile& a, const InputFile& b) {
    return a.name == b.name && a.hash == b.hash;
  };
  return version == other.version && plan == other.plan && runs == other.runs &&
         std::equal(inputs.begin(), inputs.end(), other.inputs.begin(), other.inputs.end(), same);
}

std::string manifestJson(const Manifest& manifest) {
  Json json{{"format", kManifestFormat}, {"version", manifest.version}, {"runs", manifest.runs}};
  json["shard"] = {manifest.shard, manifest.shards};
  json["inputs"] = Json::array();
  for (const InputFile& input : manifest.inputs) {
    json["inputs"].push_back({{"file", input.name}, {"hash", fmt::format("{:016x}", input.hash)}});
  }
  json["plan"] = manifest.plan;
  return json.dump(2) + '\n';
}

tl::expected<Manifest, Error> parseManifest(std::string_view text, const std::string& name) {
  const auto json = rdw::parseJson(text, name);
  if (!json) return tl::unexpected(json.error());
  try {
    if (json->at("format") != kManifestFormat) {
      return tl::unexpected(Error{ErrorCode::kFormatUnsupported,
                                  fmt::format("{}: its format is {}, this program reads {}.", name,
                                              json->at("format").dump(), kManifestFormat)});
    }
    Manifest manifest;
    manifest.version = json->at("version").get<std::string>();
    manifest.plan = json->at("plan").get<std::string>();
    manifest.runs = json->at("runs").get<std::size_t>();
    manifest.shard = json->at("shard").at(0).get<std::size_t>();
    manifest.shards = json->at("shard").at(1).get<std::size_t>();
    for (const auto& input : json->at("inputs")) {
      const auto& hash = input.at("hash").get_ref<const std::string&>();
      manifest.inputs.push_back(
          {input.at("file").get<std::string>(), std::strtoull(hash.c_str(), nullptr, 16)});
    }
    return manifest;
  } catch (const nlohmann::json::exception&) {
    return tl::unexpected(Error{ErrorCode::kDataDamaged,
                                name + ": is no manifest of an experiment, or a part is missing."});
  }
}

tl::expected<Manifest, Error> readManifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return parseManifest({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                       file.string());
}

tl::expected<RowLog, Error> readRows(const std::filesystem::path& folder) {
  RowLog log;
  const std::filesystem::path file = folder / "rows.jsonl";
  if (!std::filesystem::exists(file)) return log;
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  std::string_view rest(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  std::map<std::size_t, Row> rows;
  std::size_t lines = 0;
  for (std::size_t end = rest.find('\n'); end != rest.npos; end = rest.find('\n')) {
    auto row = parseRow(rest.substr(0, end), fmt::format("{}:{}", file.string(), ++lines));
    if (!row) return tl::unexpected(row.error());
    const auto [known, isNew] = rows.emplace(row->run, *row);
    if (!isNew && !known->second.sameAs(*row)) {
      return tl::unexpected(
          Error{ErrorCode::kDataDamaged,
                fmt::format("{}:{}: run {} is there twice, with different results.", file.string(),
                            lines, row->run)});
    }
    rest.remove_prefix(end + 1);
    log.soundBytes += end + 1;
  }
  for (auto& [run, row] : rows) log.rows.push_back(std::move(row));
  return log;
}

tl::expected<Results, Error> readResults(const std::filesystem::path& folder) {
  auto manifest = readManifest(folder);
  if (!manifest) return tl::unexpected(manifest.error());
  auto plan = parseExperiment(
      {reinterpret_cast<const std::byte*>(manifest->plan.data()), manifest->plan.size()},
      (folder / "manifest.json").string() + ": plan");
  if (!plan) return tl::unexpected(plan.error());
  auto log = readRows(folder);
  if (!log) return tl::unexpected(log.error());
  return Results{std::move(*manifest), std::move(*plan), std::move(log->rows)};
}

std::string resultsCsv(const ExperimentPlan& plan, std::span<const Row> rows) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "run");
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    fmt::format_to(out, ",{}", nameOf(static_cast<Axis>(axis)));
  }
  fmt::format_to(out, ",seed,end,reason");
  for (const MetricInfo& info : kInfos) fmt::format_to(out, ",{}", info.column);
  fmt::format_to(out, ",trace_hash\n");
  for (const Row& row : rows) {
    fmt::format_to(out, "{}", row.run);
    const auto chosen = plan.choicesOf(row.run);
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      fmt::format_to(out, ",{}", cell(plan.choices[axis][chosen[axis]].name));
    }
    fmt::format_to(out, ",{},{},{}", plan.seedOf(row.run), row.end, cell(row.reason));
    for (const double value : row.values) {
      fmt::format_to(out, ",{}", row.failed() ? std::string() : number(value));
    }
    fmt::format_to(out, ",{}\n", row.failed() ? "" : fmt::format("{:016x}", row.traceHash));
  }
  return fmt::to_string(text);
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
      for (std::size_t i = 0; i < kMetrics; ++i) {
        entry[std::string(kInfos[i].column)] = row.values[i];
      }
      entry["trace_hash"] = fmt::format("{:016x}", row.traceHash);
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

std::string traceStem(const ExperimentPlan& plan, std::size_t run) {
  const std::size_t digits = fmt::format("{}", plan.runCount() - 1).size();
  return fmt::format("{:0{}}", run, digits);
}

tl::expected<void, Error> writeTables(const std::filesystem::path& folder,
                                      const ExperimentPlan& plan, std::span<const Row> rows) {
  return writeFile(folder / "results.csv", resultsCsv(plan, rows))
      .and_then([&] { return writeFile(folder / "results.json", resultsJson(plan, rows)); })
      .and_then([&] { return writeFile(folder / "timing.csv", timingCsv(rows)); });
}

}  // namespace forewalk::service
