// The daemon's messages under any bytes: hellos, frames in both forms, answers, tokens, recordings.
//
// Whatever is accepted is written again as the same, a token that was not signed is never opened,
// and a session takes any frame that was read.
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "navmesh/build/build.h"
#include "service/daemon/message.h"
#include "service/daemon/recording_format.h"
#include "service/daemon/replay.h"
#include "service/daemon/state_token.h"
#include "service/files.h"
#include "tests/fuzz/fuzz.h"

namespace {

using namespace forewalk;

using forewalk::testing::require;

constexpr std::string_view kKey = "0123456789abcdef0123456789abcdef";
constexpr daemon::NavMeshHash kNavMesh{1, 2, 3, 4, 5, 6, 7, 8};

std::shared_ptr<const navmesh::World> room() {
  static const auto world = [] {
    navmesh::Scene scene;
    scene.vertices = {{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}};
    scene.triangles = {{0, 2, 1}, {0, 3, 2}};
    return service::makeWorld(navmesh::buildNavMesh(scene).value()).value();
  }();
  return world;
}

rdw::Session& veteran() {
  static rdw::Session session =
      rdw::Session::make(room(), daemon::parseSettings(R"({"controller":"s2c"})").value()).value();
  return session;
}

void frame(std::string_view bytes, bool isText) {
  const auto read = daemon::parseFrame(bytes, isText);
  if (!read) return require(!read.error().message.empty(), "a refusal has a sentence");
  const auto again = daemon::parseFrame(daemon::frameBytes(*read), false);
  require(again && daemon::frameBytes(*again) == daemon::frameBytes(*read),
          "a frame is written as it was read");
  require(daemon::parseFrame(daemon::frameText(*read), true).has_value(), "and as text");
  const daemon::Answer answer = daemon::answerOf(read->sequence, daemon::walk(veteran(), *read));
  std::string text, raw;
  daemon::appendAnswerText(answer, {}, {}, text);
  require(nlohmann::json::accept(text), "an answer is JSON");
  daemon::appendAnswerBytes(answer, {}, raw);
  const auto back = daemon::parseAnswerBytes(raw);
  require(back && back->answer == answer, "an answer is read as it was written");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  frame(bytes, true);
  frame(bytes, false);
  (void)daemon::parseAnswerBytes(bytes);
  const auto hello = daemon::parseHello(bytes);
  require(hello || !hello.error().message.empty(), "a refusal has a sentence");
  if (hello) {
    const std::string settings = daemon::settingsText(hello->settings);
    const auto again = daemon::parseSettings(settings);
    require(again && daemon::settingsText(*again) == settings, "settings are read as written");
  }
  require(nlohmann::json::accept(daemon::errorText("x", bytes)), "an error is JSON");
  if (const auto raw = daemon::fromBase64Url(bytes)) {
    require(daemon::toBase64Url(*raw) == bytes, "one text for each sequence of bytes");
  }
  require(!daemon::TokenSigner(kKey, kNavMesh).open(bytes), "no token but one that was signed");
  if (const auto state = daemon::stateFromBytes(bytes, kNavMesh)) {
    static rdw::Session session =
        rdw::Session::make(room(), daemon::parseSettings(R"({"controller":"none"})").value())
            .value();
    if (session.resume(state->state)) {
      const rdw::FrameResult& result = session.frame({{0.0f, 1.7f, 0.0f}, {}}, 1.0);
      require(std::isfinite(result.virtualPose.position.x + result.virtualPose.position.y +
                            result.virtualPose.position.z),
              "what is gone on from gives finite poses");
    }
  }
  (void)daemon::replay(bytes, room(), kNavMesh);
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  std::vector<std::vector<std::uint8_t>> seeds;
  const auto add = [&](const std::string& bytes) {
    seeds.emplace_back(bytes.begin(), bytes.end());
  };
  daemon::Frame one;
  one.head.position = {0.5f, 1.7f, -0.5f};
  one.seconds = 0.25;
  add(daemon::frameBytes(one));
  add(daemon::frameText(one));
  daemon::Frame more = one;
  more.gaze = glm::vec3(-1.0f, 0.0f, -0.0f);
  more.chest = glm::vec3(0.0f, 0.0f, -1.0f);
  more.others.push_back({{1.0, 2.0}, {0.5, 0.0}, {0.0, 1.0}, 0.5});
  add(daemon::frameText(more));
  add(R"({"format":"forewalk.hello/1","token":"AAAA","session":{"controller":"s2o","horizon_m":7,)"
      R"("space":{"polygon":[[0,0],[4,0],[4,4]]},"limits":{"preset":"neth","curvature_max_per_m":0.2},)"
      R"("reset":{"warning_s":2},"start":{"position":[1,2,3],"heading_deg":90}}})");
  std::string answer;
  daemon::appendAnswerBytes({}, "token", answer);
  add(answer);
  add(daemon::toBase64Url("some bytes"));
  veteran().frame(one.head, 0.5);
  const daemon::TokenState state{42, veteran().state()};
  add(daemon::stateBytes(state, kNavMesh));
  std::string recording =
      daemon::recordingHead("2a", "room", daemon::textOf(kNavMesh), "{\"controller\":\"none\"}",
                            daemon::stateBytes(state, kNavMesh));
  daemon::appendRecordedFrame(one, {}, recording);
  daemon::appendRecordedTeleport({{0.5f, 0.0f, 0.5f}, 1.0f}, recording);
  daemon::appendRecordedFrame(more, {}, recording);
  daemon::appendRecordedWorldChange(recording);
  add(recording);
  return seeds;
}
