// Exact distances as colour on a plan, with lines of equal distance: a map of how far everything
// is.
//
// Nothing is sampled onto a grid. What a corner of the shortest paths sees of a polygon is a convex
// piece (DistanceField::Window), and there points at one distance lie on a circle about the corner:
// bands are such pieces cut at circles, painted from far to near so that the nearest corner wins,
// and lines are those arcs of the circles where no other corner is nearer.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "navmesh/nav_graph.h"
#include "prediction/distance_field.h"
#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::prediction {

/// A stretch of a line of equal distance: counter-clockwise about `centre` from angle `from` to
/// `to`, radians, from < to <= from + 2 pi. Plan, metres.
struct IsoArc {
  glm::dvec2 centre;
  double radius;  ///< > 0
  double from, to;
  double distance;    ///< of all its points from the source, metres
  PolygonId polygon;  ///< one that it passes through

  glm::dvec2 at(double angle) const {
    return centre + radius * glm::dvec2(glm::cos(angle), glm::sin(angle));
  }
};

/// All points at `distance` metres (> 0) from the source of the field's last run, as arcs; those of
/// one corner that touch are one, unless they lie on storeys that `storeyOf` tells apart (a number
/// per polygon; empty: one storey). Farther than the run is complete there are none. Sorted by
/// distance, corner and angle. O(polygons reached * windows of a polygon squared).
std::vector<IsoArc> isoLine(const navmesh::NavGraph& graph, const DistanceField& field,
                            double distance, std::span<const char> storeyOf = {});

/// The colour of a distance as a share of the horizon, clamped to [0, 1]: "#fdf3c0" near to indigo
/// far. Lightness falls evenly (OKLCh, B. Ottosson 2020), so that order survives in grey and for
/// most who see colours otherwise.
std::string distanceColour(double share);

/// Metres between two lines on plans out to `horizon` metres: 1 up to 25 m.
double isoStep(double horizon);

/// Paints what lies within the field's horizon, in bands and with lines every isoStep(), every
/// fifth line stronger and labelled; of polygons where `shown` (per polygon; empty: all) is not 0.
void drawDistances(SvgDrawing& drawing, const PlanPage& page, const navmesh::NavGraph& graph,
                   const DistanceField& field, std::span<const char> shown);

/// Draws arcs with `style` (attributes of ours; widths in tenths of a pixel).
void drawArcs(SvgDrawing& drawing, const PlanPage& page, std::span<const IsoArc> arcs,
              std::string_view style);

/// The scale of colours, at the upper right of the page.
void drawDistanceLegend(SvgDrawing& drawing, const PlanPage& page, double horizon);

}  // namespace forewalk::prediction
