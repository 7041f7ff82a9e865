#include "rdw/session.h"

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "rdw/frame_flags.h"
#include "service/capi/axes.h"
#include "service/capi/log.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/session_handle.h"
#include "service/capi/session_settings.h"
#include "service/capi/status.h"

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

using Clock = std::chrono::steady_clock;

float secondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<float>(to - from).count();
}

forewalk_reset_phase phaseOf(const rdw::FrameResult& result) {
  const rdw::ResetState& reset = result.reset;
  if (reset.turning && reset.back > 0.0) return FOREWALK_RESET_PHASE_BACKWARD;
  if (reset.turning) {
    return reset.direction == 0 ? FOREWALK_RESET_PHASE_TURN : FOREWALK_RESET_PHASE_TURNING;
  }
  if (reset.instruction == rdw::ResetInstruction::kWalkBack) return FOREWALK_RESET_PHASE_OUTSIDE;
  if ((result.flags & rdw::kBorderNear) != 0) return FOREWALK_RESET_PHASE_NEAR;
  return FOREWALK_RESET_PHASE_NONE;
}

// Where the head will look when it has turned what remains, the way that was begun or is asked for.
forewalk_vec3 resetDirection(forewalk_axes axes, const rdw::FrameResult& result) {
  const rdw::ResetState& reset = result.reset;
  if (!reset.turning) return {};
  const bool left = reset.wanted != 0 ? reset.wanted > 0 : reset.progress >= 0.0;
  const double heading = result.physical.heading + (left ? reset.remaining : -reset.remaining);
  const glm::vec3 ours = navmesh::toSpace(glm::vec2(rdw::directionOf(heading)), 0.0f);
  const forewalk_vec3 theirs = positionTo(axes, ours);
  const float unit = unitsPerMetre(axes);
  return {theirs.x / unit, theirs.y / unit, theirs.z / unit};
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
  out.reset_phase = phaseOf(result);
  out.reset_back = static_cast<float>(result.reset.back);
  out.reset_direction = resetDirection(axes, result);
  return out;
}

// What the others in the room see of this frame, in their next one.
void showOthers(forewalk_session& session, const rdw::FrameResult& result) {
  const rdw::Motion& motion = result.motion;
  session.member.put(result.physical.position, motion.walkingDirection * motion.speed,
                     rdw::directionOf(result.physical.heading));
}

void seeOthers(forewalk_session& session) {
  std::array<rdw::OtherUser, SharedPlaces::kMost> others;
  session.session.setOthers({others.data(), session.member.others(others)});
}

constexpr struct {
  std::uint32_t flag;
  const char* what;
} kWorthAWarning[] = {
    {rdw::kTimeRanBackwards, "its time ran backwards, or was no number"},
    {rdw::kTimeGap, "more than 0.5 s passed since its last frame"},
    {rdw::kTrackingJump, "tracking jumped by more than 1 m"},
    {rdw::kPoseNotFinite, "a position was not finite: the last one was taken"},
    {rdw::kOrientationUnusable, "an orientation was no rotation: the last one was taken"},
    {rdw::kOffNavMesh, "there is no walkable floor near: the last place was taken"},
    {rdw::kGraphLimit, "the graph has reached polygon_limit: raise it or shorten the horizon"},
    {rdw::kGroundTaken, "the world changed where the user stands: the nearest floor was taken"}};

void logFrame(forewalk_session& session, const rdw::FrameResult& result, bool wasTurning) {
  if (!logs(FOREWALK_LOG_WARNING)) return;
  for (const auto& [flag, what] : kWorthAWarning) {
    if ((result.flags & ~session.flags & flag) == 0) continue;
    tell(FOREWALK_LOG_WARNING, "session {}: {}.", session.number, what);
  }
  if (result.resetBegan) {
    tell(FOREWALK_LOG_INFO, "session {}: reset {} begins.", session.number, result.resetCount);
  } else if (wasTurning && !result.reset.turning) {
    tell(FOREWALK_LOG_INFO, "session {}: reset {} ends.", session.number, result.resetCount);
  }
}

