#include "rdw/simulation_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace forewalk::rdw {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

tl::expected<SimulationFile, Error> parse(const std::string& text) {
  return parseSimulation(std::as_bytes(std::span(text)), "sim.json");
}

/// A sound file with `more` added.
std::string with(const std::string& more) {
  return R"({"format": "forewalk.simulation/1", "user": {"kind": "wander"})" +
         (more.empty() ? "" : ", " + more) + "}";
}

std::string withUser(const std::string& user) {
  return R"({"format": "forewalk.simulation/1", "user": {)" + user + "}}";
}

std::string refusal(const std::string& text) {
  const auto file = parse(text);
  return file ? "accepted" : file.error().message;
}

TEST(ParseSimulation, RefusesWhatIsNoSimulation) {
  EXPECT_THAT(refusal(""), HasSubstr("sim.json:1: not valid JSON"));
  EXPECT_THAT(refusal("{\n\"format\": \"forewalk.simulation/1\",\n\"user\": }"),
              HasSubstr("sim.json:3: not valid JSON at byte"));
  EXPECT_THAT(refusal("[]"), HasSubstr("has to be an object"));
  EXPECT_THAT(refusal("{}"), HasSubstr("\"format\" is missing"));
  EXPECT_THAT(refusal(R"({"format": "forewalk.simulation/2"})"),
              HasSubstr("is \"forewalk.simulation/2\""));
  EXPECT_EQ(parse(R"({"format": "forewalk.simulation/2"})").error().code,
            ErrorCode::kFormatUnsupported);
  EXPECT_THAT(refusal(R"({"format": "forewalk.simulation/1"})"), HasSubstr("user is missing"));
  EXPECT_THAT(refusal(std::string(100000, '[')), HasSubstr("nested more than 32 deep"));
}

TEST(ParseSimulation, NamesTheNearestKeyForAnUnknownOne) {
  EXPECT_THAT(refusal(with(R"("horizon": 10)")), AllOf(HasSubstr("\"horizon\" is not known"),
                                                       HasSubstr("did you mean \"horizon_m\"?")));
  EXPECT_THAT(refusal(with(R"("stop": {"virtual": 10})")),
              HasSubstr("did you mean \"virtual_m\"?"));
  EXPECT_THAT(refusal(with(R"("build": {"slope_rad": 1})")),
              HasSubstr("did you mean \"slope_deg\"?"));
  EXPECT_THAT(refusal(withUser(R"("kind": "wander", "speed": 1)")), HasSubstr("\"user.speed\""));
  EXPECT_THAT(refusal(withUser(R"("kind": "wandr")")), HasSubstr("did you mean \"wander\"?"));
  EXPECT_THAT(refusal(with(R"("controller": "s2c-predict")")),
              HasSubstr("did you mean \"s2c-predictive\"?"));
  EXPECT_THAT(refusal(with(R"("limits": "steinike")")), HasSubstr("did you mean \"steinicke\"?"));
  EXPECT_THAT(refusal(with(R"("zzzzzzzz": 1)")), HasSubstr("known are: format, scene"));
  // Keys of another kind of user are not known to this one.
  EXPECT_THAT(refusal(withUser(R"("kind": "wander", "leg_min_m": 1)")),
              HasSubstr("\"user.leg_min_m\""));
}

