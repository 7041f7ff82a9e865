#include "service/clip_file.h"

#include <gmock/gmock.h>

namespace forewalk::service {
namespace {

using ::testing::HasSubstr;

std::string fileOf(const std::string& clips) {
  return R"({"format": "forewalk.clips/1", "clips": )" + clips + "}";
}

std::string messageOf(const std::string& text) {
  const auto parsed = parseClips(text, "clips.json");
  return parsed ? std::string("accepted") : parsed.error().message;
}

TEST(ClipFile, IsReadWithItsUnits) {
  const auto clips = parseClips(fileOf(R"([{"name": "stand", "speed_m_per_s": 0},
      {"name": "left", "speed_m_per_s": 1.2, "turn_deg_per_s": 90},
      {"name": "right", "speed_m_per_s": 1.2, "turn_deg_per_s": -90}])"),
                                "clips.json");
  ASSERT_TRUE(clips) << clips.error().message;
  ASSERT_EQ((*clips)->clips().size(), 3u);
  EXPECT_EQ((*clips)->clips()[1].name, "left");
  EXPECT_FLOAT_EQ((*clips)->highest().angular, 1.5707964f);
  EXPECT_EQ((*clips)->triangles().size(), 1u);
  const auto blend = (*clips)->blend({0.6f, 0.0f});
  ASSERT_TRUE(blend);
  EXPECT_NEAR((*clips)->motionOf(*blend).linear, 0.6f, 1e-5f);
  EXPECT_FALSE((*clips)->blend({0.6f, 1.5f}));
}

TEST(ClipFile, OnOneLineIsAChain) {
  const auto clips =
      parseClips(fileOf(R"([{"speed_m_per_s": 1.4}, {"speed_m_per_s": 0}])"), "clips.json");
  ASSERT_TRUE(clips) << clips.error().message;
  EXPECT_EQ((*clips)->chain().size(), 2u);
}

TEST(ClipFile, IsTheSameInAnyOrderOfItsClips) {
  const std::string a = R"({"speed_m_per_s": 0})",
                    b = R"({"speed_m_per_s": 1, "turn_deg_per_s": 50})",
                    c = R"({"speed_m_per_s": 1, "turn_deg_per_s": -50})",
                    d = R"({"speed_m_per_s": 2})";
  const auto one = parseClips(fileOf("[" + a + "," + b + "," + c + "," + d + "]"), "x");
  const auto other = parseClips(fileOf("[" + d + "," + c + "," + b + "," + a + "]"), "x");
  ASSERT_TRUE(one && other);
  for (const agents::Command motion :
       {agents::Command{0.5f, 0.1f}, {1.4f, -0.2f}, {1.0f, 0.0f}, {2.5f, 0.0f}, {0.1f, 0.8f}}) {
    const auto first = (*one)->blend(motion), second = (*other)->blend(motion);
    ASSERT_EQ(first.has_value(), second.has_value());
    if (!first) continue;
    EXPECT_NEAR((*one)->motionOf(*first).linear, (*other)->motionOf(*second).linear, 1e-5f);
    EXPECT_NEAR((*one)->motionOf(*first).angular, (*other)->motionOf(*second).angular, 1e-5f);
  }
}

TEST(ClipFile, IsRefusedInOneLineThatSaysWhereAndWhat) {
  EXPECT_THAT(messageOf("{"), HasSubstr("clips.json"));
  EXPECT_THAT(messageOf(R"({"clips": []})"), HasSubstr("forewalk.clips/1"));
  EXPECT_THAT(messageOf(R"({"format": "forewalk.clips/1"})"), HasSubstr("clips"));
  EXPECT_THAT(messageOf(fileOf("[]")), HasSubstr("a list of 1 to 1000 clips"));
  EXPECT_THAT(messageOf(fileOf(R"([{"name": "walk"}])")), HasSubstr("clips[0].speed_m_per_s"));
  EXPECT_THAT(messageOf(fileOf(R"([{"speed_m_per_s": -1}])")),
              HasSubstr("clips[0].speed_m_per_s is -1, it has to lie in [0, 20]"));
  EXPECT_THAT(messageOf(fileOf(R"([{"speed_m_per_s": 1, "turn": 3}])")), HasSubstr("\"clips[0].turn\" is not known"));
  EXPECT_THAT(messageOf(fileOf(R"([{"speed_m_per_s": 1}, {"speed_m_per_s": 1}])")),
              HasSubstr("clips[0] and clips[1] both move at 1 m/s"));
  for (const std::string& text : {std::string("{"), fileOf("[]"), fileOf("[3]")}) {
    EXPECT_EQ(messageOf(text).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace forewalk::service
