// Frames that overlap, and sessions beside each other: what each is told is its own.
#include <string>
#include <thread>  // the client's; the build for the thread sanitizer takes tests that name it

#include "tests/service/openxr/layer_support.h"

namespace forewalk {
namespace {

using testing::Answers;

using OpenXrThreads = testing::LayerTest;

TEST_F(OpenXrThreads, AFrameDrawnWhileTheNextIsPreparedKeepsItsOwnMap) {
  walk(true);
  std::string inTurn = contents("answers.txt"), inTurnShown = contents("submitted.txt");
  walk(true, "--threads");
  EXPECT_EQ(contents("answers.txt"), inTurn);
  EXPECT_EQ(contents("submitted.txt"), inTurnShown);
}

TEST_F(OpenXrThreads, SessionsOfOneInstanceAreWalkedApart) {
  const Answers alone = walk(true), both = walk(true, "--sessions 2");
  for (const int session : {0, 1}) {
    for (const char* name : {"view_in_stage", "hand_in_local", "right_eye"}) {
      const auto& answers = both.at({session, name});
      ASSERT_EQ(answers.size(), alone.at({0, name}).size());
      for (const auto& [frame, at] : answers) {
        ASSERT_TRUE(testing::sameBits(at.pose, alone.at({0, name}).at(frame).pose))
            << name << frame;
      }
    }
  }
}

}  // namespace
}  // namespace forewalk
