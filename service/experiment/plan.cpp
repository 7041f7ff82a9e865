#include "service/experiment/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "rdw/json_fields.h"
#include "rdw/json_text.h"

namespace forewalk::service {
namespace {

using rdw::Fields;
using rdw::Json;
using rdw::Problem;

constexpr std::string_view kFormat = "forewalk.experiment/1";
constexpr std::string_view kPlane = "plane";
// Lists of the file, in the order of Axis.
constexpr std::array<std::string_view, kAxes> kLists{"scenes", "rooms",  "users",   "controllers",
                                                     "resets", "limits", "variants"};

/// What entries of a list set: keys of the simulation itself, or all below one of its keys.
std::string_view keyOf(Axis axis) {
  switch (axis) {
    case Axis::kRoom:
      return "space";
    case Axis::kUser:
      return "user";
    case Axis::kController:
      return "controller";
    case Axis::kReset:
      return "reset";
    case Axis::kLimits:
      return "limits";
    case Axis::kScene:
    case Axis::kVariant:
      return "";
  }
  return "";
}

/// An entry that is a word: a file, or a name that a simulation knows.
Choice choiceOf(Axis axis, const std::string& word) {
  Choice choice{word, Json::object()};
  if (axis != Axis::kScene) {
    choice.keys[std::string(keyOf(axis))] = word;
  } else if (word != kPlane) {
    choice.keys["scene"] = word;
  }
  return choice;
}

bool takesWords(Axis axis) { return axis != Axis::kUser && axis != Axis::kVariant; }

std::optional<Choice> readChoice(Axis axis, const Json& entry, const std::string& path,
                                 Problem& problem) {
  if (entry.is_string() && takesWords(axis)) return choiceOf(axis, entry.get<std::string>());
  if (!entry.is_object()) {
    const std::string_view kind =
        takesWords(axis) ? "text in quotes or an object {...}" : "an object {...}";
    problem.say(ErrorCode::kDataDamaged, fmt::format("{} has to be {}.", path, kind));
    return std::nullopt;
  }
  const auto name = entry.find("name");
  if (name == entry.end() || !name->is_string() || name->get_ref<const std::string&>().empty()) {
    problem.say(ErrorCode::kDataDamaged,
                fmt::format("{} needs a \"name\": text in quotes, for tables and plots.", path));
    return std::nullopt;
  }
  Choice choice{name->get<std::string>(), entry};
  choice.keys.erase("name");
  // An object for a controller is one with the reset, or whatever else, that goes with it.
  if (const std::string_view key = keyOf(axis); !key.empty() && axis != Axis::kController) {
    choice.keys = Json{{std::string(key), std::move(choice.keys)}};
  }
  return choice;
}

void readList(Fields& file, Axis axis, std::vector<Choice>& choices) {
  const std::string_view list = kLists[static_cast<std::size_t>(axis)];
  const Json* field = file.find(list);
  if (field == nullptr) {
    choices = {Choice{axis == Axis::kScene ? std::string(kPlane) : "", Json::object()}};
    return;
  }
  if (!field->is_array() || field->empty()) {
    return file.wrongKind(list, "a list [...] of at least one entry");
  }
  for (std::size_t i = 0; i < field->size(); ++i) {
    const std::string path = fmt::format("{}[{}]", list, i);
    std::optional<Choice> choice = readChoice(axis, (*field)[i], path, file.problem());
    if (!choice) return;
    const bool doubled = std::any_of(choices.begin(), choices.end(),
                                     [&](const Choice& c) { return c.name == choice->name; });
    if (doubled) {
      return file.problem().say(
          ErrorCode::kDataDamaged,
          fmt::format("{} is named {}, as another before it; results could not be told apart.",
                      path, inQuotes(choice->name)));
    }
    choices.push_back(std::move(*choice));
  }
}

void readSeeds(Fields& file, std::vector<std::uint64_t>& seeds) {
  const Json* field = file.find("seeds");
  seeds = {1};
  if (field == nullptr) return;
  const auto isWhole = [](const Json& value) { return value.is_number_unsigned(); };
  if (field->is_array() && !field->empty() && std::all_of(field->begin(), field->end(), isWhole)) {
    seeds = field->get<std::vector<std::uint64_t>>();
    std::vector<std::uint64_t> sorted = seeds;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice == sorted.end()) return;
    return file.problem().say(ErrorCode::kDataDamaged,
                              fmt::format("seeds: {} is there twice.", *twice));
  }
  std::size_t count = 0;
  if (!isWhole(*field)) return file.wrongKind("seeds", "a whole number, or a list of them");
  file.integer("seeds", 1, kMostRuns, count);
  seeds.clear();
  for (std::size_t i = 1; i <= count; ++i) seeds.push_back(i);
}

}  // namespace

