// Messages and state tokens: there and back, and nothing else accepted.
#include "service/daemon/message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "navmesh/random.h"
#include "service/daemon/access.h"
#include "service/daemon/metrics.h"
#include "service/daemon/replay.h"
#include "service/daemon/state_token.h"

namespace forewalk::daemon {
namespace {

constexpr std::string_view kKey = "0123456789abcdef0123456789abcdef";
constexpr NavMeshHash kNavMesh{1, 2, 3, 4, 5, 6, 7, 8};

float anyFloat(std::mt19937_64& random) {
  while (true) {
    const auto bits = static_cast<std::uint32_t>(random());
    float value;
    std::memcpy(&value, &bits, sizeof value);
    if (std::isfinite(value)) return value;
  }
}

Frame anyFrame(std::mt19937_64& random) {
  Frame frame;
  frame.sequence = static_cast<std::uint32_t>(random());
  frame.seconds = static_cast<double>(anyFloat(random)) / 3.0;
  frame.head.position = {anyFloat(random), anyFloat(random), anyFloat(random)};
  frame.head.orientation = {anyFloat(random), anyFloat(random), anyFloat(random), anyFloat(random)};
  return frame;
}

bool same(const Frame& a, const Frame& b) {
  const auto sameOther = [](const rdw::OtherUser& one, const rdw::OtherUser& two) {
    return one.position == two.position && one.velocity == two.velocity &&
           one.facing == two.facing && one.radius == two.radius;
  };
  if (!std::equal(a.others.begin(), a.others.end(), b.others.begin(), b.others.end(), sameOther))
    return false;
  return a.gaze == b.gaze && a.chest == b.chest && a.sequence == b.sequence &&
         a.seconds == b.seconds && a.head.position == b.head.position &&
         a.head.orientation == b.head.orientation;
}

TEST(DaemonMessage, ReadsWhatItWroteToTheLastBit) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Frame frame = anyFrame(random);
    const auto fromBytes = parseFrame(frameBytes(frame), false);
    ASSERT_TRUE(fromBytes);
    EXPECT_TRUE(same(*fromBytes, frame));
    Frame more = frame;
    if (i % 2 == 0) more.gaze = {anyFloat(random), anyFloat(random), anyFloat(random)};
    if (i % 3 == 0) more.chest = {anyFloat(random), anyFloat(random), anyFloat(random)};
    const auto real = [&] { return static_cast<double>(anyFloat(random)) / 7.0; };
    for (int other = 0; other < i % 5; ++other) {
      more.others.push_back(
          {{real(), real()}, {real(), real()}, {real(), real()}, 0.1 + std::abs(real())});
    }
    const auto withMore = parseFrame(frameText(more), true);
    ASSERT_TRUE(withMore) << withMore.error().message;
    EXPECT_TRUE(same(*withMore, more)) << frameText(more);
    const auto fromText = parseFrame(frameText(frame), true);
    ASSERT_TRUE(fromText) << fromText.error().message;
    EXPECT_TRUE(same(*fromText, frame)) << frameText(frame);
  }
}

TEST(DaemonMessage, SaysTheSameInBothForms) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 500; ++i) {
    Answer answer;
    answer.sequence = static_cast<std::uint32_t>(random());
    answer.flags = static_cast<std::uint32_t>(random());
    answer.position = {anyFloat(random), anyFloat(random), anyFloat(random)};
    answer.orientation = {anyFloat(random), anyFloat(random), anyFloat(random), anyFloat(random)};
    answer.gains = {anyFloat(random), anyFloat(random), anyFloat(random), anyFloat(random)};
    answer.injectedYaw = anyFloat(random);
    answer.injectedTranslation = {anyFloat(random), anyFloat(random)};
    answer.resetting = i % 2 == 0;
    answer.instruction = static_cast<rdw::ResetInstruction>(i % 7);
    answer.resetRemaining = anyFloat(random);
    answer.resetTurned = anyFloat(random);
    answer.resetCount = static_cast<std::uint32_t>(random());
    answer.graphNodes = static_cast<std::uint32_t>(random());
    const std::string token(static_cast<std::size_t>(i % 190), 'x');
    std::string bytes, text;
    appendAnswerBytes(answer, token, bytes);
    EXPECT_EQ(bytes.size(), kAnswerBytes + token.size());
    const auto read = parseAnswerBytes(bytes);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->answer, answer);
    EXPECT_EQ(read->token, token);
    appendAnswerText(answer, token, {}, text);
    const auto json = nlohmann::json::parse(text);
    EXPECT_EQ(json["sequence"], answer.sequence);
    EXPECT_EQ(json["flags"], answer.flags);
    EXPECT_EQ(static_cast<float>(json["position"][2].get<double>()), answer.position.z);
    EXPECT_EQ(static_cast<float>(json["orientation"][3].get<double>()), answer.orientation.w);
    EXPECT_EQ(static_cast<float>(json["gains"]["curvature"].get<double>()), answer.gains.curvature);
    EXPECT_EQ(static_cast<float>(json["injected_translation"][2].get<double>()),
              answer.injectedTranslation.y);
    EXPECT_EQ(json["reset"]["turning"], answer.resetting);
    EXPECT_EQ(json["reset"]["count"], answer.resetCount);
    constexpr const char* kNames[] = {"none",      "turn_around", "keep_turning", "walk_back",
                                      "step_back", "turn_left",   "turn_right"};
    EXPECT_EQ(json["reset"]["instruction"], kNames[i % 7]);
    EXPECT_EQ(fromBase64Url(json.value("token", "")).value(), token);
  }
}

