#include "rdw/simulation_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "navmesh/file_text.h"
#include "rdw/json_text.h"
#include "rdw/tracked_space_file.h"

namespace forewalk::rdw {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kFormat = "forewalk.simulation/1";
constexpr double kDegree = kPi / 180.0;
constexpr double kFarthest = 1e5;  // metres
constexpr std::size_t kMostWaypoints = 100000;

/// The first thing that is wrong; what is found after it stays unsaid.
class Problem {
 public:
  explicit Problem(std::string file) : file_(std::move(file)) {}

  void say(ErrorCode code, const std::string& sentence) {
    if (!error_) error_ = Error{code, fmt::format("{}: {}", file_, sentence)};
  }
  void pass(const Error& error) { say(error.code, error.message); }
  const std::optional<Error>& error() const { return error_; }

 private:
  std::string file_;
  std::optional<Error> error_;
};

/// Letters to change, add or drop to get from one word to the other (Levenshtein 1966).
std::size_t lettersApart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string suggestion(std::string_view wrong, std::span<const std::string_view> known) {
  const auto nearest = std::min_element(known.begin(), known.end(), [&](auto a, auto b) {
    return lettersApart(wrong, a) < lettersApart(wrong, b);
  });
  if (nearest != known.end() &&
      lettersApart(wrong, *nearest) <= std::max<std::size_t>(2, nearest->size() / 2)) {
    return fmt::format("did you mean \"{}\"?", *nearest);
  }
  return fmt::format("known are: {}.", fmt::join(known, ", "));
}

/// Reads the fields of one object and knows which have been asked for.
class Fields {
 public:
  /// `path` is "" for the whole file, else ends in a dot.
  Fields(const Json& object, std::string path, Problem& problem)
      : object_(object), path_(std::move(path)), problem_(problem) {
    if (!object_.is_object()) {
      problem_.say(ErrorCode::kDataDamaged,
                   fmt::format("{} has to be an object {{...}}.",
                               path_.empty() ? "the file" : path_.substr(0, path_.size() - 1)));
    }
  }

  /// The field, or null where it is absent. Makes the name a known one.
  const Json* find(std::string_view name) {
    known_.push_back(name);
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(std::string(name));
    return found == object_.end() ? nullptr : &*found;
  }

  /// Reads a number in [low, high], times `scale`, where the field is present.
  template <typename Real>
  void number(std::string_view name, double low, double high, Real& value, double scale = 1.0) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_number()) return wrongKind(name, "a number");
    const double read = field->get<double>();
    if (!(read >= low && read <= high)) {
      return problem_.say(ErrorCode::kSettingOutOfRange,
                          fmt::format("{}{} is {:.6g}, it has to lie in [{:.6g}, {:.6g}].", path_,
                                      name, read, low, high));
    }
    value = static_cast<Real>(read * scale);
  }

  template <typename Integer>
  void integer(std::string_view name, std::uint64_t low, std::uint64_t high, Integer& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_number_unsigned()) return wrongKind(name, "a whole number, 0 or more");
    const std::uint64_t read = field->get<std::uint64_t>();
    if (read < low || read > high) {
      return problem_.say(
          ErrorCode::kSettingOutOfRange,
          fmt::format("{}{} is {}, it has to lie in [{}, {}].", path_, name, read, low, high));
    }
    value = static_cast<Integer>(read);
  }

  void boolean(std::string_view name, bool& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_boolean()) return wrongKind(name, "true or false");
    value = field->get<bool>();
  }

  void text(std::string_view name, std::string& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_string()) return wrongKind(name, "text in quotes");
    value = field->get<std::string>();
  }

  /// Reads one of `words`; `value` stays where the field is absent. Index of the word.
  void word(std::string_view name, std::span<const std::string_view> words, std::size_t& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_string())
      return wrongKind(name, fmt::format("one of {}", fmt::join(words, ", ")));
    const std::string& read = field->get_ref<const std::string&>();
    const auto found = std::find(words.begin(), words.end(), read);
    if (found == words.end()) {
      return problem_.say(ErrorCode::kDataDamaged,
                          fmt::format("{}{} is {}, which is not known; {}", path_, name,
                                      inQuotes(read), suggestion(read, words)));
    }
    value = static_cast<std::size_t>(found - words.begin());
  }

  /// Reads a list of `count` finite numbers within 100 km. Whether it is present and sound.
  bool coordinates(std::string_view name, std::size_t count, std::vector<double>& values) {
    const Json* field = find(name);
    return field != nullptr && coordinates(*field, fmt::format("{}{}", path_, name), count, values);
  }

  bool coordinates(const Json& list, const std::string& what, std::size_t count,
                   std::vector<double>& values) {
    values.clear();
    if (list.is_array() && list.size() == count) {
      for (const Json& value : list) {
        if (value.is_number() && std::abs(value.get<double>()) <= kFarthest)
          values.push_back(value.get<double>());
      }
    }
    if (values.size() == count) return true;
    problem_.say(ErrorCode::kDataDamaged,
                 fmt::format("{} has to be {} numbers [{}], metres, within 100 km.", what, count,
                             count == 2 ? "x, z" : "x, y, z"));
    return false;
  }

  void wrongKind(std::string_view name, std::string_view kind) {
    problem_.say(ErrorCode::kDataDamaged, fmt::format("{}{} has to be {}.", path_, name, kind));
  }

  const std::string& path() const { return path_; }
  Problem& problem() { return problem_; }

  /// Refuses what nobody asked for.
  void finish() {
    if (!object_.is_object()) return;
    for (const auto& [key, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      problem_.say(
          ErrorCode::kDataDamaged,
          fmt::format("{} is not known {}; {}", inQuotes(path_ + key),
                      path_.empty() ? "in a simulation" : "here", suggestion(key, known_)));
    }
  }

 private:
  const Json& object_;
  std::string path_;
  Problem& problem_;
  std::vector<std::string_view> known_;
};

