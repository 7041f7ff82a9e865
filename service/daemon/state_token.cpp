#include "service/daemon/state_token.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "navmesh/build/fwmesh.h"

namespace forewalk::daemon {
namespace {

constexpr std::uint8_t kTokenVersion = 2;
constexpr std::size_t kMacBytes = 16;
constexpr std::size_t kDigestBytes = 32;
constexpr std::size_t kStateBytes = kTokenBytes - kMacBytes;

constexpr std::uint8_t kStarted = 1, kWalking = 2, kTurning = 4, kSnapped = 8, kFrozen = 16,
                       kStepsBack = 32;

// Little-endian, as the machine is (message.cpp asserts it).
struct Layout {
  std::uint8_t version;
  std::uint8_t bits;
  std::int8_t direction;
  std::uint8_t instruction;
  std::uint8_t resetsSinceWalk;
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
  out.resetsSinceWalk = static_cast<std::uint8_t>(std::min(state.reset.sinceWalk, 255));
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
  state.reset.sinceWalk = static_cast<int>(in.resetsSinceWalk);
  return token;
}

void require(bool works) {
  if (!works) throw std::runtime_error("the cryptography library (OpenSSL) does not work");
}

}  // namespace

NavMeshHash hashOf(const navmesh::NavMesh& navMesh) {
  const std::vector<std::byte> bytes = navmesh::saveFwmesh(navMesh);
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
  NavMeshHash hash;
  std::memcpy(hash.data(), digest, hash.size());
  return hash;
}

std::string textOf(const NavMeshHash& hash) {
  std::string text;
  for (const std::uint8_t byte : hash) text += fmt::format("{:02x}", byte);
  return text;
}

struct TokenSigner::Mac {
  explicit Mac(std::string_view key) {
    const char* digest = "SHA256";
    const OSSL_PARAM parameters[] = {
        OSSL_PARAM_construct_utf8_string("digest", const_cast<char*>(digest), 0),
        OSSL_PARAM_construct_end()};
    require(algorithm != nullptr && context != nullptr);
    require(EVP_MAC_init(context, reinterpret_cast<const unsigned char*>(key.data()), key.size(),
                         parameters) == 1);
  }
  Mac(const Mac&) = delete;
  Mac& operator=(const Mac&) = delete;
  ~Mac() {
    EVP_MAC_CTX_free(context);
    EVP_MAC_free(algorithm);
  }

  /// Over the first kStateBytes of `bytes`.
  void of(const char* bytes, unsigned char (&mac)[kDigestBytes]) {
    std::size_t size = 0;
    // Without a key: again with the one before, which is worked in already.
    require(EVP_MAC_init(context, nullptr, 0, nullptr) == 1);
    require(EVP_MAC_update(context, reinterpret_cast<const unsigned char*>(bytes), kStateBytes) ==
            1);
    require(EVP_MAC_final(context, mac, &size, kDigestBytes) == 1 && size == kDigestBytes);
  }

  EVP_MAC* algorithm = EVP_MAC_fetch(nullptr, "HMAC", nullptr);
  EVP_MAC_CTX* context = EVP_MAC_CTX_new(algorithm);
};

TokenSigner::TokenSigner(std::string_view key, const NavMeshHash& navMesh)
    : mac_(std::make_unique<Mac>(key)), navMesh_(navMesh) {}
TokenSigner::TokenSigner(TokenSigner&&) noexcept = default;
TokenSigner::~TokenSigner() = default;

void TokenSigner::sign(const TokenState& state, std::string& token) {
  const Layout layout = layoutOf(state, navMesh_);
  token.assign(reinterpret_cast<const char*>(&layout), kStateBytes);
  unsigned char mac[kDigestBytes];
  mac_->of(token.data(), mac);
  token.append(reinterpret_cast<const char*>(mac), kMacBytes);
}

tl::expected<TokenState, Error> TokenSigner::open(std::string_view token) {
  if (token.size() != kTokenBytes) {
    return refuse(fmt::format("token: {} bytes; a token has {}. Begin without one.", token.size(),
                              kTokenBytes));
  }
  unsigned char mac[kDigestBytes];
  mac_->of(token.data(), mac);
  if (CRYPTO_memcmp(mac, token.data() + kStateBytes, kMacBytes) != 0) {
    return refuse(
        "token: not signed with this daemon's key. Give daemons that share sessions one key "
        "(--key-file), or begin without a token.");
  }
  return stateFromBytes(token.substr(0, kStateBytes), navMesh_);
}

std::string stateBytes(const TokenState& state, const NavMeshHash& navMesh) {
  const Layout layout = layoutOf(state, navMesh);
  return {reinterpret_cast<const char*>(&layout), kStateBytes};
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

std::string randomBytes(std::size_t count) {
  std::string bytes(count, '\0');
  require(RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(count)) == 1);
  return bytes;
}

bool equalInConstantTime(std::string_view given, std::string_view secret) {
  const auto digestOf = [](std::string_view text, unsigned char* digest) {
    SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  };
  unsigned char a[SHA256_DIGEST_LENGTH], b[SHA256_DIGEST_LENGTH];
  digestOf(given, a);
  digestOf(secret, b);
  return CRYPTO_memcmp(a, b, sizeof a) == 0;
}

}  // namespace forewalk::daemon
