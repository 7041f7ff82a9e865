#include "service/crowd_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "navmesh/plan.h"
#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "service/crowd_models.h"

namespace forewalk::service {
namespace {

using rdw::Fields;
using rdw::Json;
using rdw::Problem;

constexpr std::string_view kCrowdFormat = "forewalk.crowd/1";
constexpr std::uint32_t kMostAgents = 100000;
constexpr std::size_t kMostPoints = 100000;

void refuse(Problem& problem, const std::string& sentence) {
  problem.say(ErrorCode::kDataDamaged, sentence);
}

bool readPoint(Fields& fields, const Json& field, const std::string& what, glm::vec2& point) {
  std::vector<double> xz;
  if (!fields.coordinates(field, what, 2, xz)) return false;
  point = {static_cast<float>(xz[0]), static_cast<float>(-xz[1])};
  return true;
}

void readPoints(Fields& fields, const Json& field, const std::string& what, std::size_t least,
                std::vector<glm::vec2>& points) {
  if (!field.is_array() || field.size() < least || field.size() > kMostPoints) {
    return refuse(fields.problem(), fmt::format("{} has to be a list of {} to {} points [x, z].",
                                                what, least, kMostPoints));
  }
  for (std::size_t i = 0; i < field.size(); ++i) {
    glm::vec2 point;
    if (!readPoint(fields, field[i], fmt::format("{}[{}]", what, i), point)) return;
    points.push_back(point);
  }
}

void readArea(Fields& fields, const Json& field, const std::string& what, PlanArea& area) {
  std::vector<double> n;
  if (field.is_array() && field.size() == 4) {
    for (const Json& value : field) {
      if (value.is_number() && std::abs(value.get<double>()) <= 1e5)
        n.push_back(value.get<double>());
    }
  }
  if (n.size() != 4 || n[0] == n[2] || n[1] == n[3]) {
    return refuse(fields.problem(),
                  fmt::format("{} has to be two opposite corners [x, z, x, z], metres, within 100 "
                              "km, that differ in x and in z.",
                              what));
  }
  const glm::vec2 a(n[0], -n[1]), b(n[2], -n[3]);
  area = {glm::min(a, b), glm::max(a, b)};
}

/// A number, or the two ends of a range.
void readRange(Fields& fields, std::string_view name, double low, double high, glm::vec2& range) {
  const Json* field = fields.find(name);
  if (field == nullptr) return;
  std::vector<double> ends;
  const auto add = [&](const Json& value) {
    if (value.is_number()) ends.push_back(value.get<double>());
  };
  if (field->is_array() && field->size() == 2) {
    add((*field)[0]);
    add((*field)[1]);
  } else if (field->is_number()) {
    add(*field);
    add(*field);
  }
  if (ends.size() != 2 || ends[0] > ends[1]) {
    return fields.wrongKind(name, "a number, or a range [low, high]");
  }
  if (!(ends[0] >= low && ends[1] <= high)) {
    return fields.problem().say(
        ErrorCode::kSettingOutOfRange,
        fmt::format("{}{} is {:.6g} to {:.6g}, it has to lie in [{:.6g}, {:.6g}].", fields.path(),
                    name, ends[0], ends[1], low, high));
  }
  range = glm::vec2(ends[0], ends[1]);
}

void readObstacle(Fields& file, const Json& object, std::size_t number, CrowdConfig& config) {
  Fields fields(object, fmt::format("obstacles[{}].", number), file.problem());
  PlacedObstacle placed;
  const auto what = [&](std::string_view name) { return fmt::format("{}{}", fields.path(), name); };
  const Json* circle = fields.find("circle");
  const Json* box = fields.find("box");
  const Json* polygon = fields.find("polygon");
  if ((circle != nullptr) + (box != nullptr) + (polygon != nullptr) != 1) {
    return refuse(file.problem(), fmt::format("obstacles[{}] has to have one of circle, box and "
                                              "polygon.",
                                              number));
  }
  glm::vec2 middle(0.0f);
  if (circle != nullptr) {
    navmesh::CylinderObstacle cylinder;
    if (!readPoint(fields, *circle, what("circle"), middle)) return;
    cylinder.foot = navmesh::toSpace(middle, 0.0f);
    fields.number("radius_m", 0.01, 1000.0, cylinder.radius);
    placed.shape = cylinder;
  } else if (box != nullptr) {
    navmesh::BoxObstacle upright;
    if (!readPoint(fields, *box, what("box"), middle)) return;
    upright.centre = navmesh::toSpace(middle, 1.0f);
    std::vector<double> size;
    if (fields.coordinates("size", 2, size)) {
      upright.halfSize = glm::vec3(0.5 * size[0], 1.0, 0.5 * size[1]);
    }
    fields.number("heading_deg", -360.0, 360.0, upright.heading, rdw::kDegree);
    placed.shape = upright;
  } else {
    navmesh::PrismObstacle prism;
    readPoints(fields, *polygon, what("polygon"), 3, prism.corners);
    float area = 0.0f;
    for (std::size_t i = 0; i < prism.corners.size(); ++i) {
      area += navmesh::cross(prism.corners[i], prism.corners[(i + 1) % prism.corners.size()]);
    }
    if (area < 0.0f) std::reverse(prism.corners.begin(), prism.corners.end());
    placed.shape = prism;
  }
  if (const Json* velocity = fields.find("velocity")) {
    readPoint(fields, *velocity, what("velocity"), placed.velocity);
  }
  fields.number("from_s", 0.0, 1e6, placed.from);
  fields.number("until_s", 0.0, 1e6, placed.until);
  fields.finish();
  if (file.problem().error()) return;
  if (!(placed.until > placed.from)) {
    return refuse(file.problem(),
                  fmt::format("obstacles[{}] is there from {:g} s until {:g} s; until_s has to be "
                              "later than from_s.",
                              number, placed.from, placed.until));
  }
  if (const auto valid = navmesh::validate(placed.shape); !valid) {
    return file.problem().say(valid.error().code,
                              fmt::format("obstacles[{}]: {}", number, valid.error().message));
  }
  config.obstacles.push_back(std::move(placed));
}

void readGround(Fields& file, CrowdConfig& config) {
  if (const Json* room = file.find("room")) {
    readPoints(file, *room, "room", 3, config.room);
    float area = 0.0f;
    for (std::size_t i = 0; i < config.room.size(); ++i) {
      area += navmesh::cross(config.room[i], config.room[(i + 1) % config.room.size()]);
    }
    if (area < 0.0f) std::reverse(config.room.begin(), config.room.end());
  }
  if (const Json* walls = file.find("walls")) {
    if (!walls->is_array())
      return file.wrongKind("walls", "a list of walls, each a list of points");
    for (std::size_t i = 0; i < walls->size(); ++i) {
      readPoints(file, (*walls)[i], fmt::format("walls[{}]", i), 2, config.walls.emplace_back());
    }
  }
  if (const Json* obstacles = file.find("obstacles")) {
    if (!obstacles->is_array()) return file.wrongKind("obstacles", "a list of objects {...}");
    for (std::size_t i = 0; i < obstacles->size(); ++i) {
      readObstacle(file, (*obstacles)[i], i, config);
    }
  }
}

void readStart(Fields& group, CrowdGroup& into) {
  const Json* field = group.find("start");
  CrowdStart& start = into.start;
  if (field != nullptr && field->is_string() && *field == "anywhere") {
    start.kind = CrowdStart::Kind::anywhere;
    return;
  }
  if (field == nullptr || !field->is_object()) {
    return group.wrongKind("start",
                           "{\"points\": ...}, {\"area\": ...}, {\"ring\": ...} or "
                           "\"anywhere\"");
  }
  Fields fields(*field, group.path() + "start.", group.problem());
  if (const Json* points = fields.find("points")) {
    readPoints(fields, *points, fields.path() + "points", into.count, start.points);
  } else if (const Json* area = fields.find("area")) {
    start.kind = CrowdStart::Kind::area;
    readArea(fields, *area, fields.path() + "area", start.area);
  } else if (const Json* ring = fields.find("ring")) {
    start.kind = CrowdStart::Kind::ring;
    readPoint(fields, *ring, fields.path() + "ring", start.centre);
    fields.number("radius_m", 0.01, 1e5, start.radius);
  } else {
    refuse(group.problem(),
           fmt::format("{}start has to have one of points, area and ring.", group.path()));
  }
  fields.finish();
}

void readGoal(Fields& group, CrowdGroup& into) {
  const Json* field = group.find("goal");
  CrowdGoal& goal = into.goal;
  if (field == nullptr) return;
  if (field->is_string()) {
    static constexpr std::string_view kWords[] = {"none", "opposite", "anywhere"};
    std::size_t word = 0;
    group.word("goal", kWords, word);
    constexpr CrowdGoal::Kind kKinds[] = {CrowdGoal::Kind::none, CrowdGoal::Kind::opposite,
                                          CrowdGoal::Kind::anywhere};
    goal.kind = kKinds[word];
    if (goal.kind == CrowdGoal::Kind::opposite && into.start.kind != CrowdStart::Kind::ring) {
      refuse(group.problem(),
             fmt::format("{}goal is \"opposite\", which needs a start on a ring.", group.path()));
    }
    return;
  }
  Fields fields(*field, group.path() + "goal.", group.problem());
  if (const Json* points = fields.find("points")) {
    goal.kind = CrowdGoal::Kind::points;
    readPoints(fields, *points, fields.path() + "points", 1, goal.points);
    if (goal.points.size() != 1 && goal.points.size() < into.count) {
      refuse(group.problem(), fmt::format("{}points has {} for {} agents: give one for all, or one "
                                          "each.",
                                          fields.path(), goal.points.size(), into.count));
    }
  } else if (const Json* area = fields.find("area")) {
    goal.kind = CrowdGoal::Kind::area;
    readArea(fields, *area, fields.path() + "area", goal.area);
  } else if (const Json* visit = fields.find("visit")) {
    goal.kind = CrowdGoal::Kind::visit;
    readPoints(fields, *visit, fields.path() + "visit", 1, goal.points);
    fields.boolean("loop", goal.loop);
  } else if (fields.find("follow") != nullptr) {
    goal.kind = CrowdGoal::Kind::follow;
    fields.text("follow", goal.follow);
    fields.number("distance_m", 0.1, 100.0, goal.distance);
  } else {
    refuse(group.problem(),
           fmt::format("{}goal has to have one of points, area, visit and follow.", group.path()));
  }
  fields.finish();
}

void readGroup(Fields& file, const Json& object, std::size_t number, const std::string& model,
               std::span<const std::string_view> models, CrowdConfig& config) {
  Fields fields(object, fmt::format("{}groups[{}].", file.path(), number), file.problem());
  CrowdGroup group;
  group.name = fmt::format("group {}", number);
  fields.text("name", group.name);
  fields.integer("count", 1, kMostAgents, group.count);
  std::size_t which =
      static_cast<std::size_t>(std::find(models.begin(), models.end(), model) - models.begin());
  fields.word("model", models, which);
  group.model = which < models.size() ? std::string(models[which]) : model;
  fields.boolean("human", group.human);
  fields.boolean("friends", group.friends);
  readRange(fields, "radius_m", 0.01, 100.0, group.radius);
  readRange(fields, "speed_m_per_s", 0.0, 100.0, group.speed);
  fields.number("depart_s", 0.0, 86400.0, group.departSeconds);
  fields.number("height_m", -1e4, 1e4, group.height);
  readStart(fields, group);
  readGoal(fields, group);
  fields.finish();
  if (group.goal.kind == CrowdGoal::Kind::follow) {
    const auto leads = [&](const CrowdGroup& other) { return other.name == group.goal.follow; };
    if (std::none_of(config.groups.begin(), config.groups.end(), leads)) {
      refuse(file.problem(), fmt::format("{}groups[{}].goal.follow is {}, which is no group "
                                         "before this one.",
                                         file.path(), number, inQuotes(group.goal.follow)));
    }
  }
  const bool anywhere = group.start.kind == CrowdStart::Kind::anywhere ||
                        group.goal.kind == CrowdGoal::Kind::anywhere;
  if (anywhere && config.scene.empty()) {
    refuse(file.problem(), fmt::format("{}groups[{}] is put \"anywhere\", which needs a scene; "
                                       "give an area.",
                                       file.path(), number));
  }
  config.groups.push_back(std::move(group));
}

using Makers = std::map<std::string, ModelMaker, std::less<>>;

Makers readModels(Fields& file) {
  Makers makers;
  for (const RegisteredModel& model : registeredModels()) {
    makers[std::string(model.name)] = model.read(nullptr);
  }
  const Json* object = file.find("models");
  if (object == nullptr) return makers;
  Fields fields(*object, file.path() + "models.", file.problem());
  for (const RegisteredModel& model : registeredModels()) {
    const Json* parameters = fields.find(model.name);
    if (parameters == nullptr) continue;
    Fields of(*parameters, fmt::format("{}models.{}.", file.path(), model.name), file.problem());
    makers[std::string(model.name)] = model.read(&of);
    of.finish();
  }
  fields.finish();
  return makers;
}

}  // namespace

void readGroups(Fields& fields, const std::string& scene, CrowdConfig& config) {
  Problem& problem = fields.problem();
  config.scene = scene;
  std::vector<std::string_view> models;
  for (const RegisteredModel& model : registeredModels()) models.push_back(model.name);
  std::size_t model = 0;
  fields.word("model", models, model);
  config.makeModel = [makers = readModels(fields)](const std::string& wanted) {
    return makers.at(wanted)();
  };
  const Json* groups = fields.find("groups");
  if (groups == nullptr || !groups->is_array() || groups->empty()) {
    fields.wrongKind("groups", "a list of at least one group {...}");
  } else {
    std::uint64_t agents = 0;
    for (std::size_t i = 0; i < groups->size() && !problem.error(); ++i) {
      readGroup(fields, (*groups)[i], i, std::string(models[model]), models, config);
      agents += config.groups.back().count;
    }
    if (agents > kMostAgents) {
      problem.say(ErrorCode::kTooLarge,
                  fmt::format("{}groups have {} agents together; at most {} can be run.",
                              fields.path(), agents, kMostAgents));
    }
  }
}

tl::expected<CrowdConfig, Error> parseCrowd(std::span<const std::byte> bytes,
                                            const std::string& name) {
  const tl::expected<Json, Error> json =
      rdw::parseJson({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
  if (!json) return tl::unexpected(json.error());
  Problem problem(name);
  CrowdConfig config;
  Fields fields(*json, "", problem, "in a crowd");
  rdw::requireFormat(fields, kCrowdFormat);
  fields.text("scene", config.scene);
  rdw::readImport(fields, config.import);
  rdw::readBuild(fields, config.build);
  fields.number("seconds", 0.01, 86400.0, config.seconds);
  fields.number("tick_s", 0.001, 10.0, config.tick);
  fields.integer("seed", 0, ~std::uint64_t{0}, config.seed);
  fields.boolean("projection", config.projection);

  readGround(fields, config);
  readGroups(fields, config.scene, config);
  if (const Json* measure = fields.find("measure")) {
    Fields inside(*measure, "measure.", problem);
    config.measure.emplace();
    if (const Json* area = inside.find("area")) {
      readArea(inside, *area, "measure.area", *config.measure);
    } else {
      inside.wrongKind("area", "two opposite corners [x, z, x, z]");
    }
    inside.finish();
  }
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return config;
}

}  // namespace forewalk::service
