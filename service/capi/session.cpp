#include "rdw/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "navmesh/standing.h"
#include "rdw/frame_flags.h"
#include "service/capi/axes.h"
#include "service/capi/flat_graph.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/status.h"

struct forewalk_session {
  forewalk_session(forewalk::rdw::Session made, forewalk_axes spoken)
      : session(std::move(made)),
        axes(spoken),
        graph(session.world().graph, session.settings().prediction.polygons,
              session.settings().method) {}

  forewalk::rdw::Session session;
  std::vector<forewalk::navmesh::Link> links;
  std::vector<forewalk::navmesh::Standing> standing;
  forewalk_axes axes;
  forewalk::capi::FlatGraph graph;
  bool graphIsThisFrames = false;
};

namespace forewalk::capi {

namespace {

// Bit for bit the same flags, so that a frame can pass them on.
static_assert(FOREWALK_FLAG_FIRST_FRAME == static_cast<int>(rdw::kFirstFrame));
static_assert(FOREWALK_FLAG_TIME_STOOD_STILL == static_cast<int>(rdw::kTimeStoodStill));
static_assert(FOREWALK_FLAG_TIME_RAN_BACKWARDS == static_cast<int>(rdw::kTimeRanBackwards));
static_assert(FOREWALK_FLAG_TIME_GAP == static_cast<int>(rdw::kTimeGap));
static_assert(FOREWALK_FLAG_TRACKING_JUMP == static_cast<int>(rdw::kTrackingJump));
static_assert(FOREWALK_FLAG_POSE_NOT_FINITE == static_cast<int>(rdw::kPoseNotFinite));
static_assert(FOREWALK_FLAG_ORIENTATION_NOT_UNIT == static_cast<int>(rdw::kOrientationNotUnit));
static_assert(FOREWALK_FLAG_ORIENTATION_UNUSABLE == static_cast<int>(rdw::kOrientationUnusable));
static_assert(FOREWALK_FLAG_OUTSIDE_SPACE == static_cast<int>(rdw::kOutsideSpace));
static_assert(FOREWALK_FLAG_BORDER_NEAR == static_cast<int>(rdw::kBorderNear));
static_assert(FOREWALK_FLAG_OFF_NAVMESH == static_cast<int>(rdw::kOffNavMesh));
static_assert(FOREWALK_FLAG_SNAPPED == static_cast<int>(rdw::kSnapped));
static_assert(FOREWALK_FLAG_GROUND_TAKEN == static_cast<int>(rdw::kGroundTaken));
static_assert(FOREWALK_FLAG_GRAPH_LIMIT == static_cast<int>(rdw::kGraphLimit));
static_assert(FOREWALK_INSTRUCTION_NONE == static_cast<int>(rdw::ResetInstruction::kNone));
static_assert(FOREWALK_INSTRUCTION_TURN_AROUND ==
              static_cast<int>(rdw::ResetInstruction::kTurnAround));
static_assert(FOREWALK_INSTRUCTION_KEEP_TURNING ==
              static_cast<int>(rdw::ResetInstruction::kKeepTurning));
static_assert(FOREWALK_INSTRUCTION_WALK_BACK == static_cast<int>(rdw::ResetInstruction::kWalkBack));

static_assert(FOREWALK_INSTRUCTION_STEP_BACK == static_cast<int>(rdw::ResetInstruction::kStepBack));
static_assert(FOREWALK_INSTRUCTION_TURN_LEFT == static_cast<int>(rdw::ResetInstruction::kTurnLeft));
static_assert(FOREWALK_INSTRUCTION_TURN_RIGHT ==
              static_cast<int>(rdw::ResetInstruction::kTurnRight));

static_assert(FOREWALK_METHOD_POLYGON == static_cast<int>(prediction::Method::kPolygon));
static_assert(FOREWALK_METHOD_FRONT == static_cast<int>(prediction::Method::kFront));

constexpr float kDefaultSide = 4.0f;  // of the tracked space, metres

// In the order of their constants.
constexpr std::string_view kControllers[] = {
    "none",   "s2c",        "s2o",       "s2c-predictive", "s2o-predictive", "s2mt",
    "s2mt+c", "zigzag",     "p2r",       "messinger",      "dynamic-apf",    "haptics",
    "arc",    "visibility", "foresight", "mpcred",         "force"};
constexpr std::string_view kResets[] = {
    "two-one-turn", "freeze-turn", "freeze-backup", "r2c", "mr2c", "r2g", "sfr2g", "r2fd", "ahead"};
static_assert(std::size(kControllers) == FOREWALK_CONTROLLER_FORCE + 1);
static_assert(std::size(kResets) == FOREWALK_RESET_AHEAD + 1);
constexpr std::string_view kLimits[] = {"steinicke", "laboratory", "neth", "toolkit"};

forewalk_session_settings defaultSessionSettings() {
  const rdw::SessionSettings ours;
  const rdw::GainLimits& limits = ours.limits;
  forewalk_session_settings settings{};
  settings.struct_size = sizeof settings;
  settings.axes = FOREWALK_AXES_OPENXR;
  settings.controller = FOREWALK_CONTROLLER_S2C_PREDICTIVE;
  settings.limits = FOREWALK_LIMITS_STEINICKE;
  settings.horizon = ours.horizon;
  settings.translation_min = limits.translationMin;
  settings.translation_max = limits.translationMax;
  settings.rotation_min = limits.rotationMin;
  settings.rotation_max = limits.rotationMax;
  settings.curvature_max = limits.curvatureMax;
  settings.bending_min = limits.bendingMin;
  settings.bending_max = limits.bendingMax;
  settings.polygon_limit = ours.prediction.polygons;
  settings.resets = 1;
  settings.always_predict = 1;
  settings.method = static_cast<forewalk_method>(ours.method);
  settings.persistence = ours.front.persistence;
  return settings;
}

tl::unexpected<Error> outOfRange(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

forewalk_status unknownConstant(const char* field, std::int32_t value, int last) {
  return fail(FOREWALK_ERROR_ARGUMENT,
              "forewalk_session_settings: " + std::string(field) + " " + std::to_string(value) +
                  " is no constant of this version (0 to " + std::to_string(last) + ").");
}

// Right and forward are the plan's two axes in every convention; only the unit differs.
glm::dvec2 planFrom(forewalk_axes axes, forewalk_point2 theirs) {
  const double unit = unitsPerMetre(axes);
  return {static_cast<double>(theirs.right) / unit, static_cast<double>(theirs.forward) / unit};
}

tl::expected<rdw::TrackedSpace, Error> spaceOf(const forewalk_session_settings& settings) {
  const forewalk_axes axes = settings.axes;
  if (settings.border_count == 0 && settings.hole_count == 0) {
    const double unit = unitsPerMetre(axes);
    const auto side = [&](float theirs) {
      return theirs == 0.0f ? static_cast<double>(kDefaultSide)
                            : static_cast<double>(theirs) / unit;
    };
    return rdw::TrackedSpace::rectangle(side(settings.width), side(settings.depth));
  }
  if (settings.border_count == 0) {
    return outOfRange(
        "forewalk_session_settings: holes without a border. Give the border's points.");
  }
  std::vector<glm::dvec2> border;
  border.reserve(settings.border_count);
  for (std::size_t i = 0; i < settings.border_count; ++i) {
    border.push_back(planFrom(axes, settings.border[i]));
  }
  std::vector<std::vector<glm::dvec2>> holes(settings.hole_count);
  const forewalk_point2* next = settings.hole_points;
  for (std::size_t hole = 0; hole < settings.hole_count; ++hole) {
    for (std::size_t i = 0; i < settings.hole_sizes[hole]; ++i) {
      holes[hole].push_back(planFrom(axes, *next++));
    }
  }
  return rdw::TrackedSpace::polygon(border, holes);
}

// More corners than TrackedSpace takes are counted, not read.
constexpr std::size_t kMostCorners = 4096;

// FOREWALK_OK, or the refusal of what cannot even be read.
forewalk_status checkForm(const forewalk_session_settings& settings) {
  if (settings.axes < FOREWALK_AXES_OPENXR || settings.axes > FOREWALK_AXES_UNREAL) {
    return unknownConstant("axes", settings.axes, FOREWALK_AXES_UNREAL);
  }
  if (settings.controller < FOREWALK_CONTROLLER_NONE ||
      settings.controller > FOREWALK_CONTROLLER_FORCE) {
    return unknownConstant("controller", settings.controller, FOREWALK_CONTROLLER_FORCE);
  }
  if (settings.reset < FOREWALK_RESET_TWO_ONE_TURN || settings.reset > FOREWALK_RESET_AHEAD) {
    return unknownConstant("reset", settings.reset, FOREWALK_RESET_AHEAD);
  }
  if (settings.limits < FOREWALK_LIMITS_STEINICKE || settings.limits > FOREWALK_LIMITS_CUSTOM) {
    return unknownConstant("limits", settings.limits, FOREWALK_LIMITS_CUSTOM);
  }
  if (settings.method < FOREWALK_METHOD_POLYGON || settings.method > FOREWALK_METHOD_FRONT) {
    return unknownConstant("method", settings.method, FOREWALK_METHOD_FRONT);
  }
  if ((settings.border == nullptr && settings.border_count > 0) ||
      ((settings.hole_points == nullptr || settings.hole_sizes == nullptr) &&
       settings.hole_count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_settings: border, hole_points or hole_sizes is null while "
                       "its count is not 0.");
  }
  std::size_t corners = settings.border_count;
  for (std::size_t i = 0; corners <= kMostCorners && i < settings.hole_count; ++i) {
    // A hole of no points cannot be; counted as one, a wild hole_count ends here, too.
    corners += std::max<std::size_t>(1, std::min(settings.hole_sizes[i], kMostCorners + 1));
  }
  if (corners > kMostCorners) {
    return fail(FOREWALK_ERROR_TOO_LARGE,
                "forewalk_session_settings: the tracked space has more than " +
                    std::to_string(kMostCorners) + " points. Simplify it.");
  }
  return FOREWALK_OK;
}

rdw::GainLimits limitsOf(const forewalk_session_settings& settings) {
  if (settings.limits != FOREWALK_LIMITS_CUSTOM) {
    return rdw::gainLimitsByName(kLimits[settings.limits]).value();
  }
  return {.translationMin = settings.translation_min,
          .translationMax = settings.translation_max,
          .rotationMin = settings.rotation_min,
          .rotationMax = settings.rotation_max,
          .curvatureMax = settings.curvature_max,
          .bendingMin = settings.bending_min,
          .bendingMax = settings.bending_max};
}

rdw::VirtualStart startFrom(forewalk_axes axes, forewalk_vec3 floor, float heading) {
  return {positionFrom(axes, floor), angleSign(axes) * heading};
}

// Settings whose form is sound.
tl::expected<rdw::Session, Error> makeSession(const forewalk_navmesh& navmesh,
                                              const forewalk_session_settings& settings) {
  auto space = spaceOf(settings);
  if (!space) return tl::unexpected(space.error());
  rdw::SessionSettings ours;
  ours.space = std::move(*space);
  ours.limits = limitsOf(settings);
  ours.controller = kControllers[settings.controller];
  ours.horizon = settings.horizon;
  ours.alwaysPredict = settings.always_predict != 0;
  if (settings.has_start != 0) {
    ours.start = startFrom(settings.axes, settings.start_floor, settings.start_heading);
  }
  ours.prediction.polygons = settings.polygon_limit;
  ours.resets = settings.resets != 0;
  ours.resetPolicy = kResets[settings.reset];
  ours.method = static_cast<prediction::Method>(settings.method);
  ours.front.persistence = settings.persistence;
  if (ours.method == prediction::Method::kFront) ours.frontIndex = navmesh.frontIndex();
  return rdw::Session::make(navmesh.world, std::move(ours));
}

using Clock = std::chrono::steady_clock;

float secondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<float>(to - from).count();
}

forewalk_frame_out frameOut(forewalk_axes axes, const rdw::FrameResult& result) {
  const float sign = angleSign(axes);
  const glm::vec2 push(result.injectedTranslation);
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  out.flags = result.flags;
  out.virtual_pose = poseTo(axes, result.virtualPose);
  out.translation = result.gains.translation;
  out.rotation = result.gains.rotation;
  out.curvature = sign * result.gains.curvature;
  out.bending = result.gains.bending;
  out.injected_yaw = sign * static_cast<float>(result.injectedYaw);
  out.injected_translation = positionTo(axes, navmesh::toSpace(push, 0.0f));
  out.resetting = result.reset.turning ? 1 : 0;
  out.instruction = static_cast<forewalk_instruction>(result.reset.instruction);
  out.reset_remaining = static_cast<float>(result.reset.remaining);
  out.reset_turned = sign * static_cast<float>(result.reset.progress);
  out.reset_count = static_cast<std::uint32_t>(result.resetCount);
  out.graph_nodes =
      result.graph == nullptr ? 0 : static_cast<std::uint32_t>(result.graph->nodes.size());
  return out;
}

/// Graphs by fronts know the states by their index, so that the world is entered again.
void setStates(rdw::Session& session, std::shared_ptr<const navmesh::PolygonStates> states) {
  const rdw::SessionSettings& settings = session.settings();
  if (settings.method != prediction::Method::kFront) {
    session.setStates(states);
    return;
  }
  rdw::PreparedWorld next = rdw::prepareWorld(session.sharedWorld(), settings.prediction,
                                              settings.method, nullptr, std::move(states));
  session.enter(next);
}

/// What is known of a world beside its floor. With `groundless`, links whose ground has gone lead
/// nowhere.
tl::expected<std::shared_ptr<const navmesh::PolygonStates>, Error> statesOf(
    const navmesh::World& world, const std::vector<navmesh::Link>& list,
    const std::vector<navmesh::Standing>& standing, std::vector<navmesh::LinkId>* groundless) {
  auto links = navmesh::makeLinks(world.graph, world.locations, list, groundless);
  if (!links) return tl::unexpected(links.error());
  std::vector<navmesh::PolygonCost> blocked;
  for (const navmesh::Standing& one : standing) {
    navmesh::blockedBy(world.graph, world.locations, one, blocked);
  }
  auto states = navmesh::makePolygonStates(world.graph, {}, std::move(*links), blocked);
  if (!states) return tl::unexpected(states.error());
  return std::make_shared<const navmesh::PolygonStates>(std::move(*states));
}

}  // namespace

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_session_settings_init(forewalk_session_settings* settings) {
  if (settings != nullptr) *settings = defaultSessionSettings();
}

forewalk_status forewalk_session_create(const forewalk_navmesh* navmesh,
                                        const forewalk_session_settings* settings,
                                        forewalk_session** session) {
  if (session != nullptr) *session = nullptr;
  if (navmesh == nullptr || session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_create: navmesh or session is null.");
  }
  return guarded([&]() -> forewalk_status {
    forewalk_session_settings known = defaultSessionSettings();
    if (settings != nullptr) {
      if (!isKnownSize<forewalk_session_settings>(settings->struct_size)) {
        return fail(FOREWALK_ERROR_ARGUMENT,
                    "forewalk_session_settings: no version has had a struct_size of " +
                        std::to_string(settings->struct_size) +
                        " bytes. Call forewalk_session_settings_init first.");
      }
      copyKnown(*settings, known);
    }
    if (const forewalk_status status = checkForm(known)) return status;
    auto made = makeSession(*navmesh, known);
    if (!made) return fail(made.error());
    *session = new forewalk_session(std::move(*made), known.axes);
    return FOREWALK_OK;
  });
}

void forewalk_session_destroy(forewalk_session* session) { delete session; }

forewalk_status forewalk_frame(forewalk_session* session, forewalk_vec3 head_position,
                               forewalk_quat head_orientation, double seconds,
                               forewalk_frame_out* out) {
  // Literals only: a frame allocates nothing, not even to complain.
  if (session == nullptr || out == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_frame: session or out is null.");
  }
  if (!isKnownSize<forewalk_frame_out>(out->struct_size)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_frame: no version has had out's struct_size. Set it to "
                       "sizeof(forewalk_frame_out).");
  }
  return guarded([&]() -> forewalk_status {
    session->graphIsThisFrames = false;
    const Clock::time_point start = Clock::now();
    session->session.locate(poseFrom(session->axes, {head_position, head_orientation}), seconds);
    session->session.predict();
    const Clock::time_point predicted = Clock::now();
    const rdw::FrameResult& result = session->session.steer();
    forewalk_frame_out answer = frameOut(session->axes, result);
    answer.predict_seconds = secondsBetween(start, predicted);
    answer.steer_seconds = secondsBetween(predicted, Clock::now());
    copyKnown(answer, *out);
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_session_teleport(forewalk_session* session, forewalk_vec3 floor,
                                          float heading) {
  if (session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_session_teleport: session is null.");
  }
  return guarded([&]() -> forewalk_status {
    if (!std::isfinite(heading)) {
      return failLiteral(FOREWALK_ERROR_SETTING_OUT_OF_RANGE,
                         "forewalk_session_teleport: the heading is not a finite number.");
    }
    if (session->session.teleport(startFrom(session->axes, floor, heading))) return FOREWALK_OK;
    return fail(FOREWALK_ERROR_POSITION_OFF_NAVMESH,
                "forewalk_session_teleport: (" + std::to_string(floor.x) + ", " +
                    std::to_string(floor.y) + ", " + std::to_string(floor.z) +
                    ") is not within 0.5 m of a walkable floor. Give a point on the floor.");
  });
}

forewalk_status forewalk_session_set_links(forewalk_session* session, const forewalk_link* links,
                                           size_t count) {
  if (session == nullptr || (links == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_set_links: session or links is null.");
  }
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::Link> list;
    for (size_t i = 0; i < count; ++i) {
      const forewalk_link& one = links[i];
      list.push_back({navmesh::LinkId{one.id}, positionFrom(session->axes, one.entry),
                      positionFrom(session->axes, one.exit), one.length, one.both_ways != 0,
                      one.closed == 0});
    }
    const navmesh::World& world = session->session.world();
    auto states = statesOf(world, list, session->standing, nullptr);
    if (!states) return fail(states.error());
    session->links = std::move(list);
    setStates(session->session, std::move(*states));
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_session_set_standing(forewalk_session* session,
                                              const forewalk_standing* standing, size_t count) {
  if (session == nullptr || (standing == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_set_standing: session or standing is null.");
  }
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::Standing> people;
    for (size_t i = 0; i < count; ++i) {
      const float cost = standing[i].cost == 0.0f ? navmesh::kClosed : standing[i].cost;
      people.push_back({positionFrom(session->axes, standing[i].foot), standing[i].radius, cost});
      if (auto valid = navmesh::validate(people.back()); !valid) return fail(valid.error());
    }
    std::vector<navmesh::LinkId> groundless;
    auto states = statesOf(session->session.world(), session->links, people, &groundless);
    if (!states) return fail(states.error());
    session->standing = std::move(people);
    setStates(session->session, std::move(*states));
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_session_enter(forewalk_session* session, const forewalk_navmesh* navmesh) {
  if (session == nullptr || navmesh == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_enter: session or navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    const rdw::SessionSettings& settings = session->session.settings();
    const bool byFronts = settings.method == prediction::Method::kFront;
    std::vector<navmesh::LinkId> groundless;
    auto states = statesOf(*navmesh->world, session->links, session->standing, &groundless);
    if (!states) return fail(states.error());
    rdw::PreparedWorld next = rdw::prepareWorld(
        navmesh->world, settings.prediction, settings.method,
        byFronts && (*states)->allOpen() ? navmesh->frontIndex() : nullptr, *states);
    FlatGraph graph(navmesh->world->graph, settings.prediction.polygons, settings.method);
    session->session.enter(next);
    session->graph = std::move(graph);
    session->graphIsThisFrames = false;
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_graph(forewalk_session* session, forewalk_graph_view* view) {
  if (session == nullptr || view == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_graph: session or view is null.");
  }
  if (!isKnownSize<forewalk_graph_view>(view->struct_size)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_graph: no version has had the view's struct_size. Set it to "
                       "sizeof(forewalk_graph_view).");
  }
  return guarded([&]() -> forewalk_status {
    if (!session->graphIsThisFrames) {
      const prediction::PredictionGraph* graph = session->session.result().graph;
      session->graph.clear();
      if (graph != nullptr) {
        session->graph.flatten(session->session.world().graph, *graph, session->axes);
      }
      session->graphIsThisFrames = true;
    }
    copyKnown(session->graph.view(), *view);
    return FOREWALK_OK;
  });
}

}  // extern "C"
