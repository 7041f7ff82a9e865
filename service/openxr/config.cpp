#include "service/openxr/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "rdw/simulation_config.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::openxr {
namespace {

using rdw::Fields;
using rdw::Json;
using rdw::Problem;

void readOrigin(Fields& file, LayerConfig& config) {
  const Json* object = file.find("origin");
  if (object == nullptr) return;
  Fields fields(*object, "origin.", file.problem());
  static constexpr std::string_view kSpaces[] = {"stage", "local"};
  auto space = static_cast<std::size_t>(config.originSpace);
  fields.word("space", kSpaces, space);
  config.originSpace = static_cast<OriginSpace>(space);
  std::vector<double> position(3, 0.0);
  if (fields.find("position") != nullptr) fields.coordinates("position", 3, position);
  double heading = 0.0;
  fields.number("heading_deg", -360.0, 360.0, heading, rdw::kDegree);
  fields.finish();
  if (position.size() != 3) return;  // said already
  config.origin = levelRigid(heading, {position[0], position[1], position[2]});
}

void readTint(Fields& file, glm::vec3& tint) {
  const Json* field = file.find("reset_tint");
  if (field == nullptr) return;
  bool sound = field->is_array() && field->size() == 3;
  for (std::size_t i = 0; sound && i < 3; ++i) {
    sound = (*field)[i].is_number();
    if (!sound) break;
    const double part = (*field)[i].get<double>();
    sound = part >= 0.0 && part <= 1.0;
    if (sound) tint[static_cast<glm::vec3::length_type>(i)] = static_cast<float>(part);
  }
  if (!sound) file.wrongKind("reset_tint", "3 numbers from 0 to 1 [red, green, blue]");
}

void readApplications(Fields& file, std::vector<std::string>& applications) {
  const Json* field = file.find("applications");
  if (field == nullptr) return;
  const bool sound =
      field->is_array() && !field->empty() &&
      std::all_of(field->begin(), field->end(), [](const Json& name) { return name.is_string(); });
  if (!sound) return file.wrongKind("applications", "a list of names in quotes");
  for (const Json& name : *field) applications.push_back(name.get<std::string>());
}

/// What is the layer's alone; the names of the rest are only checked.
tl::expected<void, Error> readOwn(const Json& json, LayerConfig& config) {
  Problem problem(config.file.string());
  Fields fields(json, "", problem, "in a layer's configuration");
  rdw::requireFormat(fields, "forewalk.openxr/1");
  fields.text("scene", config.scene);
  for (const std::string_view name :
       {"import", "build", "limits", "controller", "horizon_m", "method", "persistence_m", "resets",
        "reset", "heading", "start"}) {
    fields.find(name);
  }
  const Json* space = fields.find("space");
  config.stageRoom = space == nullptr || *space == "stage";
  readOrigin(fields, config);
  fields.number("eye_height_m", 0.2, 3.0, config.eyeHeight);
  readTint(fields, config.resetTint);
  readApplications(fields, config.applications);
  fields.finish();
  if (!problem.error() && config.scene.empty()) {
    problem.say(ErrorCode::kDataDamaged,
                "scene is missing: name the building that is walked in, for example "
                "\"museum.fwmesh\" (forewalk build).");
  }
  if (problem.error()) return tl::unexpected(*problem.error());
  return {};
}

}  // namespace

tl::expected<LayerConfig, Error> loadConfig(const std::filesystem::path& file) {
  const auto bytes = service::readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto json =
      rdw::parseJson({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file.string());
  if (!json) return tl::unexpected(std::move(json.error()));
  LayerConfig config;
  config.file = file;
  if (auto own = readOwn(*json, config); !own) return tl::unexpected(std::move(own.error()));

  // The rest is a simulation's, with its ranges and its words.
  for (const char* name : {"origin", "eye_height_m", "reset_tint", "applications"}) {
    json->erase(name);
  }
  if (config.stageRoom) json->erase("space");
  (*json)["format"] = "forewalk.simulation/1";
  (*json)["user"] = {{"kind", "wander"}};
  (*json)["predict_always"] = false;
  const std::string text = json->dump(-1, ' ', true, Json::error_handler_t::replace);
  const auto parsed = rdw::parseSimulation(std::as_bytes(std::span(text)), file.string());
  if (!parsed) return tl::unexpected(parsed.error());
  navmesh::BuildRun run;
  run.forEach = service::onThreads(0);
  const std::filesystem::path folder = file.parent_path();
  const auto navMesh =
      service::loadNavMesh(folder / parsed->scene, parsed->import, parsed->build, run);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return tl::unexpected(std::move(world.error()));
  config.world = std::move(*world);
  config.session = parsed->simulation.session;
  if (!parsed->space.empty()) {
    const std::filesystem::path name = folder / parsed->space;
    const auto room = service::readFile(name);
    if (!room) return tl::unexpected(room.error());
    auto space =
        rdw::TrackedSpace::read({reinterpret_cast<const char*>(room->data()), room->size()});
    if (!space) {
      return tl::unexpected(
          Error{space.error().code, name.string() + ": " + space.error().message});
    }
    config.session.space = std::move(*space);
  }
  const rdw::WalkStart& start = parsed->simulation.start;
  if (start.floor) {
    config.session.start =
        rdw::VirtualStart{*start.floor, static_cast<float>(start.heading.value_or(0.0))};
  }
  return config;
}

bool isMeant(const LayerConfig& config, std::string_view application) {
  const auto& names = config.applications;
  return names.empty() || std::find(names.begin(), names.end(), application) != names.end();
}

}  // namespace forewalk::openxr