TEST(DaemonMessage, SaysSettingsSoThatTheyAreReadBack) {
  rdw::SessionSettings settings;
  const std::vector<glm::dvec2> border = {{0.1, 0.2}, {5.3, 0.0}, {4.9, 6.1}, {-0.4, 3.0}};
  const std::vector<std::vector<glm::dvec2>> holes = {{{1.1, 1.2}, {2.0, 1.0}, {1.7, 2.3}}};
  for (const bool polygon : {false, true}) {
    settings.space = polygon ? *rdw::TrackedSpace::polygon(border, holes)
                             : *rdw::TrackedSpace::rectangle(4.1, 6.3);
    settings.limits = rdw::gainLimitsByName("toolkit").value();
    settings.limits.curvatureMax = 0.123456789f;
    settings.controller = "foresight";
    settings.resetPolicy = "sfr2g";
    settings.horizon = 7.7f;
    settings.alwaysPredict = polygon;
    settings.prediction.polygons = 77;
    settings.method = polygon ? prediction::Method::kFront : prediction::Method::kPolygon;
    settings.front.persistence = 0.3f;
    settings.heading = rdw::HeadingSource::kWalking;
    settings.resets = polygon;
    settings.reset.reactionTime = 0.123;
    settings.reset.deceleration = 2.7;
    settings.reset.clearance = 0.31;
    settings.reset.warningTime = 0.9;
    settings.reset.trigger = polygon ? rdw::ResetTrigger::kBorder : rdw::ResetTrigger::kAhead;
    const auto read = parseSettings(settingsText(settings));
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->space.ringCount(), settings.space.ringCount());
    for (std::size_t ring = 0; ring < read->space.ringCount(); ++ring) {
      EXPECT_TRUE(std::ranges::equal(read->space.ring(ring), settings.space.ring(ring)));
    }
    EXPECT_EQ(read->limits, settings.limits);
    EXPECT_EQ(read->controller, settings.controller);
    EXPECT_EQ(read->resetPolicy, settings.resetPolicy);
    EXPECT_EQ(read->horizon, settings.horizon);
    EXPECT_EQ(read->alwaysPredict, settings.alwaysPredict);
    EXPECT_EQ(read->prediction.polygons, settings.prediction.polygons);
    EXPECT_EQ(read->method, settings.method);
    EXPECT_EQ(read->front.persistence, settings.front.persistence);
    EXPECT_EQ(read->heading, settings.heading);
    EXPECT_EQ(read->resets, settings.resets);
    EXPECT_EQ(read->reset.reactionTime, settings.reset.reactionTime);
    EXPECT_EQ(read->reset.deceleration, settings.reset.deceleration);
    EXPECT_EQ(read->reset.clearance, settings.reset.clearance);
    EXPECT_EQ(read->reset.warningTime, settings.reset.warningTime);
    EXPECT_EQ(read->reset.trigger, settings.reset.trigger);
    EXPECT_EQ(settingsText(*read), settingsText(settings));
  }
}

TEST(DaemonMessage, KeepsTheSignOfZero) {
  Frame frame;
  frame.head.position = {-0.0f, 0.0f, -0.0f};
  frame.seconds = -0.0;
  const auto read = parseFrame(frameText(frame), true);
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::signbit(read->head.position.x));
  EXPECT_FALSE(std::signbit(read->head.position.y));
  EXPECT_TRUE(std::signbit(read->head.position.z));
  EXPECT_TRUE(std::signbit(read->seconds));
}