TEST(ParseSimulation, NamesValueAndRange) {
  EXPECT_THAT(refusal(with(R"("rate_hz": 0)")),
              HasSubstr("rate_hz is 0, it has to lie in [5, 1000]"));
  EXPECT_THAT(refusal(with(R"("horizon_m": -1)")), HasSubstr("horizon_m is -1"));
  EXPECT_THAT(refusal(with(R"("horizon_m": "far")")), HasSubstr("horizon_m has to be a number"));
  EXPECT_THAT(refusal(with(R"("seed": -1)")), HasSubstr("seed has to be a whole number"));
  EXPECT_THAT(refusal(with(R"("seed": 1.5)")), HasSubstr("seed has to be a whole number"));
  EXPECT_THAT(refusal(with(R"("resets": 1)")), HasSubstr("resets has to be true or false"));
  EXPECT_THAT(refusal(with(R"("start": {"position": [1, 2]})")),
              HasSubstr("start.position has to be 3 numbers"));
  EXPECT_THAT(refusal(with(R"("start": {"position": [1, 2, 1e9]})")), HasSubstr("within 100 km"));
  EXPECT_THAT(refusal(with(R"("start": {"heading_deg": 1000})")),
              HasSubstr("start.heading_deg is 1000"));
  EXPECT_THAT(refusal(with(R"("space": {"rectangle": [0, 5]})")), HasSubstr("rectangle"));
  EXPECT_THAT(refusal(with(R"("space": 5)")), HasSubstr("space has to be the name of a file"));
  EXPECT_THAT(refusal(withUser(R"("kind": "waypoints")")),
              HasSubstr("user.waypoints has to be a list"));
  EXPECT_THAT(refusal(withUser(R"("kind": "waypoints", "waypoints": [[0,0,0],[1,"a",2]])")),
              HasSubstr("user.waypoints[1] has to be 3 numbers"));
  EXPECT_THAT(refusal(withUser(R"("kind": "recorded")")), HasSubstr("user.walks has to be"));
  EXPECT_EQ(parse(with(R"("rate_hz": 0)")).error().code, ErrorCode::kSettingOutOfRange);
}

TEST(ParseSimulation, KeepsDefaultsWhereNothingIsSaid) {
  const auto file = parse(with(""));
  ASSERT_TRUE(file) << file.error().message;
  const SimulationFile defaults;
  EXPECT_EQ(file->build, defaults.build);
  EXPECT_EQ(file->simulation.session.controller, defaults.simulation.session.controller);
  EXPECT_EQ(file->simulation.session.limits, defaults.simulation.session.limits);
  EXPECT_EQ(file->simulation.session.method, prediction::Method::kPolygon);
  EXPECT_EQ(file->simulation.session.front.persistence, 0.75f);
  EXPECT_EQ(file->simulation.rate, 90.0);
  EXPECT_EQ(file->simulation.seed, 1u);
  EXPECT_FALSE(file->simulation.start.floor);
  EXPECT_FALSE(file->simulation.start.physical);
  EXPECT_EQ(file->simulation.session.space.area(), 36.0);
}

