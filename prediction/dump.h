// Prediction graphs for people and for other programs: JSON, GraphML, DOT and a plan in SVG.
//
// For reading, drawing and comparing, not for frames: these allocate. All are functions of their
// arguments alone; the same graph gives the same bytes.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "navmesh/nav_graph.h"
#include "prediction/distance_field.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// JSON, schema `forewalk.prediction/1`, one node or edge a line. Points are [x, y, z] in world
/// axes, metres; paths are lifted onto the surface, with a point wherever the ground bends. Numbers
/// are the shortest that read back to the same float; what is not finite becomes null. An edge that
/// leads through links lists them: id, length, the ends of the step, and whether people walk it in
/// the edge's direction.
///
/// `microseconds` is what the caller measured for making the graph (prediction reads no clock).
/// `graph` must have been predicted on `navGraph`.
std::string toJson(const navmesh::NavGraph& navGraph, const PredictionGraph& graph,
                   double microseconds);

/// GraphML with typed keys: opens in yEd (with places, colours and labels), Gephi and networkx.
/// Node places are x and y on the plan (y is -z, up on the page) and height, metres; edges have
/// length.
std::string toGraphml(const PredictionGraph& graph);

/// DOT for Graphviz, each node pinned to its place: `dot -Tsvg`, `neato` or `neato -n` draw it.
std::string toDot(const PredictionGraph& graph);

/// What a plan says beside the graph.
struct PlanText {
  std::string_view title;                    ///< empty: "Ways ahead within D m"
  std::optional<float> heading;              ///< of the user, radians; drawn as an arrow
  const DistanceField* distances = nullptr;  ///< run from the graph's source: drawn as colour below
                                             ///< the ways (distance_drawing.h); null: not drawn
  const navmesh::Links* links = nullptr;     ///< entries full, exits hollow; null: not drawn
};

/// The plan: walkable area, polygons, the user, branch nodes red, terminals green (dead ends
/// hollow), taut paths, loops dashed, scale bar and legend. Shows the whole navmesh where the ways
/// cover a fair part of it, else their surroundings.
std::string toSvg(const navmesh::NavGraph& navGraph, const PredictionGraph& graph,
                  const PlanText& text = {});

}  // namespace forewalk::prediction
