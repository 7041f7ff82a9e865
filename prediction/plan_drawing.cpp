#include "prediction/plan_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::prediction {
namespace {

using navmesh::NavGraph;
using navmesh::Portal;

constexpr double kWidth = 1120;  // of the map at most, pixels
constexpr double kHeight = 860;
constexpr double kScaleMax = 90;  // pixels per metre: a single room should not fill a wall
constexpr double kRight = 30;
constexpr double kLegendHeight = 66;

// Stretches of the edge from `a` to `b` that no portal covers, as pairs of parameters in [0, 1].
std::vector<std::pair<double, double>> closedStretches(glm::dvec2 a, glm::dvec2 b,
                                                       std::vector<Portal>& portals) {
  const glm::dvec2 along = b - a;
  const double squared = glm::dot(along, along);
  if (squared <= 0.0) return {};
  std::vector<std::pair<double, double>> open;
  for (const Portal& portal : portals) {
    double from = glm::dot(glm::dvec2(portal.left) - a, along) / squared;
    double to = glm::dot(glm::dvec2(portal.right) - a, along) / squared;
    if (from > to) std::swap(from, to);
    open.emplace_back(from, to);
  }
  std::sort(open.begin(), open.end());
  std::vector<std::pair<double, double>> closed;
  double reached = 0.0;
  constexpr double kSlit = 1e-3;  // rounding of portal ends must not leave specks of wall
  for (const auto& [from, to] : open) {
    if (from > reached + kSlit) closed.emplace_back(reached, from);
    reached = std::max(reached, to);
  }
  if (reached < 1.0 - kSlit) closed.emplace_back(reached, 1.0);
  return closed;
}

constexpr std::string_view kWallColour = "#3f4e5e";

void addBorders(std::string& borders, const PlanPage& page, const NavGraph& graph,
                std::uint32_t polygon) {
  const auto ring = graph.ringOf(navmesh::PolygonId{polygon});
  std::vector<Portal> onEdge;
  for (std::size_t edge = 0; edge < ring.size(); ++edge) {
    onEdge.clear();
    for (std::uint32_t h = graph.portalStart[polygon]; h < graph.portalStart[polygon + 1]; ++h) {
      if (graph.portalEdge[h] == edge) onEdge.push_back(graph.portals[h]);
    }
    const glm::dvec2 a = ring[edge];
    const glm::dvec2 b = ring[(edge + 1) % ring.size()];
    for (const auto& [from, to] : closedStretches(a, b, onEdge)) {
      moveTo(borders, page.at(glm::mix(a, b, from)));
      lineTo(borders, page.at(glm::mix(a, b, to)));
    }
  }
}

}  // namespace

PlanBounds boundsOf(const NavGraph& graph) {
  PlanBounds bounds;
  for (const glm::vec2 corner : graph.ring) bounds.add(corner);
  return bounds;
}

PlanPage::PlanPage(PlanBounds bounds) : bounds_(bounds) {
  if (bounds_.empty()) bounds_ = {{-0.5, -0.5}, {0.5, 0.5}};
  const double margin = std::clamp(0.02 * std::max(bounds_.size().x, bounds_.size().y), 0.3, 2.0);
  bounds_.low -= margin;
  bounds_.high += margin;
  scale_ = std::min({kWidth / bounds_.size().x, kHeight / bounds_.size().y, kScaleMax});
  // A narrow map still needs the width of its title and legend.
  const double narrow = 760 - mapSize().x;
  if (narrow > 0) {
    bounds_.low.x -= 0.5 * narrow / scale_;
    bounds_.high.x += 0.5 * narrow / scale_;
  }
}

glm::dvec2 PlanPage::pageSize() const {
  return {left_ + mapSize().x + kRight, legendTop() + kLegendHeight};
}

void drawHeading(SvgDrawing& drawing, const PlanPage& page, std::string_view title,
                 std::string_view subtitle) {
  drawing.text({page.corner().x, 38}, title, 23, Anchor::kStart,
               "fill=\"#1d2733\" font-weight=\"bold\"");
  drawing.text({page.corner().x, 61}, subtitle, 13.5, Anchor::kStart, "fill=\"#5a6675\"");
}

void drawWalkable(SvgDrawing& drawing, const PlanPage& page, const NavGraph& graph,
                  std::span<const char> emphasised) {
  // The outline is half outside the fill, so that storeys below do not shine through at the edge.
  const auto drawLayer = [&](const std::vector<std::uint32_t>& polygons, std::string_view fill,
                             std::string_view seam, std::string_view border) {
    std::string areas, borders;
    for (const std::uint32_t polygon : polygons) {
      const auto ring = graph.ringOf(navmesh::PolygonId{polygon});
      for (std::size_t i = 0; i < ring.size(); ++i) {
        (i == 0 ? moveTo : lineTo)(areas, page.at(ring[i]));
      }
      areas += 'Z';
      addBorders(borders, page, graph, polygon);
    }
    drawing.path(areas, fmt::format("fill=\"{0}\" stroke=\"{0}\" stroke-width=\"0.6\"", fill));
    drawing.path(areas, fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"0.7\"", seam));
    drawing.path(borders, fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"", border));
  };
  std::vector<std::uint32_t> pale, strong;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    (emphasised.empty() || emphasised[p] ? strong : pale).push_back(p);
  }
  const auto byHeight = [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(graph.centroidHeight[a], a) < std::pair(graph.centroidHeight[b], b);
  };
  std::sort(pale.begin(), pale.end(), byHeight);
  std::sort(strong.begin(), strong.end(), byHeight);
  drawing.beginClip(page.corner(), page.mapSize());
  drawLayer(pale, "#f1f1ee", "#e9e9e5", "#d3d5d6");
  drawLayer(strong, "#dfe8ef", "#cddae4", kWallColour);
  drawing.endGroup();
}

