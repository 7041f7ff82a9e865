#include "rdw/gains.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forewalk::rdw {
namespace {

TEST(GainPresets, AreValidAndHoldNeutralGains) {
  for (const GainPreset& preset : gainPresets()) {
    EXPECT_TRUE(validate(preset.limits)) << preset.name;
    EXPECT_EQ(clamped(Gains{}, preset.limits), Gains{}) << preset.name;
    EXPECT_EQ(gainLimitsByName(preset.name), preset.limits);
    EXPECT_FALSE(preset.source.empty());
  }
  EXPECT_EQ(gainLimitsByName("steinicke"), GainLimits{});
  EXPECT_FALSE(gainLimitsByName("Steinicke "));
}

TEST(GainPresets, TurnTheBandOfTheToolkitsRoundOnly) {
  // People can be turned physically 49 % more (virtual/physical 0.67) or 20 % less (1.25)
  // unnoticed.
  const GainLimits published = *gainLimitsByName("steinicke");
  EXPECT_NEAR(1.0f / published.rotationMin, 1.49f, 0.01f);
  EXPECT_NEAR(1.0f / published.rotationMax, 0.80f, 0.01f);
  const GainLimits toolkit = *gainLimitsByName("toolkit");
  EXPECT_FLOAT_EQ(toolkit.rotationMax, 1.49f);
  EXPECT_FLOAT_EQ(toolkit.rotationMin, 0.80f);
  EXPECT_FLOAT_EQ(gainLimitsByName("laboratory")->curvatureMax, 1.0f / 7.5f);
}

TEST(Clamped, CutsEachGainAndMakesNaNNeutral) {
  const GainLimits limits;
  const Gains wild = clamped({9.0f, -9.0f, -9.0f, 9.0f}, limits);
  EXPECT_EQ(wild, (Gains{1.26f, 0.67f, -1.0f / 22.0f, 1.0f}));
  EXPECT_EQ(clamped({NAN, NAN, NAN, NAN}, limits), Gains{});
  EXPECT_EQ(clamped({INFINITY, INFINITY, INFINITY, 1.0f}, limits).curvature, limits.curvatureMax);
}

TEST(Validate, NamesTheFieldAndItsValue) {
  GainLimits limits;
  limits.rotationMin = 1.2f;
  auto result = validate(limits);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kSettingOutOfRange);
  EXPECT_NE(result.error().message.find("rotation"), std::string::npos);
  EXPECT_NE(result.error().message.find("1.2"), std::string::npos);
  for (float bad : {-0.1f, 11.0f, INFINITY, NAN}) {
    limits = {};
    limits.curvatureMax = bad;
    EXPECT_FALSE(validate(limits)) << bad;
  }
  for (float bad : {0.0f, -1.0f, NAN}) {
    limits = {};
    limits.bendingMin = bad;
    EXPECT_FALSE(validate(limits)) << bad;
  }
}

}  // namespace
}  // namespace forewalk::rdw
