// The navmesh seen from above, as a drawing: what every plan of ours begins with.
//
// North on the page is forward (-Z), east is +X. Walkable area softly filled with a crisp border,
// polygons faint, storeys that are not meant paler, a scale bar in metres, coordinates along the
// edge so that a reader can pick positions.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "navmesh/nav_graph.h"
#include "prediction/svg.h"

namespace forewalk::prediction {

/// An axis-parallel piece of the plan, metres. Empty until something is added.
struct PlanBounds {
  glm::dvec2 low{1e30};
  glm::dvec2 high{-1e30};

  void add(glm::dvec2 point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  bool empty() const { return low.x > high.x; }
  glm::dvec2 size() const { return high - low; }
};

/// Bounds of all polygons. O(corners).
PlanBounds boundsOf(const navmesh::NavGraph& graph);

/// The map from the plan (metres, y up) to the page (pixels, y down), and the page around it.
class PlanPage {
 public:
  /// A page that shows `bounds` (widened by a small margin) at a scale that fits about 1120 x 860
  /// pixels, with room for a title above and a legend below. Empty bounds show one metre about 0.
  explicit PlanPage(PlanBounds bounds);

  glm::dvec2 at(glm::dvec2 plan) const {
    return {(plan.x - bounds_.low.x) * scale_ + left_, (bounds_.high.y - plan.y) * scale_ + top_};
  }
  double scale() const { return scale_; }  ///< pixels per metre
  const PlanBounds& bounds() const { return bounds_; }
  glm::dvec2 corner() const { return {left_, top_}; }             ///< upper left of the map
  glm::dvec2 mapSize() const { return bounds_.size() * scale_; }  ///< of the map, pixels
  glm::dvec2 pageSize() const;
  double legendTop() const { return top_ + mapSize().y + 34; }  ///< where the legend may begin

 private:
  PlanBounds bounds_;
  double scale_;
  double left_ = 54;
  double top_ = 78;
};

/// Title and, under it, a line of smaller text.
void drawHeading(SvgDrawing& drawing, const PlanPage& page, std::string_view title,
                 std::string_view subtitle);

/// The walkable area. `emphasised[p]` false draws polygon p paler and below; empty emphasises all.
void drawWalkable(SvgDrawing& drawing, const PlanPage& page, const navmesh::NavGraph& graph,
                  std::span<const char> emphasised);

/// Only the border of the walkable area, where it is emphasised: over what covers it.
void drawWalls(SvgDrawing& drawing, const PlanPage& page, const navmesh::NavGraph& graph,
               std::span<const char> emphasised);

/// Coordinates along the left and lower edge, x and z in metres.
void drawCoordinates(SvgDrawing& drawing, const PlanPage& page);

/// A ruler in metres, at the right of the legend.
void drawScaleBar(SvgDrawing& drawing, const PlanPage& page);

/// One entry of a legend: its sign is drawn by the caller at the place this returns.
/// Entries flow to the right and wrap; `cursor` is kept between calls.
struct LegendCursor {
  glm::dvec2 next;
};
LegendCursor beginLegend(const PlanPage& page);
glm::dvec2 legendEntry(SvgDrawing& drawing, const PlanPage& page, LegendCursor& cursor,
                       std::string_view words);

/// A user: a dot with an arrow along `heading` (radians, counter-clockwise from north).
void drawUser(SvgDrawing& drawing, glm::dvec2 at, float heading, bool withHeading);

/// A round length near `value` for ticks: 1, 2 or 5 times a power of ten, at least `value`.
double roundStep(double value);

}  // namespace forewalk::prediction
