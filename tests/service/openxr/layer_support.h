// A walk through the office, played by the fake runtime to a client, with or without the layer.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/build/fwmesh.h"
#include "rdw/session.h"
#include "rdw/simulation.h"
#include "service/files.h"
#include "service/openxr/rigid.h"
#include "tests/support/program_test.h"

namespace forewalk::testing {

using openxr::Rigid;

/// One answer that the client got, or one picture that the runtime showed.
struct Located {
  int flags = 0;
  XrPosef pose{};
  int velocityFlags = 0;
  glm::dvec3 linear{0.0}, angular{0.0};
  glm::vec3 tint{1.0f};

  Rigid rigid() const { return openxr::rigidOf(pose); }
};

/// By session, name and frame.
using Answers = std::map<std::pair<int, std::string>, std::map<int, Located>>;

inline void readPose(std::istream& in, XrPosef& pose) {
  XrVector3f& p = pose.position;
  XrQuaternionf& q = pose.orientation;
  in >> p.x >> p.y >> p.z >> q.x >> q.y >> q.z >> q.w;
}

/// What the client wrote.
inline Answers answersIn(const std::string& text) {
  Answers answers;
  std::istringstream lines(text);
  int session, frame;
  std::string name;
  Located at;
  while (lines >> session >> frame >> name >> at.flags) {
    readPose(lines, at.pose);
    lines >> at.velocityFlags;
    for (glm::dvec3* v : {&at.linear, &at.angular}) lines >> v->x >> v->y >> v->z;
    answers[{session, name}][frame] = at;
  }
  return answers;
}

/// What the runtime wrote; names are eye0, eye1, quad1, quad2.
inline Answers picturesIn(const std::string& text) {
  Answers answers;
  std::istringstream lines(text);
  int session, frame;
  std::string kind, index;
  Located at;
  while (lines >> session >> frame >> kind >> index) {
    readPose(lines, at.pose);
    lines >> at.tint.x >> at.tint.y >> at.tint.z;
    answers[{session, kind + index}][frame] = at;
  }
  return answers;
}

/// How far two poses are apart: metres, and radians.
struct Apart {
  double metres = 0.0, radians = 0.0;
};

inline Apart apart(const Rigid& a, const Rigid& b) {
  const glm::dquat turn = glm::conjugate(a.turn) * b.turn;
  return {glm::distance(a.move, b.move),
          2.0 * std::asin(std::min(1.0, glm::length(glm::dvec3(turn.x, turn.y, turn.z))))};
}

inline void expectNear(const Rigid& a, const Rigid& b, double tolerance, const std::string& what) {
  const Apart off = apart(a, b);
  ASSERT_LT(off.metres, tolerance) << what;
  ASSERT_LT(off.radians, tolerance) << what;
}

inline bool sameBits(const XrPosef& a, const XrPosef& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The office, and 22 seconds of somebody in a room of 4 x 4 m who was redirected through it.
class LayerTest : public ProgramTest {
 protected:
  static constexpr double kPeriod = 11'111'111e-9;  // of the fake runtime, seconds

  static void SetUpTestSuite() {
    const auto navMesh = service::loadNavMesh(FOREWALK_ASSETS "/scenes/office.obj");
    ASSERT_TRUE(navMesh) << navMesh.error().message;
    fwmesh_ = std::make_unique<std::vector<std::byte>>(navmesh::saveFwmesh(*navMesh));
    world_ = *service::makeWorld(*navMesh);
    rdw::SimulationConfig config;
    config.session = settings();
    config.start.floor = settings().start->floor;
    config.start.heading = 0.0;
    config.rate = 1.0 / kPeriod;
    config.stop.seconds = 22.0;
    config.seed = 7;
    config.user.walker.lookAmplitude = 0.3;
    config.user.plan = rdw::Wander{};
    const auto walked = rdw::simulate(world_, config);
    ASSERT_TRUE(walked) << walked.error().message;
    walk_.clear();
    for (const rdw::FrameRecord& frame : walked->frames) {
      // What a simulated head does not do: nod, tilt, and go up and down.
      const double t = frame.t;
      const glm::dquat nod(std::cos(0.1 * std::sin(t)), std::sin(0.1 * std::sin(t)), 0.0, 0.0);
      const Rigid level = openxr::levelRigid(
          frame.physicalHeading,
          {frame.physicalPosition.x, 1.65 + 0.02 * std::sin(9.0 * t), -frame.physicalPosition.y});
      walk_.push_back(openxr::poseOf(level * Rigid{nod, glm::dvec3(0.0)}));
    }
  }
  static void TearDownTestSuite() {
    world_.reset();
    fwmesh_.reset();
  }

  static rdw::SessionSettings settings() {
    rdw::SessionSettings settings;
    settings.space = *rdw::TrackedSpace::rectangle(4.0, 4.0);
    settings.controller = "s2c-predictive";
    settings.alwaysPredict = false;
    settings.start = rdw::VirtualStart{{7.0f, 0.0f, 12.0f}, 0.0f};
    return settings;
  }

  /// The library's own session over the walk: virtual heads, and whether a turn is to be made.
  struct Walked {
    std::vector<Rigid> heads;
    std::vector<Rigid> maps;  // physical to virtual
    std::vector<bool> signals;
    std::uint64_t resets = 0;
  };
  static Walked walkedByTheLibrary(rdw::SessionSettings sessionSettings = settings(),
                                   int lostFirst = -1, int lostLast = -2) {
    Walked walked;
    auto session = rdw::Session::make(world_, std::move(sessionSettings));
    EXPECT_TRUE(session) << session.error().message;
    if (!session) return walked;
    for (int i = 0; i < frames(); ++i) {
      const XrPosef& pose = walk_[static_cast<std::size_t>(i)];
      if (i < lostFirst || i > lostLast) {
        const rdw::HeadPose head{
            {pose.position.x, pose.position.y, pose.position.z},
            {pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z}};
        session->frame(head, static_cast<double>(i * std::int64_t{11'111'111}) * 1e-9);
      }
      const rdw::FrameResult& result = session->result();
      walked.maps.push_back(openxr::rigidOf(session->redirection()));
      walked.heads.push_back(
          {glm::dquat(result.virtualPose.orientation), glm::dvec3(result.virtualPose.position)});
      walked.signals.push_back(result.reset.turning ||
                               result.reset.instruction != rdw::ResetInstruction::kNone);
      walked.resets = result.resetCount;
    }
    return walked;
  }

  static int frames() { return static_cast<int>(walk_.size()); }
  static Rigid physical(int frame) {
    return openxr::rigidOf(walk_[static_cast<std::size_t>(frame)]);
  }

  LayerTest() {
    std::ofstream walk(folder_ / "walk.txt");
    walk.precision(9);
    for (const XrPosef& pose : walk_) {
      const XrVector3f& p = pose.position;
      const XrQuaternionf& q = pose.orientation;
      walk << p.x << ' ' << p.y << ' ' << p.z << ' ' << q.x << ' ' << q.y << ' ' << q.z << ' '
           << q.w << '\n';
    }
    EXPECT_TRUE(service::writeFile(folder_ / "office.fwmesh", *fwmesh_));
    write("runtime.json", R"({"file_format_version": "1.0.0", "runtime": {"library_path": ")" +
                              std::string(FOREWALK_FAKE_RUNTIME) + R"("}})");
    configure();
    set("XR_RUNTIME_JSON", (folder_ / "runtime.json").string());
    set("FAKE_OPENXR_WALK", "walk.txt");
    set("FAKE_OPENXR_SUBMITTED", "submitted.txt");
    set("XR_API_LAYER_PATH", FOREWALK_LAYER_FOLDER);
    set("FOREWALK_OPENXR_CONFIG", "layer.json");
  }
  ~LayerTest() override {
    for (const std::string& name : set_) unsetenv(name.c_str());
  }

  void set(const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
    set_.push_back(name);
  }

  /// The layer's file: the settings above, with `more` in the object, and the start unless told.
  void configure(const std::string& more = "",
                 const std::string& space = R"({"rectangle": [4, 4]})", bool start = true) const {
    write("layer.json",
          R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "space": )" + space +
              (start ? R"(, "start": {"position": [7, 0, 12], "heading_deg": 0})" : "") +
              (more.empty() ? "" : ", " + more) + "}");
  }

  /// Runs the client; its answers.
  Answers walk(bool layer, const std::string& options = "") {
    set("XR_ENABLE_API_LAYERS", layer ? kLayer : "");
    return walkAsIs(options);
  }
  /// The same with the layers that the environment names.
  Answers walkAsIs(const std::string& options = "") {
    outcome_ = run("answers.txt " + options);
    EXPECT_EQ(outcome_.status, 0) << outcome_.err;
    return answersIn(contents("answers.txt"));
  }
  Answers pictures() const { return picturesIn(contents("submitted.txt")); }

  static constexpr const char* kLayer = "XR_APILAYER_FOREWALK_redirection";
  Outcome outcome_{};  // of the latest run

 private:
  static inline std::unique_ptr<std::vector<std::byte>> fwmesh_;
  static inline std::shared_ptr<const navmesh::World> world_;
  static inline std::vector<XrPosef> walk_;
  std::vector<std::string> set_;
};

}  // namespace forewalk::testing
