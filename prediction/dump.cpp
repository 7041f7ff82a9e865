#include "prediction/dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "navmesh/plan.h"
#include "prediction/distance_drawing.h"
#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::prediction {
namespace {

using navmesh::NavGraph;

// Keys in the order they are written, and floats printed as floats: 0.1f is "0.1", not
// "0.10000000149011612".
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool,
                                  std::int64_t, std::uint64_t, float>;

std::string_view nameOf(NodeKind kind) {
  switch (kind) {
    case NodeKind::kSource:
      return "source";
    case NodeKind::kBranch:
      return "branch";
    case NodeKind::kTerminal:
      return "terminal";
    case NodeKind::kJoin:
      return "join";
  }
  return "";
}

std::string_view nameOf(TerminalReason reason) {
  switch (reason) {
    case TerminalReason::kNone:
      return "";
    case TerminalReason::kHorizon:
      return "horizon";
    case TerminalReason::kDeadEnd:
      return "dead_end";
    case TerminalReason::kMeeting:
      return "meeting";
  }
  return "";
}

std::string_view nameOf(EdgeKind kind) { return kind == EdgeKind::kTree ? "tree" : "loop"; }

Json pointOf(glm::vec3 point) { return Json::array({point.x, point.y, point.z}); }

Json pathOf(const NavGraph& navGraph, const PredictionGraph& graph, const Edge& edge) {
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  liftEdge(navGraph, graph, edge, portals, lifted);
  Json points = Json::array();
  for (const glm::vec3 point : lifted) points.push_back(pointOf(point));
  return points;
}

/// Where a link's step begins and ends, in the edge's direction.
std::pair<glm::vec3, glm::vec3> endsOf(const NavGraph& navGraph, const PredictionGraph& graph,
                                       const Edge& edge, const LinkStep& step) {
  const auto path = graph.pathOf(edge);
  const auto corridor = graph.corridorOf(edge);
  const auto onGround = [&](PolygonId polygon, glm::vec2 plan) {
    return navmesh::toSpace(plan, navmesh::heightAt(navGraph, polygon, plan));
  };
  return {step.polygons == 0 ? graph.node(edge.from).position()
                             : onGround(corridor[step.polygons - 1], path[step.point]),
          onGround(corridor[step.polygons], path[step.point + 1])};
}

Json nodeToJson(const PredictionGraph& graph, std::size_t i) {
  const Node& node = graph.nodes[i];
  Json json = {{"id", i}, {"kind", nameOf(node.kind)}};
  if (node.reason != TerminalReason::kNone) json["reason"] = nameOf(node.reason);
  if (node.kind != NodeKind::kBranch && node.branch) json["branch"] = true;
  json["polygon"] =
      node.polygon == navmesh::kNoPolygon ? Json() : Json(navmesh::index(node.polygon));
  json["position"] = pointOf(node.position());
  json["distance"] = node.distance;
  json["prev"] = node.prev == kNoNode ? Json() : Json(index(node.prev));
  if (graph.method == Method::kFront && node.kind == NodeKind::kTerminal) {
    const auto found = std::lower_bound(graph.terminals.begin(), graph.terminals.end(),
                                        NodeId{static_cast<std::uint32_t>(i)});
    const Front& front = graph.fronts[static_cast<std::size_t>(found - graph.terminals.begin())];
    json["front"] = {{"from", pointOf(navmesh::toSpace(front.from, node.height))},
                     {"to", pointOf(navmesh::toSpace(front.to, node.height))},
                     {"length", front.length}};
  }
  return json;
}

Json edgeToJson(const NavGraph& navGraph, const PredictionGraph& graph, const Edge& edge) {
  Json polygons = Json::array();
  const bool listed = graph.method == Method::kPolygon;
  for (const PolygonId polygon : listed ? graph.corridorOf(edge) : std::span<const PolygonId>{})
    polygons.push_back(navmesh::index(polygon));
  Json json = {{"from", index(edge.from)},  {"to", index(edge.to)},
               {"kind", nameOf(edge.kind)}, {"length", edge.length},
               {"polygons", polygons},      {"path", pathOf(navGraph, graph, edge)}};
  if (graph.method == Method::kFront) json["width"] = edge.width;
  const std::span<const LinkStep> steps = graph.linkStepsOf(edge);
  if (steps.empty()) return json;
  Json links = Json::array();
  for (const LinkStep& step : steps) {
    const auto [from, to] = endsOf(navGraph, graph, edge, step);
    links.push_back({{"id", navmesh::index(step.link)},
                     {"length", step.length},
                     {"from", pointOf(from)},
                     {"to", pointOf(to)},
                     {"forward", step.forward}});
  }
  json["links"] = links;
  return json;
}

// A list with one element a line: readable, and a `diff` of two dumps names the nodes that differ.
template <typename Element>
void appendList(std::string& text, std::string_view name, std::size_t count, Element&& element) {
  fmt::format_to(std::back_inserter(text), "  \"{}\": [", name);
  for (std::size_t i = 0; i < count; ++i) {
    text += i == 0 ? "\n    " : ",\n    ";
    text += element(i).dump();
  }
  text += count == 0 ? "],\n" : "\n  ],\n";
}

// Colours and sizes are the same in every format, so that a person finds a node again.
struct Look {
  std::string_view fill;
  std::string_view border;
};

Look lookOf(const Node& node) {
  constexpr std::string_view kGreen = "#1f9d55", kRed = "#d6353a", kBlue = "#123a7a",
                             kViolet = "#8a5bb8";
  switch (node.kind) {
    case NodeKind::kSource:
      return {kBlue, kBlue};
    case NodeKind::kBranch:
      return {kRed, kRed};
    case NodeKind::kJoin:
      return {kViolet, kViolet};
    case NodeKind::kTerminal:
      break;
  }
  if (node.reason == TerminalReason::kMeeting) return {"#ffffff", kViolet};
  if (node.reason == TerminalReason::kDeadEnd) return {"#ffffff", kGreen};
  return {kGreen, kGreen};
}

}  // namespace

