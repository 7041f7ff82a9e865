#include "service/clip_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "agents/clip_triangulation.h"
#include "navmesh/file_text.h"
#include "rdw/json_text.h"

namespace forewalk::service {
namespace {

using agents::MotionClip;
using rdw::Fields;
using rdw::Json;

constexpr std::string_view kFormat = "forewalk.clips/1";
constexpr std::size_t kMostClips = 1000;
constexpr std::size_t kLongestName = 200;

MotionClip readClip(Fields& list, const Json& object, std::size_t number) {
  Fields fields(object, fmt::format("{}clips[{}].", list.path(), number), list.problem());
  MotionClip clip;
  fields.text("name", clip.name);
  if (clip.name.size() > kLongestName) {
    list.problem().say(ErrorCode::kTooLarge,
                       fmt::format("{}name has {} bytes, at most {} can be used.", fields.path(),
                                   clip.name.size(), kLongestName));
  }
  clip.motion.linear = std::numeric_limits<float>::quiet_NaN();
  fields.number("speed_m_per_s", 0.0, 20.0, clip.motion.linear);
  if (std::isnan(clip.motion.linear)) {
    fields.wrongKind("speed_m_per_s", "how fast the clip walks, m/s");
  }
  fields.number("turn_deg_per_s", -1440.0, 1440.0, clip.motion.angular, rdw::kDegree);
  fields.finish();
  return clip;
}

/// Of two clips with one motion a blend could not say which to play.
void refuseTwins(Fields& fields, const std::vector<MotionClip>& clips) {
  for (std::size_t a = 0; a < clips.size(); ++a) {
    for (std::size_t b = a + 1; b < clips.size(); ++b) {
      if (!(clips[a].motion == clips[b].motion)) continue;
      return fields.problem().say(
          ErrorCode::kDataDamaged,
          fmt::format("{}clips[{}] and clips[{}] both move at {:.6g} m/s and turn at {:.6g} deg/s; "
                      "keep one of them.",
                      fields.path(), a, b, clips[a].motion.linear,
                      static_cast<double>(clips[a].motion.angular) / rdw::kDegree));
    }
  }
}

}  // namespace

std::shared_ptr<const agents::LocomotionDatabase> readClips(Fields& fields) {
  const Json* list = fields.find("clips");
  if (list == nullptr) return nullptr;
  if (!list->is_array() || list->empty() || list->size() > kMostClips) {
    fields.wrongKind("clips", fmt::format("a list of 1 to {} clips {{...}}", kMostClips));
    return nullptr;
  }
  std::vector<MotionClip> clips;
  for (std::size_t i = 0; i < list->size() && !fields.problem().error(); ++i) {
    clips.push_back(readClip(fields, (*list)[i], i));
  }
  if (!fields.problem().error()) refuseTwins(fields, clips);
  if (fields.problem().error()) return nullptr;
  auto made = agents::triangulateClips(std::move(clips));
  if (!made) {
    fields.problem().pass(made.error());
    return nullptr;
  }
  return std::make_shared<const agents::LocomotionDatabase>(std::move(*made));
}

tl::expected<std::shared_ptr<const agents::LocomotionDatabase>, Error> parseClips(
    std::string_view text, const std::string& name) {
  const auto json = rdw::parseJson(text, name);
  if (!json) return tl::unexpected(json.error());
  rdw::Problem problem(name);
  Fields fields(*json, "", problem, "in a file of clips");
  rdw::requireFormat(fields, kFormat);
  auto clips = readClips(fields);
  if (clips == nullptr && !problem.error()) fields.wrongKind("clips", "a list of clips {...}");
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return clips;
}

}  // namespace forewalk::service
