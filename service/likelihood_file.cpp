#include "service/likelihood_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "service/files.h"
#include "service/fitting.h"

namespace forewalk::service {

using Json = nlohmann::ordered_json;

std::string toJson(const LikelihoodRecord& record) {
  Json json;
  json["format"] = "forewalk.likelihood/1";
  json["method"] = record.method;
  json["horizons"] = record.horizons;
  Json data = Json::array();
  for (const TrainingData& from : record.trainedOn) {
    data.push_back({{"scene", from.scene}, {"walks", from.walks}, {"walkers", from.walkers}});
  }
  json["trained_on"] = data;
  json["samples"] = record.samples;
  json["nll"] = std::round(record.nll * 1e4) / 1e4;
  Json parameters;
  for (const ParameterInfo& info : parameterInfos()) {
    // Four digits: what was fitted on a dozen walks is not known better.
    parameters[info.name] = std::stod(fmt::format("{:.4g}", record.parameters.*info.member));
  }
  json["parameters"] = parameters;
  return json.dump(2) + "\n";
}

tl::expected<prediction::LikelihoodParameters, Error> readLikelihood(
    const std::filesystem::path& file) {
  auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(std::move(bytes.error()));
  const auto* text = reinterpret_cast<const char*>(bytes->data());
  const Json json = Json::parse(text, text + bytes->size(), nullptr, false);
  const auto refuse = [&](ErrorCode code, const std::string& what) {
    return tl::unexpected(Error{code, fmt::format("{}: {}", file.string(), what)});
  };
  if (json.is_discarded() || !json.is_object() || !json.contains("format") ||
      json["format"] != "forewalk.likelihood/1") {
    return refuse(ErrorCode::kFormatUnknown,
                  "this is no JSON of format forewalk.likelihood/1. Make one with forewalk fit.");
  }
  if (!json.contains("parameters") || !json["parameters"].is_object()) {
    return refuse(ErrorCode::kDataDamaged,
                  "there is no object \"parameters\". Make the file with forewalk fit.");
  }
  prediction::LikelihoodParameters parameters;
  for (const auto& [name, value] : json["parameters"].items()) {
    const std::span<const ParameterInfo> infos = parameterInfos();
    const auto info = std::find_if(infos.begin(), infos.end(),
                                   [&known = name](const auto& one) { return known == one.name; });
    if (info == infos.end()) {
      return refuse(
          ErrorCode::kDataDamaged,
          fmt::format("there is no parameter \"{}\". Remove it or correct its name.", name));
    }
    if (!value.is_number()) {
      return refuse(ErrorCode::kDataDamaged,
                    fmt::format("parameter \"{}\" is {}, no number.", name, value.dump()));
    }
    const double number = value.get<double>();
    if (!(number >= info->low && number <= info->high)) {
      return refuse(ErrorCode::kSettingOutOfRange,
                    fmt::format("parameter \"{}\" is {:g}; give {:g} to {:g}.", name, number,
                                info->low, info->high));
    }
    parameters.*info->member = number;
  }
  return parameters;
}

}  // namespace forewalk::service
