// The reader of motion clips on any bytes; what it accepts can be blended.
#include <cmath>
#include <string_view>

#include "service/clip_file.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto clips =
      forewalk::service::parseClips({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (clips) {
    const auto& database = **clips;
    require(!database.clips().empty(), "there is a clip");
    for (const auto& clip : database.clips()) {
      const auto blend = database.blend(clip.motion);
      require(blend.has_value(), "every clip can be played");
      require(std::isfinite(database.motionOf(*blend).linear), "a blend moves");
    }
    return 0;
  }
  const std::string& message = clips.error().message;
  require(message.starts_with("fuzz") && message.size() < 900,
          "a message says where, and is short");
  for (const char c : message) require(c >= ' ' && c <= '~', "a message is printable");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const std::string_view text :
       {std::string_view(R"({"format": "forewalk.clips/1", "clips": [{"speed_m_per_s": 0}]})"),
        std::string_view(R"({"format": "forewalk.clips/1", "clips": [{"name": "stand",
            "speed_m_per_s": 0, "turn_deg_per_s": 0}, {"name": "walk", "speed_m_per_s": 1.3},
            {"name": "left", "speed_m_per_s": 1.2, "turn_deg_per_s": 60},
            {"name": "right", "speed_m_per_s": 1.2, "turn_deg_per_s": -60}]})")}) {
    seeds.emplace_back(text.begin(), text.end());
  }
  return seeds;
}
