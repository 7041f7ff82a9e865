#include "prediction/views.h"

#include <algorithm>
#include <limits>

namespace forewalk::prediction {

Views::Views(std::uint32_t polygons, std::uint32_t windows) : ranges_(polygons) {
  const std::uint32_t reachable = std::min(polygons, windows);
  touched_.reserve(reachable);
  views_.reserve(std::min<std::size_t>(windows, 64 + 8 * std::size_t{reachable}));
}

void Views::gather(const DistanceField& field) {
  for (const PolygonId polygon : touched_) ranges_[index(polygon)] = {};
  touched_.assign(field.polygons().begin(), field.polygons().end());
  const std::span<const Window> windows = field.windows();
  views_.resize(windows.size());
  std::uint32_t next = 0;
  for (const PolygonId polygon : touched_) {
    const std::uint32_t begin = next;
    for (std::uint32_t w = field.firstWindow(polygon); w != kNone; w = windows[w].next) {
      const Window& window = windows[w];
      View& view = views_[next++];
      view.root = glm::dvec2(field.corners()[window.corner].plan);
      view.distance = field.exactDistance(window.corner);
      view.left = window.left;
      view.right = window.right;
      view.corner = window.corner;
      view.whole = window.portal == kNone;
    }
    ranges_[index(polygon)] = {begin, next - begin};
  }
}

Nearest nearestOf(std::span<const View> views, glm::dvec2 point) {
  Nearest nearest{std::numeric_limits<double>::infinity(), nullptr};
  for (const View& view : views) {
    const double length = view.distance + glm::length(point - view.root);
    if (length < nearest.distance && view.sees(point)) nearest = {length, &view};
  }
  return nearest;
}

}  // namespace forewalk::prediction
