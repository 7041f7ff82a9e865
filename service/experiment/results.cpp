#include "service/experiment/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "rdw/json_text.h"
#include "service/files.h"

namespace forewalk::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kManifestFormat = "forewalk.results/1";

/// Numbers of a JSON list, as many as there are; null, and what is not there, was not measured.
template <std::size_t N>
std::array<double, N> numbersOf(const nlohmann::json& list) {
  if (!list.is_array() || list.size() > N) {
    throw nlohmann::json::other_error::create(501, "not such a list", &list);
  }
  std::array<double, N> values;
  values.fill(kNotMeasured);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_null()) values[i] = list[i].get<double>();
  }
  return values;
}

std::uint64_t hashOf(const nlohmann::json& text) {
  const auto& hash = text.get_ref<const std::string&>();
  std::uint64_t value = 0;
  const auto read = std::from_chars(hash.data(), hash.data() + hash.size(), value, 16);
  if (read.ec != std::errc() || read.ptr != hash.data() + hash.size()) {
    throw nlohmann::json::other_error::create(501, "no hash", &text);
  }
  return value;
}

}  // namespace

std::string lineOf(const Row& row) {
  Json json{{"run", row.run}};
  if (row.failed()) {
    json["end"] = row.end;
    json["reason"] = row.reason;
    return json.dump() + '\n';
  }
  json["users"] = Json::array();
  for (const UserRow& user : row.users) {
    json["users"].push_back({{"end", user.end},
                             {"hash", fmt::format("{:016x}", user.traceHash)},
                             {"values", user.values},
                             {"openrdw", user.openRdw}});
  }
  json["times"] = row.times;
  json["heat"] = row.heat;
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
    if (const auto end = json.find("end"); end != json.end()) {
      row.end = end->get<std::string>();
      if (!row.failed()) return refuse();
      row.reason = json.at("reason").get<std::string>();
      return row;
    }
    for (const auto& user : json.at("users")) {
      row.users.push_back({user.at("end").get<std::string>(), hashOf(user.at("hash")),
                           numbersOf<kMetrics>(user.at("values")),
                           numbersOf<kOpenRdwValues>(user.at("openrdw"))});
    }
    if (row.users.empty()) return refuse();
    row.times = json.at("times").get<decltype(row.times)>();
    row.heat = json.at("heat").get<decltype(row.heat)>();
    together(row);
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
  json["rooms"] = Json::array();
  for (const RoomOutline& room : manifest.rooms) {
    Json rings = Json::array();
    for (const auto& ring : room.rings) {
      rings.push_back(Json::array());
      for (const glm::dvec2 corner : ring) rings.back().push_back({corner.x, corner.y});
    }
    json["rooms"].push_back({{"name", room.name}, {"rings", std::move(rings)}});
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
    for (const auto& room : json->value("rooms", nlohmann::json::array())) {
      RoomOutline& outline = manifest.rooms.emplace_back();
      outline.name = room.at("name").get<std::string>();
      for (const auto& ring : room.at("rings")) {
        auto& corners = outline.rings.emplace_back();
        for (const auto& corner : ring) {
          corners.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
        }
      }
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

}  // namespace forewalk::service
