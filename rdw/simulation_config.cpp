#include "rdw/simulation_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "navmesh/file_text.h"
#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "rdw/tracked_space_file.h"

namespace forewalk::rdw {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kFormat = "forewalk.simulation/1";
constexpr std::size_t kMostWaypoints = 100000;

void readSpace(Fields& file, std::string& fileName, TrackedSpace& space) {
  const Json* field = file.find("space");
  if (field == nullptr) return;
  if (field->is_string()) {
    fileName = field->get<std::string>();
    return;
  }
  if (!field->is_object()) return file.wrongKind("space", "the name of a file, or an object {...}");
  Fields fields(*field, file.path() + "space.", file.problem());
  for (const std::string_view name :
       {"format", "rectangle", "circle", "polygon", "holes", "shape", "area_m2"})
    fields.find(name);
  fields.finish();
  const tl::expected<TrackedSpace, Error> made = spaceFromJson(*field);
  if (made) {
    space = *made;
  } else {
    file.problem().pass(made.error());
  }
}

void readLimits(Fields& file, GainLimits& limits) {
  const Json* field = file.find("limits");
  if (field == nullptr) return;
  std::vector<std::string_view> names;
  for (const GainPreset& preset : gainPresets()) names.push_back(preset.name);
  std::size_t preset = names.size();
  if (field->is_string()) {
    file.word("limits", names, preset);
    if (preset < names.size()) limits = gainPresets()[preset].limits;
    return;
  }
  Fields fields(*field, "limits.", file.problem());
  fields.word("preset", names, preset);
  if (preset < names.size()) limits = gainPresets()[preset].limits;
  fields.number("translation_min", 0.01, 1.0, limits.translationMin);
  fields.number("translation_max", 1.0, 100.0, limits.translationMax);
  fields.number("rotation_min", 0.01, 1.0, limits.rotationMin);
  fields.number("rotation_max", 1.0, 100.0, limits.rotationMax);
  fields.number("curvature_max_per_m", 0.0, 10.0, limits.curvatureMax);
  fields.number("bending_min", 0.01, 1.0, limits.bendingMin);
  fields.number("bending_max", 1.0, 100.0, limits.bendingMax);
  fields.finish();
}

void readResetPolicy(Fields& fields, std::string_view name, std::string& policy) {
  const std::span<const std::string_view> names = resetNames();
  std::size_t chosen = names.size();
  fields.word(name, names, chosen);
  if (chosen < names.size()) policy = names[chosen];
}

void readReset(Fields& file, SessionSettings& session) {
  const Json* field = file.find("reset");
  if (field == nullptr) return;
  if (field->is_string()) return readResetPolicy(file, "reset", session.resetPolicy);
  ResetSettings& reset = session.reset;
  Fields fields(*field, "reset.", file.problem());
  readResetPolicy(fields, "policy", session.resetPolicy);
  fields.number("reaction_s", 0.0, 10.0, reset.reactionTime);
  fields.number("deceleration_m_per_s2", 0.1, 1e9, reset.deceleration);
  fields.number("clearance_m", 0.0, 100.0, reset.clearance);
  fields.number("warning_s", 0.0, 60.0, reset.warningTime);
  static constexpr std::string_view kTriggers[] = {"ahead", "border"};
  auto trigger = static_cast<std::size_t>(reset.trigger);
  fields.word("trigger", kTriggers, trigger);
  reset.trigger = static_cast<ResetTrigger>(trigger);
  fields.finish();
}

void readStop(Fields& file, StopConditions& stop) {
  const Json* object = file.find("stop");
  if (object == nullptr) return;
  Fields fields(*object, "stop.", file.problem());
  fields.number("virtual_m", 1e-3, 1e6, stop.virtualMetres);
  fields.number("seconds", 1e-3, 86400.0, stop.seconds);
  fields.finish();
}

void readWaypoints(Fields& fields, UserFile& into) {
  Waypoints& waypoints = into.user.plan.emplace<Waypoints>();
  const Json* points = fields.find("waypoints");
  if (points != nullptr && points->is_string()) {
    into.waypoints = points->get<std::string>();
  } else if (points == nullptr || !points->is_array() || points->empty() ||
             points->size() > kMostWaypoints) {
    fields.wrongKind("waypoints",
                     fmt::format("a list of 1 to {} positions [x, y, z], or the name of a file",
                                 kMostWaypoints));
  } else {
    std::vector<double> xyz;
    for (std::size_t i = 0; i < points->size(); ++i) {
      if (!fields.coordinates((*points)[i], fmt::format("{}waypoints[{}]", fields.path(), i), 3,
                              xyz))
        break;
      waypoints.points.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
  }
  fields.boolean("loop", waypoints.loop);
}

void readLegs(Fields& fields, Legs& legs) {
  fields.number("leg_min_m", 0.1, 1e4, legs.lengthMin);
  fields.number("leg_max_m", 0.1, 1e4, legs.lengthMax);
  fields.number("turn_deg", 0.0, 180.0, legs.turn, kDegree);
  static constexpr std::string_view kTurns[] = {"either_side", "uniform"};
  std::size_t turn = legs.eitherSide ? 0 : 1;
  fields.word("turn", kTurns, turn);
  legs.eitherSide = turn == 0;
}

void readCourse(Fields& fields, CourseKind kind, Course& course) {
  course.kind = kind;
  const bool round = kind == CourseKind::kCircle || kind == CourseKind::kFigureEight;
  fields.number(round ? "radius_m" : "leg_m", 0.1, 1e4, course.size);
  if (kind == CourseKind::kSawtooth) fields.number("turn_deg", 0.0, 180.0, course.turn, kDegree);
}

/// One of the users who walk, or so many of a kind.
void readUser(Fields& fields, UserFile& into) {
  User& user = into.user;
  static constexpr std::string_view kKinds[] = {"waypoints", "wander", "legs",         "recorded",
                                                "sawtooth",  "circle", "figure-eight", "corridors"};
  std::size_t kind = std::size(kKinds);
  fields.word("kind", kKinds, kind);
  switch (kind) {
    case 0:
      readWaypoints(fields, into);
      break;
    case 1:
      fields.number("goal_distance_min_m", 0.0, 1e4, user.plan.emplace<Wander>().goalDistanceMin);
      break;
    case 2:
      readLegs(fields, user.plan.emplace<Legs>());
      break;
    case 3:
      user.plan.emplace<Recorded>();
      fields.text("walks", into.walks);
      fields.text("walker", into.walker);
      fields.text("intervals", into.intervals);
      if (!into.intervals.empty() && !into.walker.empty()) {
        fields.wrongKind("walker", "left out: a recording of OpenRDW's holds one walker");
      }
      if (into.walks.empty()) fields.wrongKind("walks", "the name of a file with recorded walks");
      break;
    case 4:
    case 5:
    case 6:
    case 7:
      readCourse(fields, static_cast<CourseKind>(kind - 4), user.plan.emplace<Course>());
      break;
    default:
      fields.wrongKind("kind", fmt::format("one of {}", fmt::join(kKinds, ", ")));
  }
  fields.integer("count", 1, kMostOthers + 1, into.count);
  WalkerSettings& w = user.walker;
  fields.number("speed_m_per_s", 0.01, 5.0, w.speed);
  fields.number("turn_rate_deg_per_s", 1.0, 720.0, w.turnRate, kDegree);
  fields.number("stop_angle_deg", 1.0, 180.0, w.stopAngle, kDegree);
  fields.number("reaction_s", 0.0, 2.0, w.reactionTime);
  fields.number("acceleration_m_per_s2", 0.1, 1e9, w.acceleration);
  fields.number("deceleration_m_per_s2", 0.1, 1e9, w.deceleration);
  fields.number("pause_min_s", 0.0, 600.0, w.pauseMin);
  fields.number("pause_max_s", 0.0, 600.0, w.pauseMax);
  fields.number("look_amplitude_deg", 0.0, 90.0, w.lookAmplitude, kDegree);
  fields.number("look_period_s", 0.5, 60.0, w.lookPeriod);
  fields.number("bob_m", 0.0, 0.2, w.bob);
  fields.number("sway_m", 0.0, 0.2, w.sway);
  fields.number("eye_height_m", 0.2, 3.0, w.eyeHeight);
  fields.number("corner_margin_m", 0.0, 2.0, w.cornerMargin);
}

void readUsers(Fields& file, SimulationFile& into) {
  const Json* object = file.find("user");
  if (object == nullptr) {
    return file.problem().say(
        ErrorCode::kDataDamaged,
        "user is missing: say who walks, for example {\"kind\": \"wander\"}.");
  }
  Fields fields(*object, "user.", file.problem());
  static constexpr std::string_view kShared[] = {"room", "world"};
  auto shared = static_cast<std::size_t>(into.sharing);
  fields.word("share", kShared, shared);
  into.sharing = static_cast<Sharing>(shared);
  const Json* together = fields.find("together");
  if (together == nullptr) {
    UserFile& user = into.users.emplace_back();
    readUser(fields, user);
    user.space = into.space;
    user.room = into.simulation.session.space;
  } else if (!together->is_array() || together->empty()) {
    fields.wrongKind("together", "a list [...] of users {...}");
  } else {
    for (std::size_t i = 0; i < together->size(); ++i) {
      Fields one((*together)[i], fmt::format("user.together[{}].", i), file.problem());
      UserFile& user = into.users.emplace_back();
      readUser(one, user);
      user.space = into.space;
      user.room = into.simulation.session.space;
      if (one.has("space")) {
        if (into.sharing == Sharing::kRoom) {
          one.wrongKind("space", "left out: who shares a room has no other one");
        }
        user.space.clear();
        readSpace(one, user.space, user.room);
      }
      one.finish();
    }
  }
  fields.finish();
  std::size_t count = 0;
  for (const UserFile& user : into.users) count += user.count;
  if (count > kMostOthers + 1) {
    file.problem().say(
        ErrorCode::kSettingOutOfRange,
        fmt::format("user: {} walk together, {} are the most.", count, kMostOthers + 1));
  }
  if (!into.users.empty()) into.simulation.user = into.users.front().user;
}

void readStart(Fields& file, WalkStart& start) {
  std::vector<double> numbers;
  if (const Json* object = file.find("start")) {
    Fields fields(*object, "start.", file.problem());
    if (fields.coordinates("position", 3, numbers)) {
      start.floor = glm::vec3(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    }
    double heading = NAN;
    fields.number("heading_deg", -360.0, 360.0, heading, kDegree);
    if (!std::isnan(heading)) start.heading = heading;
    fields.finish();
  }
  if (const Json* object = file.find("physical_start")) {
    Fields fields(*object, "physical_start.", file.problem());
    start.physical.emplace();
    if (fields.coordinates("position", 2, numbers))
      start.physical->position = {numbers[0], -numbers[1]};
    fields.number("heading_deg", -360.0, 360.0, start.physical->heading, kDegree);
    fields.finish();
  }
}

}  // namespace

tl::expected<SimulationFile, Error> parseSimulation(std::span<const std::byte> bytes,
                                                    const std::string& name) {
  const tl::expected<Json, Error> json =
      parseJson({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
  if (!json) return tl::unexpected(json.error());

  Problem problem(name);
  SimulationFile file;
  Fields fields(*json, "", problem, "in a simulation");
  requireFormat(fields, kFormat);
  SimulationConfig& simulation = file.simulation;
  SessionSettings& session = simulation.session;
  fields.text("scene", file.scene);
  readImport(fields, file.import);
  readBuild(fields, file.build);
  readSpace(fields, file.space, session.space);
  readLimits(fields, session.limits);
  const std::vector<std::string_view> controllers(controllerNames().begin(),
                                                  controllerNames().end());
  std::size_t controller = static_cast<std::size_t>(
      std::find(controllers.begin(), controllers.end(), session.controller) - controllers.begin());
  fields.word("controller", controllers, controller);
  if (controller < controllers.size()) session.controller = controllers[controller];
  fields.number("horizon_m", 0.1, 1000.0, session.horizon);
  fields.boolean("predict_always", session.alwaysPredict);
  fields.integer("polygon_limit", 1, 0xffffffffu, session.prediction.polygons);
  static constexpr std::string_view kMethods[] = {"polygon", "front"};
  std::size_t method = static_cast<std::size_t>(session.method);
  fields.word("method", kMethods, method);
  session.method = static_cast<prediction::Method>(method);
  fields.number("persistence_m", 0.0, 100.0, session.front.persistence);
  static constexpr std::string_view kHeadings[] = {"head", "chest", "walking"};
  auto heading = static_cast<std::size_t>(session.heading);
  fields.word("heading", kHeadings, heading);
  session.heading = static_cast<HeadingSource>(heading);
  fields.number("rate_hz", 5.0, 1000.0, simulation.rate);
  fields.integer("seed", 0, ~std::uint64_t{0}, simulation.seed);
  fields.boolean("resets", session.resets);
  readReset(fields, session);
  readStop(fields, simulation.stop);
  readUsers(fields, file);
  readStart(fields, simulation.start);
  if (const Json* agents = fields.find("agents")) file.agents = agents->dump();
  const bool several = file.users.size() > 1 || (!file.users.empty() && file.users[0].count > 1);
  if (several && !file.agents.empty()) {
    problem.say(ErrorCode::kSettingOutOfRange,
                "agents: are for one user; leave them out where several walk.");
  }
  if (several && simulation.start.physical && file.sharing == Sharing::kRoom) {
    problem.say(ErrorCode::kSettingOutOfRange,
                "physical_start: is for one user; several who share a room begin apart.");
  }
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return file;
}

}  // namespace forewalk::rdw
