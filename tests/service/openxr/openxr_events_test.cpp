// The OpenXR layer when things change or are wrong: recentring, lost heads, origins, files that
// cannot be read; and what the validation layer says about it.
#include <algorithm>
#include <cstring>
#include <string>

#include "tests/service/openxr/layer_support.h"

namespace forewalk {
namespace {

using testing::Answers;
using testing::apart;
using testing::expectNear;
using testing::LayerTest;
using testing::Located;
using testing::Rigid;

using OpenXrEvents = LayerTest;

constexpr double kExact = 1e-5;  // metres, radians

TEST_F(OpenXrEvents, RecentringPutsTheOriginWhereTheUserSeesThemselves) {
  constexpr int kFrame = 1200;
  set("FAKE_OPENXR_RECENTRE", "local 1200");
  const Walked walked = walkedByTheLibrary();
  const Answers plain = walk(false), answers = walk(true);
  const auto at = [](const Answers& from, const char* name, int frame) {
    return from.at({0, name}).at(frame).rigid();
  };
  // STAGE knows nothing of it.
  for (const int frame : {kFrame - 1, kFrame, kFrame + 1, frames() - 1}) {
    expectNear(at(answers, "view_in_stage", frame), walked.heads[static_cast<std::size_t>(frame)],
               kExact, std::to_string(frame));
  }
  // In LOCAL the user is where they are without us: upright at the origin, looking ahead,
  // but for the gains of the frame itself.
  expectNear(at(answers, "view_in_local", kFrame), at(plain, "view_in_local", kFrame), 0.01,
             "the frame of the change");
  EXPECT_GT(apart(at(answers, "view_in_local", kFrame - 1), at(plain, "view_in_local", kFrame - 1))
                .metres,
            1.0);
  // All spaces still agree, and what the event said is what came.
  const Rigid before = at(answers, "local_in_stage", kFrame - 1);
  const Rigid after = at(answers, "local_in_stage", kFrame);
  expectNear(after * at(answers, "view_in_local", kFrame + 50),
             at(answers, "view_in_stage", kFrame + 50), kExact, "later");
  ASSERT_EQ(answers.at({0, "moved"}).size(), 1u);
  const Rigid said = answers.at({0, "moved"}).begin()->second.rigid();
  // It was said five frames before, under the map of then.
  expectNear(before * said, after, 0.1, "the event");
}

TEST_F(OpenXrEvents, ASceneThatIsTiedToTheRecentredSpaceIsWalkedOnFromItsOrigin) {
  set("FAKE_OPENXR_RECENTRE", "stage 1100");
  const Answers plain = walk(false), answers = walk(true);
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("recentred"));
  // The picture does not jump: in LOCAL, which stays, the user goes on.
  const auto& heads = answers.at({0, "view_in_local"});
  for (int frame = 1; frame < frames(); ++frame) {
    ASSERT_LT(apart(heads.at(frame).rigid(), heads.at(frame - 1).rigid()).metres, 0.06) << frame;
  }
  const Rigid now = answers.at({0, "view_in_stage"}).at(1100).rigid();
  EXPECT_NEAR(now.move.x, 0.0, 1e-3);
  EXPECT_NEAR(now.move.z, 0.0, 1e-3);
}

TEST_F(OpenXrEvents, WhoIsLostGoesOnWhereTheyWere) {
  set("FAKE_OPENXR_LOST", "900 960");
  const Walked walked = walkedByTheLibrary(settings(), 900, 960);
  const Answers answers = walk(true);
  for (const auto& [frame, head] : answers.at({0, "view_in_stage"})) {
    if (frame >= 900 && frame <= 960) {
      ASSERT_EQ(head.flags, 0) << frame;
    } else {
      ASSERT_EQ(head.flags, 15) << frame;
      expectNear(head.rigid(), walked.heads[static_cast<std::size_t>(frame)], kExact,
                 std::to_string(frame));
    }
  }
}

TEST_F(OpenXrEvents, AWalkWithoutAStartBeginsWhereTheApplicationHasTheUser) {
  // The application has put its LOCAL origin, 1.5 m above the floor, into a corridor.
  configure(R"("origin": {"space": "local", "position": [7, 1.5, 12], "heading_deg": 90})",
            R"({"rectangle": [4, 4]})", false);
  const Answers plain = walk(false), answers = walk(true);
  const auto first = [](const Answers& from, const char* name) {
    return from.at({0, name}).at(0).rigid();
  };
  for (const char* name : {"view_in_local", "view_in_stage", "hand_in_local", "left_eye"}) {
    expectNear(first(answers, name), first(plain, name), 1e-4, name);
  }
  EXPECT_GT(apart(answers.at({0, "view_in_local"}).rbegin()->second.rigid(),
                  plain.at({0, "view_in_local"}).rbegin()->second.rigid())
                .metres,
            0.5);
}

TEST_F(OpenXrEvents, AnApplicationThatIsNotMeantIsLeftAlone) {
  walk(false, "--frames 400");
  const std::string plain = contents("answers.txt");
  configure(R"("applications": ["another"])");
  walk(true, "--frames 400");
  EXPECT_EQ(contents("answers.txt"), plain);
  configure(R"("applications": ["another", "walk client"])");
  walk(true, "--frames 400");
  EXPECT_NE(contents("answers.txt"), plain);
}

TEST_F(OpenXrEvents, AFileThatIsWrongPassesEverythingOnAndSaysSoInOneLine) {
  walk(false, "--frames 400");
  const std::string plain = contents("answers.txt"), shown = contents("submitted.txt");
  const struct {
    std::string file, says;
  } wrong[] = {
      {"", "layer.json"},
      {"{", "layer.json"},
      {"[]", "has to be an object"},
      {R"({"format": "forewalk.simulation/1"})", "forewalk.openxr/1"},
      {R"({"format": "forewalk.openxr/1"})", "scene is missing"},
      {R"({"format": "forewalk.openxr/1", "scene": "nowhere.fwmesh"})", "nowhere.fwmesh"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "horizon": 3})", "horizon_m"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "horizon_m": -3})", "-3"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "controller": "s2d"})", "s2d"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "reset_tint": [2, 0, 0]})",
       "reset_tint"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "applications": "all"})",
       "applications"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "origin": {"space": "view"}})",
       "origin.space"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "origin": {"position": [1]}})",
       "origin.position"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "space": {"rectangle": [0, 4]}})",
       "rectangle"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "space": {"rectangle": [4, 4]},
           "start": {"position": [7, 90, 12]}})",
       "start"},
      {R"({"format": "forewalk.openxr/1", "scene": "office.fwmesh", "space": {"rectangle": [4, 4]},
           "origin": {"position": [900, 0, 0]}})",
       "origin"},
  };
  for (const auto& [file, says] : wrong) {
    SCOPED_TRACE(file);
    write("layer.json", file);
    walk(true, "--frames 400");
    EXPECT_EQ(contents("answers.txt"), plain);
    EXPECT_EQ(contents("submitted.txt"), shown);
    std::string line = outcome_.err;
    // Of a walk that could begin: that it did.
    if (const auto begun = line.find("forewalk: redirecting in"); begun != std::string::npos) {
      line.erase(begun, line.find('\n', begun) + 1 - begun);
    }
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << outcome_.err;
    EXPECT_THAT(line, ::testing::StartsWith("forewalk: "));
    EXPECT_THAT(line, ::testing::HasSubstr("passed on unchanged"));
    EXPECT_THAT(line, ::testing::HasSubstr(says));
  }
  set("FOREWALK_OPENXR_CONFIG", "");
  walk(true, "--frames 400");
  EXPECT_EQ(contents("answers.txt"), plain);
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("FOREWALK_OPENXR_CONFIG"));
}