std::string toJson(const NavGraph& navGraph, const PredictionGraph& graph, double microseconds) {
  const navmesh::Location& at = graph.source;
  const Json source = {
      {"position", pointOf(at.position())},
      {"polygon", at.polygon == navmesh::kNoPolygon ? Json() : Json(navmesh::index(at.polygon))}};
  const Json stats = {{"settled", graph.stats.settled},
                      {"relaxed", graph.stats.relaxed},
                      {"microseconds", static_cast<float>(microseconds)}};
  std::string text = "{\n  \"format\": \"forewalk.prediction/1\",\n";
  fmt::format_to(std::back_inserter(text), "  \"method\": \"{}\",\n",
                 graph.method == Method::kFront ? "front" : "polygon");
  fmt::format_to(std::back_inserter(text), "  \"horizon\": {},\n  \"complete_to\": {},\n",
                 Json(graph.horizon).dump(), Json(graph.completeTo).dump());
  fmt::format_to(std::back_inserter(text), "  \"source\": {},\n", source.dump());
  appendList(text, "nodes", graph.nodes.size(),
             [&](std::size_t i) { return nodeToJson(graph, i); });
  appendList(text, "edges", graph.edges.size(),
             [&](std::size_t i) { return edgeToJson(navGraph, graph, graph.edges[i]); });
  fmt::format_to(std::back_inserter(text), "  \"stats\": {}\n}}\n", stats.dump());
  return text;
}