void drawWalls(SvgDrawing& drawing, const PlanPage& page, const NavGraph& graph,
               std::span<const char> emphasised) {
  std::string borders;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    if (emphasised.empty() || emphasised[p]) addBorders(borders, page, graph, p);
  }
  drawing.beginClip(page.corner(), page.mapSize());
  drawing.path(borders,
               fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"", kWallColour));
  drawing.endGroup();
}

void drawCoordinates(SvgDrawing& drawing, const PlanPage& page) {
  const PlanBounds& shown = page.bounds();
  const double step = roundStep(70 / page.scale());
  const glm::dvec2 low = page.corner() + glm::dvec2(0, page.mapSize().y);
  const glm::dvec2 high = page.corner() + glm::dvec2(page.mapSize().x, 0);
  constexpr std::string_view kTick = "stroke=\"#b9c0c8\" stroke-width=\"1\"";
  constexpr std::string_view kWords = "fill=\"#8a95a1\"";
  drawing.rectangle(page.corner(), page.mapSize(),
                    "fill=\"none\" stroke=\"#d9dde1\" stroke-width=\"1\"");
  for (double x = std::ceil(shown.low.x / step) * step; x <= shown.high.x; x += step) {
    const double at = page.at({x, 0}).x;
    if (at > high.x - 36) break;  // the axis' name stands there
    drawing.line({at, low.y}, {at, low.y + 4}, kTick);
    drawing.text({at, low.y + 16}, svgNumber(x), 11, Anchor::kMiddle, kWords);
  }
  drawing.text({high.x, low.y + 16}, "x, m", 11, Anchor::kEnd, kWords);
  for (double y = std::ceil(shown.low.y / step) * step; y <= shown.high.y; y += step) {
    const double at = page.at({0, y}).y;
    if (at < high.y + 18) break;
    drawing.line({low.x - 4, at}, {low.x, at}, kTick);
    drawing.text({low.x - 8, at + 4}, svgNumber(-y), 11, Anchor::kEnd, kWords);
  }
  drawing.text({low.x - 8, high.y + 8}, "z, m", 11, Anchor::kEnd, kWords);
}

void drawScaleBar(SvgDrawing& drawing, const PlanPage& page) {
  const double step = roundStep(22 / page.scale());  // so that four pieces fit the bar's place
  const double pixels = step * page.scale();
  const glm::dvec2 left = {page.corner().x + page.mapSize().x - 4 * pixels - 24,
                           page.legendTop() + 12};
  for (int piece = 0; piece < 4; ++piece) {
    drawing.rectangle({left.x + piece * pixels, left.y}, {pixels, 6},
                      piece % 2 == 0 ? "fill=\"#2b3440\" stroke=\"#2b3440\" stroke-width=\"1\""
                                     : "fill=\"#ffffff\" stroke=\"#2b3440\" stroke-width=\"1\"");
  }
  for (const int mark : {0, 2, 4}) {
    drawing.text({left.x + mark * pixels, left.y + 20},
                 svgNumber(mark * step) + (mark == 4 ? " m" : ""), 11, Anchor::kMiddle);
  }
}

LegendCursor beginLegend(const PlanPage& page) {
  return {{page.corner().x, page.legendTop() + 14}};
}

glm::dvec2 legendEntry(SvgDrawing& drawing, const PlanPage& page, LegendCursor& cursor,
                       std::string_view words) {
  constexpr double kSign = 34, kSize = 12.5, kGap = 24;
  const double width = kSign + textWidth(words) * kSize + kGap;
  const double right = page.corner().x + page.mapSize().x - 270;  // the scale bar's place
  if (cursor.next.x > page.corner().x && cursor.next.x + width - kGap > right) {
    cursor.next = {page.corner().x, cursor.next.y + 24};
  }
  const glm::dvec2 at = cursor.next;
  cursor.next.x += width;
  drawing.text({at.x + kSign, at.y + 4}, words, kSize, Anchor::kStart);
  return at + glm::dvec2(14, 0);
}

void drawUser(SvgDrawing& drawing, glm::dvec2 at, float heading, bool withHeading) {
  if (withHeading) {
    const glm::vec2 plan = navmesh::directionOf(heading);
    const glm::dvec2 ahead = {plan.x, -plan.y};  // the page's y points down
    const glm::dvec2 side = {-ahead.y, ahead.x};
    const glm::dvec2 arrow[] = {at + 25.0 * ahead, at + 2.0 * ahead + 8.5 * side,
                                at + 2.0 * ahead - 8.5 * side};
    drawing.polyline(arrow, true, "fill=\"#123a7a\" stroke=\"#ffffff\" stroke-width=\"2\"");
  }
  drawing.circle(at, 8.5, "fill=\"#123a7a\" stroke=\"#ffffff\" stroke-width=\"2\"");
  drawing.circle(at, 3, "fill=\"#ffffff\"");
}

double roundStep(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace forewalk::prediction