std::optional<glm::vec3> directionFrom(forewalk_axes axes, const forewalk_vec3* direction) {
  if (direction == nullptr) return std::nullopt;
  return positionFrom(axes, *direction);
}

double headingOf(const std::optional<glm::vec3>& direction) {
  return direction ? rdw::headingOf(*direction) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

forewalk_status createSession(std::shared_ptr<const navmesh::World> world,
                              const forewalk_session_settings& settings, rdw::SessionSettings ours,
                              forewalk_session** session) {
  SpaceMember member;
  if (settings.space != nullptr) {
    const auto place = settings.space->places.take();
    if (!place) {
      return failLiteral(FOREWALK_ERROR_TOO_LARGE,
                         "forewalk_session_settings: the space has as many sessions as its "
                         "user_limit. Destroy one, or make the space with a higher limit.");
    }
    member = SpaceMember(*settings.space, *place);
  }
  auto made = rdw::Session::make(std::move(world), std::move(ours));
  if (!made) return fail(made.error());
  *session = new forewalk_session(std::move(*made), settings.axes);
  (*session)->member = std::move(member);
  tell(FOREWALK_LOG_INFO, "session {}: made, with controller {} and a horizon of {} m.",
       (*session)->number, controllerName(settings.controller), settings.horizon);
  return FOREWALK_OK;
}

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_session_settings_init(forewalk_session_settings* settings, uint32_t struct_size) {
  initKnown(defaultSessionSettings(), settings, struct_size);
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
    forewalk_session_settings known;
    rdw::SessionSettings ours;
    if (const auto status = readSession(settings, known, ours)) return status;
    if (ours.method == prediction::Method::kFront) ours.frontIndex = navmesh->frontIndex();
    if (const auto status = createSession(navmesh->world, known, std::move(ours), session)) {
      return status;
    }
    (*session)->scene = navmesh->scene;
    (*session)->groundHash = navmesh->hash;
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
    const bool wasTurning = session->session.result().reset.turning;
    if (session->follows && session->follows->update(session->session) && session->recorder) {
      session->recorder->worldChange();
    }
    if (session->member) seeOthers(*session);
    const rdw::HeadPose head = poseFrom(session->axes, {head_position, head_orientation});
    session->session.locate(head, seconds);
    session->session.predict();
    const Clock::time_point predicted = Clock::now();
    const rdw::FrameResult& result = session->session.steer();
    if (session->member) showOthers(*session, result);
    logFrame(*session, result, wasTurning);
    if (session->recorder) session->recorder->frame(*session, head, seconds);
    session->flags = result.flags;
    session->framed = true;
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
    const rdw::VirtualStart to = startFrom(session->axes, floor, heading);
    if (session->session.teleport(to)) {
      if (session->recorder) session->recorder->teleport(to);
      return FOREWALK_OK;
    }
    return fail(FOREWALK_ERROR_POSITION_OFF_NAVMESH,
                "forewalk_session_teleport: (" + std::to_string(floor.x) + ", " +
                    std::to_string(floor.y) + ", " + std::to_string(floor.z) +
                    ") is not within 0.5 m of a walkable floor. Give a point on the floor.");
  });
}

forewalk_status forewalk_session_set_gaze(forewalk_session* session,
                                          const forewalk_vec3* direction) {
  if (session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_session_set_gaze: session is null.");
  }
  session->gaze = directionFrom(session->axes, direction);
  session->session.setGaze(headingOf(session->gaze));
  return FOREWALK_OK;
}

forewalk_status forewalk_session_set_chest(forewalk_session* session,
                                           const forewalk_vec3* direction) {
  if (session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_session_set_chest: session is null.");
  }
  session->chest = directionFrom(session->axes, direction);
  session->session.setChest(headingOf(session->chest));
  return FOREWALK_OK;
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
        if (const auto* likelihood = session->session.likelihood()) {
          session->graph.addWays(*likelihood);
        }
      }
      session->graphIsThisFrames = true;
    }
    copyKnown(session->graph.view(), *view);
    return FOREWALK_OK;
  });
}

}  // extern "C"