TEST(ParseSimulation, ReadsEveryKeyInItsUnit) {
  const auto file = parse(R"({
    "format": "forewalk.simulation/1",
    "scene": "office.obj",
    "import": {"metres_per_unit": 0.01, "up": "z"},
    "build": {"radius_m": 0.3, "height_m": 2, "climb_m": 0.2, "slope_deg": 30, "cell_m": 0.05,
              "cell_height_m": 0.02, "region_min_m2": 1, "region_merge_m2": 2, "edge_max_m": 6,
              "edge_error_m": 0.1, "detail_sample_m": 1, "detail_error_m": 0.1, "corners_max": 4,
              "partition": "layers", "tile_m": 16},
    "space": {"rectangle": [4, 10]},
    "limits": {"preset": "toolkit", "curvature_max_per_m": 0.1},
    "controller": "s2o", "horizon_m": 20, "rate_hz": 60, "seed": 18446744073709551615,
    "predict_always": false, "method": "front", "persistence_m": 1.5, "resets": false,
    "reset": {"reaction_s": 0.1, "deceleration_m_per_s2": 2, "clearance_m": 0.4, "warning_s": 2},
    "stop": {"virtual_m": 1000, "seconds": 3600},
    "user": {"kind": "legs", "leg_min_m": 3, "leg_max_m": 5, "turn_deg": 180, "turn": "uniform",
             "speed_m_per_s": 1.4, "turn_rate_deg_per_s": 180, "stop_angle_deg": 90, "reaction_s": 0.5, "acceleration_m_per_s2": 1.5,
             "deceleration_m_per_s2": 4, "pause_min_s": 1, "pause_max_s": 2, "look_amplitude_deg": 90,
             "look_period_s": 3, "bob_m": 0.02, "sway_m": 0.03, "eye_height_m": 1.5,
             "corner_margin_m": 0.1},
    "start": {"position": [1, 2, 3], "heading_deg": 90},
    "physical_start": {"position": [0.5, 1.5], "heading_deg": -90}
  })");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->scene, "office.obj");
  EXPECT_EQ(file->import.metresPerUnit, 0.01f);
  EXPECT_EQ(file->import.up, navmesh::UpAxis::kZ);
  EXPECT_NEAR(static_cast<double>(file->build.slope), kPi / 6.0, 1e-6);
  EXPECT_EQ(file->build.partition, navmesh::Partition::kLayers);
  EXPECT_EQ(file->build.cornersMax, 4u);
  EXPECT_EQ(file->build.tile, 16.0f);
  const SimulationConfig& s = file->simulation;
  EXPECT_EQ(s.session.space.area(), 40.0);
  EXPECT_EQ(s.session.limits.rotationMax, gainLimitsByName("toolkit")->rotationMax);
  EXPECT_EQ(s.session.limits.curvatureMax, 0.1f);
  EXPECT_EQ(s.session.controller, "s2o");
  EXPECT_EQ(s.session.horizon, 20.0f);
  EXPECT_FALSE(s.session.alwaysPredict);
  EXPECT_EQ(s.session.method, prediction::Method::kFront);
  EXPECT_EQ(s.session.front.persistence, 1.5f);
  EXPECT_FALSE(s.session.resets);
  EXPECT_EQ(s.session.reset.clearance, 0.4);
  EXPECT_EQ(s.rate, 60.0);
  EXPECT_EQ(s.seed, ~std::uint64_t{0});
  EXPECT_EQ(s.stop.virtualMetres, 1000.0);
  EXPECT_EQ(s.stop.seconds, 3600.0);
  const auto* legs = std::get_if<Legs>(&s.user.plan);
  ASSERT_NE(legs, nullptr);
  EXPECT_EQ(legs->lengthMax, 5.0);
  EXPECT_NEAR(legs->turn, kPi, 1e-12);
  EXPECT_FALSE(legs->eitherSide);
  EXPECT_EQ(s.user.walker.speed, 1.4);
  EXPECT_NEAR(s.user.walker.turnRate, kPi, 1e-12);
  EXPECT_NEAR(s.user.walker.lookAmplitude, 0.5 * kPi, 1e-12);
  EXPECT_EQ(s.user.walker.acceleration, 1.5);
  EXPECT_EQ(s.user.walker.cornerMargin, 0.1);
  EXPECT_EQ(s.start.floor, glm::vec3(1, 2, 3));
  EXPECT_NEAR(*s.start.heading, 0.5 * kPi, 1e-12);
  EXPECT_EQ(s.start.physical->position, glm::dvec2(0.5, -1.5));
  EXPECT_NEAR(s.start.physical->heading, -0.5 * kPi, 1e-12);
}

TEST(ParseSimulation, NamesTheFilesToRead) {
  const auto file = parse(
      R"({"format": "forewalk.simulation/1", "space": "room.json",
          "user": {"kind": "recorded", "walks": "walks.csv", "walker": "u3"}})");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->space, "room.json");
  EXPECT_EQ(file->users.front().walks, "walks.csv");
  EXPECT_EQ(file->users.front().walker, "u3");
  EXPECT_TRUE(std::holds_alternative<Recorded>(file->simulation.user.plan));
}

TEST(ParseSimulation, NeverCrashesOnATruncatedFile) {
  const std::string whole =
      with(R"("space": {"polygon": [[0,0],[0,4],[4,0]]}, "limits": {"preset": "neth"})");
  ASSERT_TRUE(parse(whole)) << refusal(whole);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(parse(whole.substr(0, length))) << length;
  }
}

}  // namespace
}  // namespace forewalk::rdw