std::string_view nameOf(Axis axis) {
  constexpr std::array<std::string_view, kAxes> kNames{"scene", "room",   "user",   "controller",
                                                       "reset", "limits", "variant"};
  return kNames[static_cast<std::size_t>(axis)];
}

std::size_t ExperimentPlan::runCount() const {
  std::size_t count = seeds.size();
  for (const auto& list : choices) count *= list.size();
  return count;
}

std::array<std::size_t, kAxes> ExperimentPlan::choicesOf(std::size_t run) const {
  std::array<std::size_t, kAxes> chosen{};
  std::size_t rest = run / seeds.size();
  for (std::size_t axis = kAxes; axis-- > 0;) {
    chosen[axis] = rest % choices[axis].size();
    rest /= choices[axis].size();
  }
  return chosen;
}

nlohmann::json ExperimentPlan::simulationOf(const std::array<std::size_t, kAxes>& chosen) const {
  Json simulation = walk;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    // Whole keys, not merged: a user of another kind keeps nothing of the one in `walk`.
    simulation.update(choices[axis][chosen[axis]].keys);
  }
  simulation["format"] = "forewalk.simulation/1";
  return simulation;
}

tl::expected<ExperimentPlan, Error> parseExperiment(std::span<const std::byte> bytes,
                                                    const std::string& name) {
  ExperimentPlan plan;
  plan.text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto json = rdw::parseJson(plan.text, name);
  if (!json) return tl::unexpected(json.error());
  Problem problem(name);
  Fields fields(*json, "", problem, "in an experiment");
  rdw::requireFormat(fields, kFormat);
  fields.text("name", plan.name);
  plan.walk = Json::object();
  if (const Json* walk = fields.find("walk")) {
    if (walk->is_object()) {
      plan.walk = *walk;
    } else {
      fields.wrongKind("walk", "an object {...} of a simulation's keys");
    }
  }
  if (plan.walk.contains("seed")) {
    problem.say(ErrorCode::kDataDamaged, "walk.seed: seeds are given by the list \"seeds\".");
  }
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    readList(fields, static_cast<Axis>(axis), plan.choices[axis]);
  }
  readSeeds(fields, plan.seeds);
  static constexpr std::string_view kTraces[] = {"none", "first", "all"};
  std::size_t traces = static_cast<std::size_t>(plan.traces);
  fields.word("traces", kTraces, traces);
  plan.traces = static_cast<Traces>(traces);
  static constexpr std::string_view kQuality[] = {"used", "all", "none"};
  auto quality = static_cast<std::size_t>(plan.quality);
  fields.word("prediction_quality", kQuality, quality);
  plan.quality = static_cast<QualityOf>(quality);
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  double runs = static_cast<double>(plan.seeds.size());
  for (const auto& list : plan.choices) runs *= static_cast<double>(list.size());
  if (runs > static_cast<double>(kMostRuns)) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format("{}: asks for {:.3g} runs, {} are the most; take fewer seeds or entries.",
                          name, runs, kMostRuns)});
  }
  return plan;
}

}  // namespace forewalk::service