TEST(DaemonMessage, TakesLostNumbersForNull) {
  Frame frame;
  frame.head.position.x = std::numeric_limits<float>::quiet_NaN();
  frame.seconds = std::numeric_limits<double>::infinity();
  const auto read = parseFrame(frameText(frame), true);
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::isnan(read->head.position.x));
  EXPECT_FALSE(std::isfinite(read->seconds));
}

TEST(DaemonMessage, RefusesWhatIsNotTheSchema) {
  const auto refused = [](std::string_view text, bool isText, std::string_view saying) {
    const auto read = parseFrame(text, isText);
    EXPECT_FALSE(read) << text;
    if (read) return;
    EXPECT_NE(read.error().message.find(saying), std::string::npos) << read.error().message;
  };
  refused("", true, "frame");
  refused("[]", true, "object");
  refused("{", true, "frame:1: not valid JSON");
  refused(R"({"seconds":0,"position":[0,0,0],"orientation":[0,0,0]})", true, "4 numbers");
  refused(R"({"seconds":0,"position":"here","orientation":[0,0,0,1]})", true, "position");
  refused(R"({"position":[0,0,0],"orientation":[0,0,0,1]})", true, "seconds");
  refused(R"({"seconds":0,"position":[0,0,0],"orientation":[0,0,0,1],"poistion":1})", true,
          "poistion");
  refused(R"({"sequence":-1,"seconds":0,"position":[0,0,0],"orientation":[0,0,0,1]})", true,
          "sequence");
  const std::string sound = frameBytes({});
  for (std::size_t size = 0; size < sound.size(); ++size) {
    refused(sound.substr(0, size), false, "44");
  }
  refused(sound + "x", false, "45 bytes");
  std::string other = sound;
  other[0] = 2;
  refused(other, false, "version 2");
  other = sound;
  other[1] = 2;
  refused(other, false, "kind 2");
}

TEST(DaemonMessage, ReadsHellos) {
  const auto hello = parseHello(
      R"({"format":"forewalk.hello/1","token":"abc","session":{"controller":"s2o","horizon_m":7,)"
      R"("space":{"rectangle":[5,6]},"limits":"laboratory","resets":false,)"
      R"("start":{"position":[1,2,3],"heading_deg":90}}})");
  ASSERT_TRUE(hello) << hello.error().message;
  EXPECT_EQ(hello->token, "abc");
  EXPECT_EQ(hello->settings.controller, "s2o");
  EXPECT_EQ(hello->settings.horizon, 7.0f);
  EXPECT_FALSE(hello->settings.alwaysPredict);
  EXPECT_FALSE(hello->settings.resets);
  EXPECT_NEAR(hello->settings.space.area(), 30.0, 1e-9);
  EXPECT_EQ(hello->settings.start->floor, glm::vec3(1, 2, 3));
  EXPECT_NEAR(hello->settings.start->heading, 1.5707963, 1e-6);

  const auto refused = [](std::string_view text, std::string_view saying) {
    const auto read = parseHello(text);
    ASSERT_FALSE(read) << text;
    EXPECT_NE(read.error().message.find(saying), std::string::npos) << read.error().message;
  };
  refused("{}", "format");
  refused(R"({"format":"forewalk.hello/2"})", "forewalk.hello/1");
  refused(R"({"format":"forewalk.hello/1","sesion":{}})", "session");
  refused(R"({"format":"forewalk.hello/1","session":{"space":"/etc/passwd"}})", "space");
  refused(R"({"format":"forewalk.hello/1","session":{"scene":"office.obj"}})", "scene");
  refused(R"({"format":"forewalk.hello/1","session":{"user":{"kind":"wander"}}})", "user");
  refused(R"({"format":"forewalk.hello/1","session":{"horizon_m":1e9}})", "horizon_m");
  refused(R"({"format":"forewalk.hello/1","session":[]})", "object");
}

TEST(DaemonMessage, WritesOneTextForEachSequenceOfBytes) {
  std::mt19937_64 random(3);
  for (std::size_t size = 0; size < 200; ++size) {
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(random());
    const std::string text = toBase64Url(bytes);
    EXPECT_EQ(fromBase64Url(text).value(), bytes);
    EXPECT_FALSE(fromBase64Url(text + "="));
    EXPECT_FALSE(fromBase64Url(text + "A") && size % 3 != 1 && fromBase64Url(text + "A") == bytes);
  }
  EXPECT_FALSE(fromBase64Url("A"));
  EXPECT_FALSE(fromBase64Url("AB"));  // bits left over
  EXPECT_EQ(fromBase64Url("AA").value(), std::string(1, '\0'));
}