TEST_F(OpenXrEvents, LinesGoWhereTheEnvironmentSays) {
  set("FOREWALK_OPENXR_LOG", "layer.log");
  walk(true, "--frames 400");
  EXPECT_EQ(outcome_.err, "");
  EXPECT_THAT(contents("layer.log"), ::testing::HasSubstr("redirecting in office.fwmesh"));
  set("FOREWALK_OPENXR_LOG", "off");
  walk(true, "--frames 400");
  EXPECT_EQ(outcome_.err, "");
}

/// Above the layer it sees what the application does, below it what the layer makes of that.
TEST_F(OpenXrEvents, TheValidationLayerFindsNothing) {
#ifndef FOREWALK_VALIDATION_FOLDER
  GTEST_SKIP() << "there is no openxr-layer-corevalidation here";
#else
  const std::string validation = "XR_APILAYER_LUNARG_core_validation";
  set("XR_API_LAYER_PATH", std::string(FOREWALK_LAYER_FOLDER ":") + FOREWALK_VALIDATION_FOLDER);
  set("XR_CORE_VALIDATION_EXPORT_TYPE", "text");
  set("XR_CORE_VALIDATION_FILE_NAME", "validation.txt");
  set("FAKE_OPENXR_RECENTRE", "local 300");
  set("XR_ENABLE_API_LAYERS", validation);
  walkAsIs("--frames 40 --mistake");
  EXPECT_THAT(contents("validation.txt"), ::testing::HasSubstr("VUID-"))
      << "it notices nothing, so its silence says nothing";
  const std::string above = validation + ":" + kLayer, below = kLayer + (":" + validation);
  const auto expectClean = [&](const std::string& layers) {
    SCOPED_TRACE(layers);
    std::filesystem::remove(folder_ / "validation.txt");
    set("XR_ENABLE_API_LAYERS", layers);
    const Answers answers = walkAsIs();
    EXPECT_GT(apart(answers.at({0, "view_in_stage"}).at(0).rigid(), physical(0)).metres, 1.0);
    EXPECT_EQ(contents("validation.txt"), "");
  };
  expectClean(above);
  configure(R"("reset_tint": [1, 1, 1])");
  expectClean(below);

  // Version 1.0.20 refuses XrCompositionLayerColorScaleBiasKHR in any layer, though the
  // specification has it in all of them. Who is refused goes on without a tint.
  configure();
  set("XR_ENABLE_API_LAYERS", below);
  walkAsIs();
  EXPECT_EQ(pictures().at({0, "eye0"}).size(), static_cast<std::size_t>(frames()));
  EXPECT_THAT(outcome_.err, ::testing::HasSubstr("refuses pictures with a tint"));
#endif
}

}  // namespace
}  // namespace forewalk
