#include "service/company_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "service/crowd_models.h"

namespace forewalk::service {
namespace {

using rdw::Fields;
using rdw::Json;

void readUser(Fields& agents, CompanyConfig& config) {
  const Json* object = agents.find("user");
  if (object == nullptr) return;
  Fields fields(*object, agents.path() + "user.", agents.problem());
  fields.number("radius_m", 0.01, 5.0, config.userRadius);
  fields.boolean("avoids", config.userAvoids);
  std::vector<std::string_view> models;
  for (const RegisteredModel& model : registeredModels()) models.push_back(model.name);
  std::size_t model = static_cast<std::size_t>(
      std::find(models.begin(), models.end(), config.userModel) - models.begin());
  fields.word("model", models, model);
  config.userModel = models[model];
  fields.finish();
}

void readBlocking(Fields& agents, CompanyConfig& config) {
  const Json* object = agents.find("blocking");
  if (object == nullptr) return;
  Fields fields(*object, agents.path() + "blocking.", agents.problem());
  fields.number("after_s", 0.0, 3600.0, config.blockAfter);
  const Json* cost = fields.find("cost");
  if (cost != nullptr && *cost == "free") {
    config.blocks = false;
  } else if (cost != nullptr && cost->is_number()) {
    fields.number("cost", 1.0, static_cast<double>(navmesh::kHighestCost), config.blockCost);
  } else if (cost != nullptr && *cost != "closed") {
    fields.wrongKind("cost", "\"closed\", \"free\" or a number of 1 or more");
  }
  fields.finish();
}

}  // namespace

tl::expected<CompanyConfig, Error> parseCompany(const std::string& json, const std::string& name,
                                                const std::string& scene, std::uint64_t seed) {
  const tl::expected<Json, Error> parsed = rdw::parseJson(json, name);
  if (!parsed) return tl::unexpected(parsed.error());
  rdw::Problem problem(name);
  Fields fields(*parsed, "agents.", problem, "among the agents of a simulation");
  CompanyConfig config;
  config.crowd.seed = seed;
  config.crowd.tick = 0.05;
  fields.number("tick_s", 0.001, 1.0, config.crowd.tick);
  fields.integer("seed", 0, ~std::uint64_t{0}, config.crowd.seed);
  fields.boolean("projection", config.crowd.projection);
  readGroups(fields, scene, config.crowd);
  readUser(fields, config);
  readBlocking(fields, config);
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return config;
}

}  // namespace forewalk::service
