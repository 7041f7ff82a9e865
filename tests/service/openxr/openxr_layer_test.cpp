// The OpenXR layer between Debian's loader, a client that knows nothing of it and a fake runtime:
// every frame is the library's, and the two spaces stay apart in every answer.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "tests/service/openxr/layer_support.h"

namespace forewalk {
namespace {

using testing::Answers;
using testing::apart;
using testing::expectNear;
using testing::Located;
using testing::Rigid;

using OpenXrLayer = testing::LayerTest;

// Answers are floats, some 40 m from the origin; a pose that went through two of them is off by
// a few of their last bits.
constexpr double kExact = 1e-5;  // metres, radians

const std::map<int, Located>& of(const Answers& answers, const std::string& name, int session = 0) {
  static const std::map<int, Located> kNone;
  const auto found = answers.find({session, name});
  EXPECT_NE(found, answers.end()) << "no answers called " << name;
  return found == answers.end() ? kNone : found->second;
}

TEST_F(OpenXrLayer, WithoutTheLayerTheClientSeesTheRuntimesPoses) {
  const Answers answers = walk(false);
  const auto& heads = of(answers, "view_in_stage");
  ASSERT_EQ(static_cast<int>(heads.size()), frames());
  for (const auto& [frame, head] : heads) {
    ASSERT_LT(apart(head.rigid(), physical(frame)).metres, 1e-7) << frame;
    ASSERT_LT(apart(head.rigid(), physical(frame)).radians, 1e-7) << frame;
  }
}

TEST_F(OpenXrLayer, EveryFrameIsTheLibrarys) {
  const Walked walked = walkedByTheLibrary();
  ASSERT_GE(walked.resets, 2u) << "a walk that tests nothing";
  const Answers answers = walk(true);
  const auto& heads = of(answers, "view_in_stage");
  ASSERT_EQ(static_cast<int>(heads.size()), frames());
  double metres = 0.0, radians = 0.0;
  for (const auto& [frame, head] : heads) {
    const auto off = apart(head.rigid(), walked.heads[static_cast<std::size_t>(frame)]);
    metres = std::max(metres, off.metres);
    radians = std::max(radians, off.radians);
  }
  std::printf("%d frames, %d resets; furthest from the library's pose: %.2g m, %.2g rad\n",
              frames(), static_cast<int>(walked.resets), metres, radians);
  EXPECT_LT(metres, kExact);
  EXPECT_LT(radians, kExact);
  EXPECT_GT(apart(heads.rbegin()->second.rigid(), physical(frames() - 1)).metres, 1.0)
      << "nobody was redirected";
}

TEST_F(OpenXrLayer, TheBodyIsRedirectedAsOneAndWhatIsFixedStays) {
  const Walked walked = walkedByTheLibrary();
  const auto took = [this] { return outcome_.out.substr(outcome_.out.find("frame: ")); };
  const Answers plain = walk(false);
  std::printf(
      "processor time of 15 answers and 3 pictures, median and 99 %%; without the layer, %s",
      took().c_str());
  const Answers answers = walk(true);
  std::printf("with it, %s", took().c_str());
  // What is seen from the same kind of space keeps the runtime's bits.
  for (const char* name : {"hand_in_view", "local_in_stage", "shelf_in_local"}) {
    for (const auto& [frame, at] : of(answers, name)) {
      ASSERT_TRUE(testing::sameBits(at.pose, of(plain, name).at(frame).pose)) << name << frame;
    }
  }
  for (const auto& [frame, head] : of(answers, "view_in_stage")) {
    const Rigid view = head.rigid();
    const Rigid& map = walked.maps[static_cast<std::size_t>(frame)];
    const auto at = [&, f = frame](const char* name) { return of(answers, name).at(f).rigid(); };
    const auto before = [&, f = frame](const char* name) { return of(plain, name).at(f).rigid(); };
    const std::string where = "frame " + std::to_string(frame);
    expectNear(at("hand_in_stage"), map * before("hand_in_stage"), kExact, where);
    expectNear(at("hand_in_stage"), view * at("hand_in_view"), kExact, where);
    expectNear(at("stage_in_view"), inverse(view), kExact, where);
    expectNear(at("local_in_stage") * at("view_in_local"), view, kExact, where);
    expectNear(at("local_in_stage") * at("hand_in_local"), at("hand_in_stage"), kExact, where);
    expectNear(at("shelf_in_local") * at("view_in_shelf"), at("view_in_local"), kExact, where);
    expectNear(at("hand_in_local") * at("shelf_in_hand"), at("shelf_in_local"), kExact, where);
    // Whoever asks in one go, or for the joints of a hand, is told the same.
    for (const char* name : {"view", "hand"}) {
      const std::string together = std::string("together_") + name;
      ASSERT_TRUE(testing::sameBits(of(answers, together).at(frame).pose,
                                    of(answers, name + std::string("_in_local")).at(frame).pose));
    }
    const Rigid finger = inverse(before("hand_in_local")) * before("finger_in_local");
    expectNear(at("finger_in_local"), at("hand_in_local") * finger, kExact, where);
    ASSERT_NEAR(glm::length(of(answers, "finger_in_local").at(frame).linear),
                glm::length(of(plain, "finger_in_local").at(frame).linear), 1e-4);
    // The eyes are where they are in the head.
    expectNear(inverse(at("view_in_local")) * at("left_eye"),
               inverse(before("view_in_local")) * before("left_eye"), kExact, where);
  }
}

TEST_F(OpenXrLayer, PicturesArriveInTheRoom) {
  walk(false);
  const Answers plain = pictures();
  const Answers answers = walk(true);
  const Answers shown = pictures();
  for (const auto& [frame, head] : of(answers, "view_in_local")) {
    const std::string where = "frame " + std::to_string(frame);
    // Eyes and what is carried before them: where the runtime's own eyes are.
    for (const char* name : {"eye0", "eye1", "quad2"}) {
      expectNear(of(shown, name).at(frame).rigid(), of(plain, name).at(frame).rigid(), kExact,
                 where);
    }
    // A sign on a wall of the scene: seen in the room as it is in the scene.
    const Rigid sign = of(answers, "shelf_in_local").at(frame).rigid() *
                       Rigid{{1.0, 0.0, 0.0, 0.0}, {0.5, 1.0, -3.0}};
    expectNear(inverse(physical(frame)) * of(shown, "quad1").at(frame).rigid(),
               inverse(head.rigid()) * sign, kExact, where);
  }
}

TEST_F(OpenXrLayer, VelocitiesAreTheBodysTurnedWithIt) {
  const Walked walked = walkedByTheLibrary();
  const Answers plain = walk(false), answers = walk(true);
  for (const auto& [frame, at] : of(answers, "hand_in_stage")) {
    const Located& before = of(plain, "hand_in_stage").at(frame);
    const glm::dquat turn = walked.maps[static_cast<std::size_t>(frame)].turn;
    ASSERT_EQ(at.velocityFlags, 3);
    ASSERT_LT(glm::distance(at.linear, turn * before.linear), 1e-4) << frame;
    ASSERT_LT(glm::distance(at.angular, turn * before.angular), 1e-4) << frame;
  }
  // What is fixed goes past the hand as fast as the hand goes past it.
  for (const auto& [frame, at] : of(answers, "shelf_in_hand")) {
    const Located& hand = of(answers, "hand_in_local").at(frame);
    const Rigid inHand = at.rigid();
    const glm::dquat toHand = glm::conjugate(hand.rigid().turn);
    const glm::dvec3 spin = -(toHand * hand.angular);
    const glm::dvec3 expected = -(toHand * hand.linear) + glm::cross(spin, inHand.move);
    ASSERT_LT(glm::distance(at.angular, spin), 1e-3) << frame;
    // The runtime's velocities are differences over a frame, in which a turn is a chord.
    const double chord = glm::length(spin) * glm::length(spin) * kPeriod * glm::length(inHand.move);
    ASSERT_LT(glm::distance(at.linear, expected), 1e-2 + 2.0 * chord) << frame;
  }
}

TEST_F(OpenXrLayer, ThePictureIsTintedWhileTheUserIsToTurn) {
  const Walked walked = walkedByTheLibrary();
  configure(R"("reset_tint": [1, 0.25, 0.5])");
  walk(true);
  const Answers shown = pictures();
  int tinted = 0;
  for (const auto& [frame, eye] : of(shown, "eye0")) {
    const bool signals = walked.signals[static_cast<std::size_t>(frame)];
    ASSERT_EQ(eye.tint, signals ? glm::vec3(1.0f, 0.25f, 0.5f) : glm::vec3(1.0f)) << frame;
    tinted += signals;
  }
  EXPECT_GT(tinted, 50);
  EXPECT_LT(tinted, frames() / 2);
}

TEST_F(OpenXrLayer, ARuntimeThatCannotTintOrHasNoStageIsRedirectedAllTheSame) {
  set("FAKE_OPENXR_NO_TINT", "1");
  set("FAKE_OPENXR_NO_STAGE", "1");
  // The floor is as far under LOCAL as the runtime of the other tests has it.
  configure(R"("eye_height_m": 1.5)");
  const Answers answers = walk(true, "--no-stage");
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("XR_KHR_composition_layer_color_scale_bias"));
  // The tracking space is under LOCAL, 0.4 m to the right, 0.2 m ahead and turned by 0.3 radians.
  const Rigid floor = openxr::levelRigid(0.3, {0.4, 0.0, -0.2});
  const Rigid first = of(answers, "view_in_local").at(0).rigid();
  const Rigid up = openxr::levelRigid(0.0, {0.0, 1.5, 0.0});
  const Rigid head = inverse(floor) * physical(0);
  EXPECT_NEAR((up * first).move.y, head.move.y, kExact);
  EXPECT_NEAR((up * first).move.x, 7.0, kExact) << "the start is where it was asked for";
  EXPECT_NEAR((up * first).move.z, 12.0, kExact);
}

TEST_F(OpenXrLayer, TheRoomIsTheRuntimesWhereTheFileSaysSo) {
  set("FAKE_OPENXR_BOUNDS", "4 4");
  const Answers known = walk(true);
  const std::string told = outcome_.out;
  configure("", "\"stage\"");
  const Answers stage = walk(true);
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("16.0 m^2 of free floor by the runtime's STAGE"));
  for (const auto& [frame, head] : of(known, "view_in_stage")) {
    ASSERT_TRUE(testing::sameBits(of(stage, "view_in_stage").at(frame).pose, head.pose)) << frame;
  }
  // A room that turns about the user has no place in the application's world.
  EXPECT_THAT(outcome_.out, ::testing::HasSubstr("bounds before 0: 0 4 4\n"));
  EXPECT_THAT(outcome_.out, ::testing::HasSubstr("bounds after 0: 7 0 0\n"));
}

TEST_F(OpenXrLayer, WithoutBoundsOfTheStageEverythingIsPassedOn) {
  const Answers plain = walk(false);
  configure("", "\"stage\"");
  const Answers answers = walk(true);
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("no bounds of its STAGE"));
  for (const auto& [frame, head] : of(answers, "view_in_local")) {
    ASSERT_TRUE(testing::sameBits(head.pose, of(plain, "view_in_local").at(frame).pose)) << frame;
  }
}

}  // namespace
}  // namespace forewalk