void readImport(Fields& file, navmesh::ImportSettings& import) {
  const Json* object = file.find("import");
  if (object == nullptr) return;
  Fields fields(*object, "import.", file.problem());
  fields.number("metres_per_unit", 1e-6, 1e6, import.metresPerUnit);
  static constexpr std::string_view kAxes[] = {"y", "z"};
  std::size_t up = import.up == navmesh::UpAxis::kY ? 0 : 1;
  fields.word("up", kAxes, up);
  import.up = up == 0 ? navmesh::UpAxis::kY : navmesh::UpAxis::kZ;
  fields.finish();
}

// Ranges that the settings share are left to the builder, which knows what follows from which.
void readBuild(Fields& file, navmesh::BuildSettings& build) {
  const Json* object = file.find("build");
  if (object == nullptr) return;
  Fields fields(*object, "build.", file.problem());
  fields.number("radius_m", 0.0, 10.0, build.radius);
  fields.number("height_m", 0.01, 100.0, build.height);
  fields.number("climb_m", 0.0, 10.0, build.climb);
  fields.number("slope_deg", 0.0, 89.9, build.slope, kDegree);
  fields.number("cell_m", 0.001, 10.0, build.cell);
  fields.number("cell_height_m", 0.001, 10.0, build.cellHeight);
  fields.number("region_min_m2", 0.0, 1e6, build.regionMin);
  fields.number("region_merge_m2", 0.0, 1e6, build.regionMerge);
  fields.number("edge_max_m", 0.0, 1e5, build.edgeMax);
  fields.number("edge_error_m", 0.0, 100.0, build.edgeError);
  fields.number("detail_sample_m", 0.0, 100.0, build.detailSample);
  fields.number("detail_error_m", 0.0, 100.0, build.detailError);
  fields.integer("corners_max", 3, 6, build.cornersMax);
  static constexpr std::string_view kPartitions[] = {"watershed", "monotone", "layers"};
  std::size_t partition = static_cast<std::size_t>(build.partition);
  fields.word("partition", kPartitions, partition);
  build.partition = static_cast<navmesh::Partition>(partition);
  fields.number("tile_m", 0.0, 1e5, build.tile);
  fields.finish();
}