std::string toGraphml(const PredictionGraph& graph) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\"\n"
      "         xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n"
      "         xmlns:y=\"http://www.yworks.com/xml/graphml\"\n"
      "         xsi:schemaLocation=\"http://graphml.graphdrawing.org/xmlns "
      "http://www.yworks.com/xml/schema/graphml/1.1/ygraphml.xsd\">\n"
      "  <key id=\"drawn_node\" for=\"node\" yfiles.type=\"nodegraphics\"/>\n"
      "  <key id=\"drawn_edge\" for=\"edge\" yfiles.type=\"edgegraphics\"/>\n";
  const auto key = [&](std::string_view name, std::string_view on, std::string_view type,
                       std::string_view meaning) {
    fmt::format_to(std::back_inserter(text),
                   "  <key id=\"{1}_{0}\" for=\"{1}\" attr.name=\"{0}\" attr.type=\"{2}\">"
                   "<desc>{3}</desc></key>\n",
                   name, on, type, meaning);
  };
  key("horizon", "graph", "double", "how far ahead was predicted, metres");
  key("kind", "node", "string", "source, branch or terminal");
  key("reason", "node", "string",
      "why prediction stops at a terminal: horizon, dead_end or meeting");
  key("branch", "node", "boolean", "a polygon with more than two neighbours");
  key("polygon", "node", "long", "of the navmesh");
  key("x", "node", "double", "world x, metres");
  key("y", "node", "double", "minus world z, metres: up on the page is forward");
  key("height", "node", "double", "world y, metres");
  key("distance", "node", "double", "length of the taut path from the source, metres");
  key("kind", "edge", "string", "tree or loop");
  key("length", "edge", "double", "of the taut path, metres");
  if (!graph.linkSteps.empty()) key("link", "edge", "long", "the first link that it leads through");
  fmt::format_to(std::back_inserter(text),
                 "  <graph id=\"prediction\" edgedefault=\"undirected\">\n"
                 "    <data key=\"graph_horizon\">{}</data>\n",
                 Json(graph.horizon).dump());
  constexpr float kYedPixels = 40.0f;  // a metre in yEd
  const auto number = [](float value) {
    return fmt::format("{}", std::isfinite(value) ? value : 0.0f);
  };
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const Node& node = graph.nodes[i];
    const Look look = lookOf(node);
    constexpr float kSize = 16.0f;
    fmt::format_to(std::back_inserter(text), "    <node id=\"n{}\">\n", i);
    fmt::format_to(
        std::back_inserter(text),
        "      <data key=\"drawn_node\"><y:ShapeNode><y:Geometry height=\"{0}\" width=\"{0}\" "
        "x=\"{1}\" y=\"{2}\"/><y:Fill color=\"{3}\" transparent=\"false\"/><y:BorderStyle "
        "color=\"{4}\" type=\"line\" width=\"2.0\"/><y:NodeLabel fontSize=\"9\" "
        "modelName=\"corners\" "
        "modelPosition=\"se\">{5}: {6:.1f} m</y:NodeLabel><y:Shape type=\"{7}\"/></y:ShapeNode>"
        "</data>\n",
        kSize, number(node.plan.x * kYedPixels - kSize / 2),
        number(-node.plan.y * kYedPixels - kSize / 2), look.fill, look.border, i, node.distance,
        node.kind == NodeKind::kSource ? "diamond" : "ellipse");
    // After the drawing, because networkx takes x and y from whichever comes last.
    fmt::format_to(std::back_inserter(text), "      <data key=\"node_kind\">{}</data>\n",
                   nameOf(node.kind));
    if (node.reason != TerminalReason::kNone) {
      fmt::format_to(std::back_inserter(text), "      <data key=\"node_reason\">{}</data>\n",
                     nameOf(node.reason));
    }
    fmt::format_to(std::back_inserter(text),
                   "      <data key=\"node_branch\">{}</data>\n"
                   "      <data key=\"node_polygon\">{}</data>\n"
                   "      <data key=\"node_x\">{}</data>\n"
                   "      <data key=\"node_y\">{}</data>\n"
                   "      <data key=\"node_height\">{}</data>\n"
                   "      <data key=\"node_distance\">{}</data>\n    </node>\n",
                   node.branch,
                   node.polygon == navmesh::kNoPolygon ? std::int64_t{-1}
                                                       : std::int64_t{navmesh::index(node.polygon)},
                   number(node.plan.x), number(node.plan.y), number(node.height),
                   number(node.distance));
  }
  for (std::size_t i = 0; i < graph.edges.size(); ++i) {
    const Edge& edge = graph.edges[i];
    const bool tree = edge.kind == EdgeKind::kTree;
    fmt::format_to(std::back_inserter(text),
                   "    <edge id=\"e{}\" source=\"n{}\" target=\"n{}\">\n"
                   "      <data key=\"drawn_edge\"><y:PolyLineEdge><y:LineStyle color=\"{}\" "
                   "type=\"{}\" width=\"2.0\"/></y:PolyLineEdge></data>\n"
                   "      <data key=\"edge_kind\">{}</data>\n"
                   "      <data key=\"edge_length\">{}</data>\n",
                   i, index(edge.from), index(edge.to), tree ? "#2f5fb3" : "#8a5bb8",
                   tree ? "line" : "dashed", nameOf(edge.kind), number(edge.length));
    if (const auto steps = graph.linkStepsOf(edge); !steps.empty()) {
      fmt::format_to(std::back_inserter(text), "      <data key=\"edge_link\">{}</data>\n",
                     navmesh::index(steps.front().link));
    }
    text += "    </edge>\n";
  }
  text += "  </graph>\n</graphml>\n";
  return text;
}

