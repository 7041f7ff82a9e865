#include "service/openxr/world_maps.h"

#include <algorithm>

#include "service/openxr/api.h"

namespace forewalk::openxr {

Kind kindOf(XrReferenceSpaceType type) {
  switch (static_cast<int>(type)) {
    case XR_REFERENCE_SPACE_TYPE_STAGE:
      return Kind::kStage;
    case XR_REFERENCE_SPACE_TYPE_LOCAL:
      return Kind::kLocal;
    case kReferenceLocalFloor:
      return Kind::kLocalFloor;
    case kReferenceUnboundedMsft:
    case kReferenceUnboundedAndroid:
    case kReferenceLocalizationMap:
      return Kind::kUnbounded;
    default:
      return Kind::kBody;  // VIEW, and spaces between the eyes
  }
}

void WorldMapHistory::add(const WorldMaps& maps) {
  const std::lock_guard lock(mutex_);
  maps_[count_ % kFrames] = maps;
  ++count_;
}

std::optional<WorldMaps> WorldMapHistory::at(XrTime time) const {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) return std::nullopt;
  const std::size_t known = std::min(count_, kFrames);
  for (std::size_t back = 1; back < known; ++back) {
    const WorldMaps& maps = maps_[(count_ - back) % kFrames];
    if (maps.time <= time) return maps;
  }
  return maps_[(count_ - known) % kFrames];
}

}  // namespace forewalk::openxr