TokenState anyState(std::mt19937_64& random) {
  const auto real = [&] { return static_cast<double>(anyFloat(random)) / 7.0; };
  TokenState token;
  token.sessionId = random();
  rdw::SessionState& state = token.state;
  state.redirection = {real(), {real(), real()}, real()};
  state.physical = {{anyFloat(random), anyFloat(random), anyFloat(random)},
                    {anyFloat(random), anyFloat(random), anyFloat(random), anyFloat(random)}};
  state.location = {navmesh::PolygonId{static_cast<std::uint32_t>(random())},
                    {anyFloat(random), anyFloat(random)},
                    anyFloat(random),
                    random() % 2 == 0};
  state.motion.position = {static_cast<double>(anyFloat(random)),
                           static_cast<double>(anyFloat(random))};
  state.motion.velocity = {real(), real()};
  state.motion.heading = real();
  state.motion.seconds = real();
  state.motion.started = random() % 2 == 0;
  state.motion.walking = random() % 2 == 0;
  rdw::ResetPlan& plan = state.reset.plan;
  const auto way = random() % 3;
  plan.left = way == 0 ? rdw::ResetPlan::kNever : std::fmod(std::abs(real()), 6.0);
  plan.right = way == 1 ? rdw::ResetPlan::kNever : std::fmod(std::abs(real()), 6.0);
  plan.seen = static_cast<double>(random() % 3) * 2.0 * rdw::kPi;
  plan.frozen = random() % 2 == 0;
  state.reset.backward = std::fmod(real(), 3.0);
  if (random() % 2 == 0) {
    plan.back = random() % 2 == 0 ? std::fmod(std::abs(real()), 2.0) : 0.0;
    const double progress = plan.back > 0.0 ? 0.0 : std::fmod(real(), 3.0);
    state.reset.state = rdw::Reset::underWay(plan, progress, plan.back);
  }
  state.reset.state.direction = static_cast<int>(random() % 3) - 1;
  state.reset.state.instruction = static_cast<rdw::ResetInstruction>(random() % 7);
  state.reset.count = static_cast<std::uint32_t>(random());
  state.reset.inARow = static_cast<int>(random() % 4);
  return token;
}

TEST(StateToken, HoldsTheWholeState) {
  std::mt19937_64 random(4);
  TokenSigner signer(kKey, kNavMesh), other(kKey, kNavMesh);
  for (int i = 0; i < 500; ++i) {
    const TokenState state = anyState(random);
    std::string token, again;
    signer.sign(state, token);
    EXPECT_EQ(token.size(), kTokenBytes);
    EXPECT_LE(toBase64Url(token).size(), 256u);
    const auto opened = other.open(token);
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(opened->sessionId, state.sessionId);
    EXPECT_EQ(opened->state.redirection, state.state.redirection);
    EXPECT_EQ(opened->state.location, state.state.location);
    EXPECT_EQ(opened->state.physical.position, state.state.physical.position);
    EXPECT_EQ(opened->state.physical.orientation, state.state.physical.orientation);
    EXPECT_EQ(opened->state.motion.position, state.state.motion.position);
    EXPECT_EQ(opened->state.motion.velocity, state.state.motion.velocity);
    EXPECT_EQ(opened->state.motion.started, state.state.motion.started);
    EXPECT_EQ(opened->state.motion.walking, state.state.motion.walking);
    EXPECT_EQ(opened->state.reset.count, state.state.reset.count);
    EXPECT_EQ(opened->state.reset.inARow, state.state.reset.inARow);
    EXPECT_EQ(opened->state.reset.state.turning, state.state.reset.state.turning);
    EXPECT_EQ(opened->state.reset.state.direction, state.state.reset.state.direction);
    EXPECT_EQ(opened->state.reset.state.remaining, state.state.reset.state.remaining);
    other.sign(*opened, again);
    EXPECT_EQ(again, token);  // and what was not compared above
  }
}

TEST(StateToken, IsNobodyElsesToMake) {
  std::mt19937_64 random(5);
  TokenSigner signer(kKey, kNavMesh);
  std::string token;
  signer.sign(anyState(random), token);
  for (std::size_t i = 0; i < token.size(); ++i) {
    for (const int bit : {0, 3, 7}) {
      std::string changed = token;
      changed[i] = static_cast<char>(changed[i] ^ (1 << bit));
      EXPECT_FALSE(signer.open(changed)) << i;
    }
  }
  for (std::size_t size = 0; size < token.size(); ++size) {
    EXPECT_FALSE(signer.open(token.substr(0, size)));
  }
  EXPECT_FALSE(signer.open(token + '\0'));
  TokenSigner otherKey("another key of at least 32 bytes length", kNavMesh);
  EXPECT_FALSE(otherKey.open(token));
  TokenSigner otherGround(kKey, {8, 7, 6, 5, 4, 3, 2, 1});
  const auto refused = otherGround.open(token);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("0102030405060708"), std::string::npos);
}