std::string toDot(const PredictionGraph& graph) {
  constexpr float kPoints = 36.0f;  // a metre; inputscale says that places are in points
  std::string text = fmt::format(
      "graph prediction {{\n"
      "  graph [layout=neato, inputscale=72, outputorder=edgesfirst, splines=line, labelloc=t,\n"
      "         fontname=\"Helvetica\", label=\"Ways ahead within {:.4g} m\"];\n"
      "  node [shape=circle, fixedsize=true, width=0.16, label=\"\", style=filled, penwidth=1.5,\n"
      "        fontname=\"Helvetica\", fontsize=8];\n"
      "  edge [fontname=\"Helvetica\", fontsize=7, fontcolor=\"#5a6675\", color=\"#2f5fb3\"];\n",
      graph.horizon);
  const auto number = [](float value) { return std::isfinite(value) ? value : 0.0f; };
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const Node& node = graph.nodes[i];
    const Look look = lookOf(node);
    fmt::format_to(std::back_inserter(text),
                   "  n{} [pos=\"{:.2f},{:.2f}!\", fillcolor=\"{}\", color=\"{}\", xlabel=\"{}\", "
                   "tooltip=\"{}{}{}, polygon {}, {:.2f} m\"{}];\n",
                   i, number(node.plan.x) * kPoints, number(node.plan.y) * kPoints, look.fill,
                   look.border, i, nameOf(node.kind),
                   node.reason == TerminalReason::kNone ? "" : ": ", nameOf(node.reason),
                   navmesh::index(node.polygon), number(node.distance),
                   node.kind == NodeKind::kSource ? ", width=0.24" : "");
  }
  for (const Edge& edge : graph.edges) {
    const bool linked = !graph.linkStepsOf(edge).empty();
    fmt::format_to(std::back_inserter(text), "  n{} -- n{} [label=\"{:.1f}\", len={:.4f}{}{}];\n",
                   index(edge.from), index(edge.to), number(edge.length),
                   std::max(number(edge.length) * kPoints / 72.0f, 0.01f),
                   edge.kind == EdgeKind::kLoop ? ", style=dashed, color=\"#8a5bb8\"" : "",
                   linked ? ", fontcolor=\"#d9822b\", penwidth=2" : "");
  }
  text += "}\n";
  return text;
}

namespace {

// Half of a low storey: what is less far above or below belongs to the same storey, metres.
constexpr float kStorey = 1.3f;

bool nearSource(const PredictionGraph& graph, float height) {
  return std::abs(height - graph.source.height) < kStorey;
}

std::vector<char> emphasisOf(const NavGraph& navGraph, const PredictionGraph& graph) {
  std::vector<char> emphasised(navGraph.polygonCount(), 0);
  for (std::uint32_t p = 0; p < navGraph.polygonCount(); ++p) {
    emphasised[p] = nearSource(graph, navGraph.centroidHeight[p]);
  }
  return emphasised;
}

PlanBounds shownBounds(const NavGraph& navGraph, const PredictionGraph& graph) {
  PlanBounds all = boundsOf(navGraph);
  PlanBounds ways;
  for (const Node& node : graph.nodes) ways.add(node.plan);
  for (const glm::vec2 point : graph.pathPoints) ways.add(point);
  for (const PolygonId polygon : graph.corridorPolygons) {
    for (const glm::vec2 corner : navGraph.ringOf(polygon)) ways.add(corner);
  }
  if (all.empty() || ways.empty()) return all.empty() ? ways : all;
  const glm::dvec2 covered = ways.size();
  const double worth = 3.0 * std::max({covered.x, covered.y, 8.0});
  if (std::max(all.size().x, all.size().y) <= worth) return all;
  const double margin = std::max(3.0, 0.15 * std::max(covered.x, covered.y));
  return {glm::max(all.low, ways.low - margin), glm::min(all.high, ways.high + margin)};
}

// Finds places for labels where nothing lies yet; those that find none are left out.
class Labels {
 public:
  void block(glm::dvec2 centre, double radius) {
    taken_.emplace_back(centre - radius, centre + radius);
  }