void readSpace(Fields& file, SimulationFile& into) {
  const Json* field = file.find("space");
  if (field == nullptr) return;
  if (field->is_string()) {
    into.space = field->get<std::string>();
    return;
  }
  if (!field->is_object()) return file.wrongKind("space", "the name of a file, or an object {...}");
  Fields fields(*field, "space.", file.problem());
  for (const std::string_view name : {"format", "rectangle", "circle", "polygon", "holes"})
    fields.find(name);
  fields.finish();
  const tl::expected<TrackedSpace, Error> made = spaceFromJson(*field);
  if (made) {
    into.simulation.session.space = *made;
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

void readReset(Fields& file, ResetSettings& reset) {
  const Json* object = file.find("reset");
  if (object == nullptr) return;
  Fields fields(*object, "reset.", file.problem());
  fields.number("reaction_s", 0.0, 10.0, reset.reactionTime);
  fields.number("deceleration_m_per_s2", 0.1, 1e9, reset.deceleration);
  fields.number("clearance_m", 0.0, 100.0, reset.clearance);
  fields.number("warning_s", 0.0, 60.0, reset.warningTime);
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

void readWaypoints(Fields& fields, Waypoints& waypoints) {
  const Json* points = fields.find("waypoints");
  if (points == nullptr || !points->is_array() || points->empty() ||
      points->size() > kMostWaypoints) {
    fields.wrongKind("waypoints",
                     fmt::format("a list of 1 to {} positions [x, y, z]", kMostWaypoints));
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

void readUser(Fields& file, SimulationFile& into) {
  User& user = into.simulation.user;
  const Json* object = file.find("user");
  if (object == nullptr) {
    return file.problem().say(
        ErrorCode::kDataDamaged,
        "user is missing: say who walks, for example {\"kind\": \"wander\"}.");
  }
  Fields fields(*object, "user.", file.problem());
  static constexpr std::string_view kKinds[] = {"waypoints", "wander", "legs", "recorded"};
  std::size_t kind = std::size(kKinds);
  fields.word("kind", kKinds, kind);
  switch (kind) {
    case 0:
      readWaypoints(fields, user.plan.emplace<Waypoints>());
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
      if (into.walks.empty()) fields.wrongKind("walks", "the name of a file with recorded walks");
      break;
    default:
      fields.wrongKind("kind", fmt::format("one of {}", fmt::join(kKinds, ", ")));
  }
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
  fields.finish();
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
  Fields fields(*json, "", problem);
  const Json* format = fields.find("format");
  if (format == nullptr || !format->is_string()) {
    problem.say(ErrorCode::kFormatUnknown,
                fmt::format("\"format\" is missing; this reads \"{}\".", kFormat));
  } else if (format->get_ref<const std::string&>() != kFormat) {
    problem.say(ErrorCode::kFormatUnsupported,
                fmt::format("\"format\" is {}; this reads \"{}\".",
                            inQuotes(format->get_ref<const std::string&>()), kFormat));
  }
  SimulationConfig& simulation = file.simulation;
  SessionSettings& session = simulation.session;
  fields.text("scene", file.scene);
  readImport(fields, file.import);
  readBuild(fields, file.build);
  readSpace(fields, file);
  readLimits(fields, session.limits);
  const std::vector<std::string_view> controllers(controllerNames().begin(),
                                                  controllerNames().end());
  std::size_t controller = static_cast<std::size_t>(
      std::find(controllers.begin(), controllers.end(), session.controller) - controllers.begin());
  fields.word("controller", controllers, controller);
  if (controller < controllers.size()) session.controller = controllers[controller];
  fields.number("horizon_m", 0.1, 1000.0, session.horizon);
  fields.boolean("predict_always", session.alwaysPredict);
  static constexpr std::string_view kMethods[] = {"polygon", "front"};
  std::size_t method = static_cast<std::size_t>(session.method);
  fields.word("method", kMethods, method);
  session.method = static_cast<prediction::Method>(method);
  fields.number("persistence_m", 0.0, 100.0, session.front.persistence);
  fields.number("rate_hz", 5.0, 1000.0, simulation.rate);
  fields.integer("seed", 0, ~std::uint64_t{0}, simulation.seed);
  fields.boolean("resets", session.resets);
  readReset(fields, session.reset);
  readStop(fields, simulation.stop);
  readUser(fields, file);
  readStart(fields, simulation.start);
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return file;
}

}  // namespace forewalk::rdw
