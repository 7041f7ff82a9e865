#include "service/daemon/session_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "navmesh/build/fwmesh.h"
#include "service/files.h"

namespace forewalk::daemon {

namespace {

constexpr std::uint8_t kTokenVersion = 2;
constexpr std::uint8_t kStarted = 1, kWalking = 2, kTurning = 4, kSnapped = 8, kFrozen = 16,
                       kStepsBack = 32;

// Little-endian, as the machine is (message.cpp asserts it).
struct Layout {
  std::uint8_t version;
  std::uint8_t bits;
  std::int8_t direction;
  std::uint8_t instruction;
  std::uint8_t resetsInARow;
  std::int8_t turnsSeen;  // whole turns that the reset under way shows
  std::uint16_t reserved;
  std::uint8_t navMesh[8];
  std::uint64_t sessionId;
  double yaw, offsetX, offsetY, height;           // redirection
  double velocityX, velocityY, heading, seconds;  // motion
  double progress;  // of the reset: radians turned or, kStepsBack, metres left to step back
  double left, right, backward;     // its plan, and the heading of stepping back
  float positionX, positionY;       // of the motion: they were floats before
  float head[7];                    // x y z, x y z w
  float planX, planY, floorHeight;  // where the feet are
  std::uint32_t polygon;
  std::uint32_t resetCount;
};
static_assert(sizeof(Layout) == kStateBytes, "no byte between the fields, and none to spare");

tl::unexpected<Error> refuse(std::string message, ErrorCode code = ErrorCode::kDataDamaged) {
  return tl::unexpected(Error{code, std::move(message)});
}

Layout layoutOf(const TokenState& token, const NavMeshHash& navMesh) {
  const rdw::SessionState& state = token.state;
  const rdw::ResetState& reset = state.reset.state;
  const rdw::ResetPlan& plan = state.reset.plan;
  const bool stepsBack = reset.turning && reset.back > 0.0;  // before anything is turned
  Layout out{};
  out.version = kTokenVersion;
  out.bits = static_cast<std::uint8_t>(
      (state.motion.started ? kStarted : 0) | (state.motion.walking ? kWalking : 0) |
      (reset.turning ? kTurning : 0) | (state.location.snapped ? kSnapped : 0) |
      (state.reset.plan.frozen ? kFrozen : 0) | (stepsBack ? kStepsBack : 0));
  out.direction = static_cast<std::int8_t>(reset.direction);
  out.instruction = static_cast<std::uint8_t>(reset.instruction);
  out.resetsInARow = static_cast<std::uint8_t>(std::min(state.reset.inARow, 255));
  out.turnsSeen = static_cast<std::int8_t>(std::lround(plan.seen / (2.0 * rdw::kPi)));
  std::memcpy(out.navMesh, navMesh.data(), navMesh.size());
  out.sessionId = token.sessionId;
  out.yaw = state.redirection.yaw;
  out.offsetX = state.redirection.offset.x;
  out.offsetY = state.redirection.offset.y;
  out.height = state.redirection.height;
  out.velocityX = state.motion.velocity.x;
  out.velocityY = state.motion.velocity.y;
  out.heading = state.motion.heading;
  out.seconds = state.motion.seconds;
  out.progress = stepsBack ? reset.back : reset.progress;
  out.left = plan.left;
  out.right = plan.right;
  out.backward = state.reset.backward;
  out.positionX = static_cast<float>(state.motion.position.x);
  out.positionY = static_cast<float>(state.motion.position.y);
  const glm::vec3& p = state.physical.position;
  const glm::quat& q = state.physical.orientation;
  const float head[] = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
  std::memcpy(out.head, head, sizeof head);
  out.planX = state.location.plan.x;
  out.planY = state.location.plan.y;
  out.floorHeight = state.location.height;
  out.polygon = static_cast<std::uint32_t>(state.location.polygon);
  out.resetCount = static_cast<std::uint32_t>(state.reset.count);
  return out;
}

TokenState tokenOf(const Layout& in) {
  TokenState token;
  token.sessionId = in.sessionId;
  rdw::SessionState& state = token.state;
  state.redirection = {in.yaw, {in.offsetX, in.offsetY}, in.height};
  state.physical = {{in.head[0], in.head[1], in.head[2]},
                    {in.head[6], in.head[3], in.head[4], in.head[5]}};
  state.location = {navmesh::PolygonId{in.polygon},
                    {in.planX, in.planY},
                    in.floorHeight,
                    (in.bits & kSnapped) != 0};
  state.motion.position = {static_cast<double>(in.positionX), static_cast<double>(in.positionY)};
  state.motion.velocity = {in.velocityX, in.velocityY};
  state.motion.heading = in.heading;
  state.motion.seconds = in.seconds;
  state.motion.started = (in.bits & kStarted) != 0;
  state.motion.walking = (in.bits & kWalking) != 0;
  const bool stepsBack = (in.bits & kStepsBack) != 0;
  rdw::ResetPlan& plan = state.reset.plan;
  plan.left = in.left;
  plan.right = in.right;
  plan.seen = in.turnsSeen * (2.0 * rdw::kPi);
  plan.frozen = (in.bits & kFrozen) != 0;
  plan.back = stepsBack ? in.progress : 0.0;
  state.reset.backward = in.backward;
  rdw::ResetState& reset = state.reset.state;
  if ((in.bits & kTurning) != 0) {
    reset = rdw::Reset::underWay(plan, stepsBack ? 0.0 : in.progress, plan.back);
  }
  reset.direction = in.direction;
  reset.instruction = static_cast<rdw::ResetInstruction>(in.instruction);
  state.reset.count = in.resetCount;
  state.reset.inARow = static_cast<int>(in.resetsInARow);
  return token;
}

}  // namespace

NavMeshHash hashOf(std::span<const std::byte> fwmesh) {
  const std::uint64_t number =
      service::contentHash({reinterpret_cast<const char*>(fwmesh.data()), fwmesh.size()});
  NavMeshHash hash;
  for (std::size_t i = 0; i < hash.size(); ++i) {
    hash[i] = static_cast<std::uint8_t>(number >> (8 * (hash.size() - 1 - i)));
  }
  return hash;
}

NavMeshHash hashOf(const navmesh::NavMesh& navMesh) {
  const std::vector<std::byte> fwmesh = navmesh::saveFwmesh(navMesh);
  return hashOf(std::span<const std::byte>(fwmesh));
}

std::string textOf(const NavMeshHash& hash) {
  std::string text;
  for (const std::uint8_t byte : hash) text += fmt::format("{:02x}", byte);
  return text;
}

std::string stateBytes(const TokenState& state, const NavMeshHash& navMesh) {
  std::string bytes;
  putStateBytes(state, navMesh, bytes);
  return bytes;
}

void putStateBytes(const TokenState& state, const NavMeshHash& navMesh, std::string& bytes) {
  const Layout layout = layoutOf(state, navMesh);
  bytes.assign(reinterpret_cast<const char*>(&layout), kStateBytes);
}

tl::expected<TokenState, Error> stateFromBytes(std::string_view bytes, const NavMeshHash& navMesh) {
  if (bytes.size() != kStateBytes) {
    return refuse(fmt::format("state: {} bytes; a state has {}.", bytes.size(), kStateBytes));
  }
  Layout layout;
  std::memcpy(&layout, bytes.data(), kStateBytes);
  if (layout.version != kTokenVersion ||
      layout.instruction > static_cast<int>(rdw::kLastInstruction)) {
    return refuse(fmt::format("token: version {}; this daemon reads {}. Begin without a token.",
                              layout.version, kTokenVersion),
                  ErrorCode::kFormatUnsupported);
  }
  NavMeshHash theirs;
  std::memcpy(theirs.data(), layout.navMesh, theirs.size());
  if (theirs != navMesh) {
    return refuse(fmt::format("token: of the navmesh {}, this daemon walks in {}. Give both the "
                              "same scene and settings, or begin without a token.",
                              textOf(theirs), textOf(navMesh)),
                  ErrorCode::kFormatUnsupported);
  }
  return tokenOf(layout);
}

}  // namespace forewalk::daemon