  // Beside `at`, rather on the side of `outward` than on another.
  bool place(const PlanPage& page, glm::dvec2 at, glm::dvec2 outward, glm::dvec2 size,
             glm::dvec2& centre) {
    const glm::dvec2 sides[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    std::vector<glm::dvec2> candidates(std::begin(sides), std::end(sides));
    std::stable_sort(candidates.begin(), candidates.end(), [&](glm::dvec2 a, glm::dvec2 b) {
      return glm::dot(a, outward) > glm::dot(b, outward);
    });
    for (const glm::dvec2 side : candidates) {
      centre = at + side * (0.5 * size + 7.0);
      const glm::dvec2 low = centre - 0.5 * size, high = centre + 0.5 * size;
      const glm::dvec2 end = page.corner() + page.mapSize();
      if (low.x < page.corner().x || low.y < page.corner().y || high.x > end.x || high.y > end.y ||
          overlaps(low, high)) {
        continue;
      }
      taken_.emplace_back(low, high);
      return true;
    }
    return false;
  }

 private:
  bool overlaps(glm::dvec2 low, glm::dvec2 high) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const auto& box) {
      return low.x < box.second.x && low.y < box.second.y && box.first.x < high.x &&
             box.first.y < high.y;
    });
  }

  std::vector<std::pair<glm::dvec2, glm::dvec2>> taken_;
};

constexpr std::string_view kTreeStyle = "fill=\"none\" stroke=\"#2f5fb3\" stroke-width=\"2.4\"";
constexpr std::string_view kLoopStyle =
    "fill=\"none\" stroke=\"#8a5bb8\" stroke-width=\"2\" stroke-dasharray=\"2 5\"";

constexpr std::string_view kLoopOverColours =
    "fill=\"none\" stroke=\"#4b1f7a\" stroke-width=\"2\" stroke-dasharray=\"2 5\"";

constexpr std::string_view kLinkStyle =
    "fill=\"none\" stroke=\"#d9822b\" stroke-width=\"2.4\" stroke-dasharray=\"7 4\"";

constexpr std::string_view kFrontStyle =
    "stroke=\"#1f9d55\" stroke-opacity=\"0.45\" stroke-width=\"5\" stroke-linecap=\"round\"";

void drawNode(SvgDrawing& drawing, glm::dvec2 at, const Node& node) {
  const Look look = lookOf(node);
  if (node.kind == NodeKind::kBranch || node.kind == NodeKind::kJoin) {
    drawing.circle(at, 4.6,
                   fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.4\"", look.fill));
  } else if (node.reason != TerminalReason::kHorizon) {
    drawing.circle(at, 4.8,
                   fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"2.6\"", look.border));
  } else {
    drawing.circle(at, 6.2,
                   fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.6\"", look.fill));
  }
}

/// Their ends, and thin between them, whether a way leads through or not.
void drawLinks(SvgDrawing& drawing, const PlanPage& page, const navmesh::Links& links) {
  for (const navmesh::LinkWay& way : links.ways) {
    const glm::dvec2 entry = page.at(way.entry), exit = page.at(way.exit);
    if (!way.back) {
      drawing.line(entry, exit, "stroke=\"#d9822b\" stroke-opacity=\"0.5\" stroke-width=\"1\"");
    }
    drawing.circle(entry, 3.4, "fill=\"#d9822b\" stroke=\"#ffffff\" stroke-width=\"1\"");
    drawing.circle(exit, 3.4, "fill=\"#ffffff\" fill-opacity=\"0.6\" stroke=\"#d9822b\"");
  }
}

Node exampleNode(NodeKind kind, TerminalReason reason) {
  Node node{};
  node.kind = kind;
  node.reason = reason;
  return node;
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string describe(const PredictionGraph& graph) {
  std::size_t branches = 0, horizon = 0, deadEnds = 0, meetings = 0, joins = 0, loops = 0;
  for (const Node& node : graph.nodes) {
    branches += node.branch;
    joins += node.kind == NodeKind::kJoin;
    horizon += node.reason == TerminalReason::kHorizon;
    deadEnds += node.reason == TerminalReason::kDeadEnd;
    meetings += node.reason == TerminalReason::kMeeting;
  }
  for (const Edge& edge : graph.edges) loops += edge.kind == EdgeKind::kLoop;
  std::string text = fmt::format(
      "Horizon {:.4g} m from ({:.4g}, {:.4g}, {:.4g}): {}, {} ({} at the horizon, {}{}), {}",
      graph.horizon, graph.source.plan.x, graph.source.height, -graph.source.plan.y,
      counted(branches, "branch node", "branch nodes"),
      counted(graph.terminals.size(), "terminal", "terminals"), horizon,
      counted(deadEnds, "dead end", "dead ends"),
      meetings > 0 ? fmt::format(", {} in a meeting", meetings) : "",
      counted(loops, "loop edge", "loop edges"));
  if (joins > 0) text += fmt::format(", {}", counted(joins, "join", "joins"));
  if (graph.flags & kPolygonLimit) {
    text += fmt::format("; polygon limit reached, complete to {:.4g} m only", graph.completeTo);
  }
  return text;
}

}  // namespace

