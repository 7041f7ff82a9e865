// From where each polygon is seen: the windows of a distance field, side by side with their roots.
//
// A distance field (distance_field.h) lists windows in the order they were found. What looks along
// walls and fronts asks again and again for all windows of one polygon; here they lie together.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prediction/distance_field.h"

namespace forewalk::prediction {

/// The part of a polygon that a root sees: all of it, or what lies between two rays.
struct View {
  glm::dvec2 root;         ///< metres
  double distance;         ///< of the root from the source, metres
  glm::dvec2 left, right;  ///< the rays that bound it, from the root, any length
  std::uint32_t corner;    ///< the root: index into DistanceField::corners()
  bool whole;              ///< the polygon touches the root and is seen whole, whatever the rays

  /// Whether `point`, in the polygon, is seen, rays included. Rounding may put a point that lies on
  /// a ray beside it by a micrometre.
  bool sees(glm::dvec2 point) const {
    if (whole) return true;
    const glm::dvec2 ray = point - root;
    return within(ray.x * left.y - ray.y * left.x, left) &&
           within(right.x * ray.y - right.y * ray.x, right);
  }

 private:
  static bool within(double side, glm::dvec2 bound) {
    constexpr double kSlack = 1e-6;
    return side >= 0.0 || side * side <= kSlack * kSlack * glm::dot(bound, bound);
  }
};

/// All views of one run of a distance field. One per user.
class Views {
 public:
  /// For navgraphs of `polygons` polygons and fields of up to `windows` windows.
  Views(std::uint32_t polygons, std::uint32_t windows);

  /// Replaces all views by those of `field`. O(windows); allocates only while the buffer grows to
  /// the largest field seen.
  void gather(const DistanceField& field);

  /// Of a polygon; none where it was not reached. They live until the next gather.
  std::span<const View> of(PolygonId polygon) const {
    const Range range = ranges_[index(polygon)];
    return {views_.data() + range.begin, range.count};
  }

 private:
  struct Range {
    std::uint32_t begin = 0, count = 0;
  };
  std::vector<Range> ranges_;       // per polygon
  std::vector<PolygonId> touched_;  // those whose range is not empty
  std::vector<View> views_;
};

/// Length of the shortest way to `point` in the polygon of `views`, metres, and the view that it
/// comes by; infinity and null where none sees it.
struct Nearest {
  double distance;
  const View* view;
};
Nearest nearestOf(std::span<const View> views, glm::dvec2 point);

}  // namespace forewalk::prediction