TEST(Access, IsLoopbackWithoutAToken) {
  Access access;
  EXPECT_TRUE(validate(access));
  for (const char* address : {"127.0.0.1", "127.1.2.3", "::1"}) {
    access.address = address;
    EXPECT_TRUE(validate(access)) << address;
  }
  for (const char* address : {"0.0.0.0", "::", "192.0.2.7"}) {
    access.address = address;
    access.token = "";
    const auto refused = validate(access);
    ASSERT_FALSE(refused) << address;
    EXPECT_NE(refused.error().message.find("--token-file"), std::string::npos);
    access.token = "short";
    EXPECT_FALSE(validate(access)) << address;
    access.token = "long enough, but spaces";
    EXPECT_FALSE(validate(access)) << address;
    access.token = "0123456789abcdef";
    EXPECT_TRUE(validate(access)) << address;
  }
  access.address = "localhost";
  EXPECT_FALSE(validate(access));
}

TEST(Access, LetsOnlyItsOwnPagesIn) {
  Access access;
  access.port = 7878;
  access.origins = {"https://lab.example.org"};
  for (const char* origin : {"http://localhost:7878", "http://127.0.0.1:7878", "http://[::1]:7878",
                             "https://lab.example.org"}) {
    EXPECT_TRUE(originAllowed(access, std::string(origin))) << origin;
  }
  EXPECT_TRUE(originAllowed(access, std::nullopt));
  for (const char* origin :
       {"", "null", "http://localhost", "http://localhost:7879", "https://localhost:7878",
        "http://localhost:7878.evil.example", "http://evil.example:7878",
        "https://lab.example.org.evil.example", "https://lab.example.org:444"}) {
    EXPECT_FALSE(originAllowed(access, std::string(origin))) << origin;
  }
  access.address = "0.0.0.0";
  EXPECT_FALSE(originAllowed(access, std::string("http://localhost:7878")));
}

TEST(Access, KnowsTheTokenWhereverItStands) {
  Access access;
  EXPECT_TRUE(tokenGiven(access, "", ""));
  access.token = "0123456789abcdef";
  EXPECT_TRUE(tokenGiven(access, "Bearer 0123456789abcdef", ""));
  EXPECT_TRUE(tokenGiven(access, "", "forewalk.1, token.0123456789abcdef"));
  EXPECT_TRUE(tokenGiven(access, "", "token.0123456789abcdef,forewalk.1"));
  for (const char* wrong : {"", "0123456789abcdef", "Bearer 0123456789abcdeg",
                            "Bearer 0123456789abcde", "Bearer 0123456789abcdef0", "Basic x"}) {
    EXPECT_FALSE(tokenGiven(access, wrong, "forewalk.1")) << wrong;
  }
  EXPECT_FALSE(tokenGiven(access, "", "forewalk.1, token.0123456789abcdee"));
}

TEST(Metrics, CountEveryFrameOnceInItsBin) {
  Counters one, two;
  one.frame(500);         // 0.5 us
  one.frame(10000);       // 10 us, the end of the first bin
  two.frame(3000000);     // 3 ms
  two.frame(5000000000);  // 5 s
  two.refuse(Refusal::kIdle);
  const Counters* both[] = {&one, &two};
  const std::string text = metricsText(both, {"1", "2", 3, 4, 5, false});
  for (const char* line :
       {"forewalk_frame_seconds_bucket{le=\"1e-05\"} 2",
        "forewalk_frame_seconds_bucket{le=\"0.002\"} 2",
        "forewalk_frame_seconds_bucket{le=\"0.005\"} 3",
        "forewalk_frame_seconds_bucket{le=\"1\"} 3", "forewalk_frame_seconds_bucket{le=\"+Inf\"} 4",
        "forewalk_frame_seconds_count 4", "forewalk_refused_total{code=\"limit.idle_seconds\"} 1",
        "forewalk_refused_total{code=\"origin\"} 0"}) {
    EXPECT_NE(text.find(std::string("\n") + line + "\n"), std::string::npos) << line << "\n"
                                                                             << text;
  }
}

}  // namespace
}  // namespace forewalk::daemon