std::string toSvg(const NavGraph& navGraph, const PredictionGraph& graph, const PlanText& text) {
  const PlanPage page(shownBounds(navGraph, graph));
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  const std::string title = text.title.empty()
                                ? fmt::format("Ways ahead within {:.4g} m", graph.horizon)
                                : std::string(text.title);
  drawing.title(title);
  drawHeading(drawing, page, title, describe(graph));
  const std::vector<char> emphasised = emphasisOf(navGraph, graph);
  drawWalkable(drawing, page, navGraph, emphasised);
  const bool coloured = text.distances != nullptr;
  std::vector<IsoArc> horizonLine;
  if (coloured) {
    drawDistanceLegend(drawing, page, static_cast<double>(text.distances->completeTo()));
    horizonLine = isoLine(navGraph, *text.distances, graph.completeTo, emphasised);
  }

  const auto trace = [&](std::span<const glm::vec2> points) {
    std::vector<glm::dvec2> onPage;
    for (const glm::vec2 point : points) onPage.push_back(page.at(point));
    return onPage;
  };
  drawing.beginClip(page.corner(), page.mapSize());
  // Whole ways from the source, broad and soft: where many lie together, the colour is strong.
  const auto drawWays = [&](std::string_view style, std::string_view far, const auto& isWanted) {
    std::vector<glm::vec3> way;
    drawing.beginGroup(style);
    for (const NodeId terminal : graph.terminals) {
      const bool near = nearSource(graph, graph.node(terminal).height);
      if (!isWanted(near)) continue;
      wayTo(graph, terminal, way);
      std::vector<glm::dvec2> points;
      for (const glm::vec3 point : way) points.push_back(page.at(navmesh::toPlan(point)));
      drawing.polyline(points, false, near ? "" : far);
    }
    drawing.endGroup();
  };
  if (!coloured) {
    drawWays("fill=\"none\" stroke=\"#5b8def\" stroke-opacity=\"0.13\" stroke-width=\"9\"",
             "stroke-opacity=\"0.06\"", [](bool) { return true; });
  }
  // What lies on other storeys first and pale, then what lies near.
  for (const bool near : {false, true}) {
    drawing.beginGroup(near ? "opacity=\"1\"" : "opacity=\"0.3\"");
    if (coloured) {
      std::vector<char> shown;
      for (const char strong : emphasised) shown.push_back((strong != 0) == near);
      drawDistances(drawing, page, navGraph, *text.distances, shown);
      if (near) drawWalls(drawing, page, navGraph, emphasised);
      std::vector<IsoArc> fronts;
      for (const IsoArc& arc : horizonLine) {
        if (shown[index(arc.polygon)]) fronts.push_back(arc);
      }
      drawArcs(drawing, page, fronts, "stroke=\"#1f9d55\" stroke-width=\"40\"");
      // Whole ways: they stand out best as one thing, and hang together.
      const auto isHere = [&](bool wayNear) { return wayNear == near; };
      drawWays("fill=\"none\" stroke=\"#ffffff\" stroke-opacity=\"0.7\" stroke-width=\"5\"", "",
               isHere);
      drawWays("fill=\"none\" stroke=\"#16273d\" stroke-width=\"2\"", "", isHere);
    }
    for (const EdgeKind kind : {EdgeKind::kLoop, EdgeKind::kTree}) {
      if (coloured && kind == EdgeKind::kTree) continue;
      drawing.beginGroup(kind == EdgeKind::kTree ? kTreeStyle
                         : coloured              ? kLoopOverColours
                                                 : kLoopStyle);
      for (const Edge& edge : graph.edges) {
        const bool edgeNear = nearSource(graph, graph.node(edge.from).height) ||
                              nearSource(graph, graph.node(edge.to).height);
        if (edge.kind != kind || edgeNear != near) continue;
        const auto path = graph.pathOf(edge);
        std::size_t begin = 0;
        for (const LinkStep& step : graph.linkStepsOf(edge)) {
          drawing.polyline(trace(path.subspan(begin, step.point + 1 - begin)), false, "");
          drawing.line(page.at(path[step.point]), page.at(path[step.point + 1]), kLinkStyle);
          begin = step.point + 1;
        }
        drawing.polyline(trace(path.subspan(begin)), false, "");
      }
      drawing.endGroup();
    }
    for (std::size_t i = 0; i < graph.fronts.size() && !coloured; ++i) {
      const Front& front = graph.fronts[i];
      if (nearSource(graph, graph.node(graph.terminals[i]).height) != near) continue;
      drawing.line(page.at(front.from), page.at(front.to), kFrontStyle);
    }
    for (const NodeKind kind : {NodeKind::kBranch, NodeKind::kJoin, NodeKind::kTerminal}) {
      for (const Node& node : graph.nodes) {
        if (node.kind == kind && nearSource(graph, node.height) == near) {
          drawNode(drawing, page.at(node.plan), node);
        }
      }
    }
    drawing.endGroup();
  }
  // How far off the dead ends are; of the other terminals most are at the horizon.
  Labels labels;
  for (const Node& node : graph.nodes) labels.block(page.at(node.plan), 5);
  labels.block(page.at(graph.source.plan), 14);
  drawing.beginGroup(
      "paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-opacity=\"0.85\"");
  for (const NodeId id : graph.terminals) {
    const Node& node = graph.node(id);
    if (node.reason != TerminalReason::kDeadEnd || !nearSource(graph, node.height)) continue;
    const WayPoint end = pointAlong(graph, id, node.distance);
    const std::string words = fmt::format("{:.3g} m", node.distance);
    const glm::dvec2 size = {textWidth(words) * 11, 12};
    glm::dvec2 centre;
    if (labels.place(page, page.at(node.plan), {end.direction.x, -end.direction.y}, size, centre)) {
      drawing.text(centre + glm::dvec2(0, 4), words, 11, Anchor::kMiddle, "fill=\"#3a6b50\"");
    }
  }
  drawing.endGroup();
  if (text.links != nullptr) drawLinks(drawing, page, *text.links);
  drawUser(drawing, page.at(graph.source.plan), text.heading.value_or(0.0f),
           text.heading.has_value());
  drawing.endGroup();

  drawCoordinates(drawing, page);
  drawScaleBar(drawing, page);
  LegendCursor cursor = beginLegend(page);
  drawing.circle(legendEntry(drawing, page, cursor, "source (the user)"), 6.5, "fill=\"#123a7a\"");
  drawNode(drawing, legendEntry(drawing, page, cursor, "branch node"),
           exampleNode(NodeKind::kBranch, TerminalReason::kNone));
  if (graph.method == Method::kFront) {
    drawNode(drawing, legendEntry(drawing, page, cursor, "join"),
             exampleNode(NodeKind::kJoin, TerminalReason::kNone));
  }
  drawNode(drawing,
           legendEntry(drawing, page, cursor, fmt::format("horizon, {:.4g} m", graph.horizon)),
           exampleNode(NodeKind::kTerminal, TerminalReason::kHorizon));
  drawNode(drawing, legendEntry(drawing, page, cursor, "dead end"),
           exampleNode(NodeKind::kTerminal, TerminalReason::kDeadEnd));
  glm::dvec2 at = legendEntry(drawing, page, cursor, "taut path");
  drawing.line(at - glm::dvec2(12, 0), at + glm::dvec2(12, 0),
               coloured ? "stroke=\"#16273d\" stroke-width=\"2\"" : kTreeStyle);
  at = legendEntry(drawing, page, cursor, "loop");
  drawing.line(at - glm::dvec2(12, 0), at + glm::dvec2(12, 0),
               coloured ? kLoopOverColours : kLoopStyle);
  if (text.links != nullptr && !text.links->empty()) {
    at = legendEntry(drawing, page, cursor, "link");
    drawing.line(at - glm::dvec2(12, 0), at + glm::dvec2(12, 0), kLinkStyle);
  }
  return drawing.finish();
}

}  // namespace forewalk::prediction
