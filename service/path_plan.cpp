// All paths from above, as in the figures of Ono's thesis.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "prediction/plan_drawing.h"
#include "prediction/svg.h"
#include "service/path_comparison.h"

namespace forewalk::service {
namespace {

using prediction::Anchor;
using prediction::PlanPage;
using prediction::SvgDrawing;

// People in greys and blues that recede, models in colours that do not.
constexpr const char* kPeople[] = {"#5d7a9c", "#8aa0b4", "#4f6678",
                                   "#9aa7a0", "#6f8f9a", "#7d7f96"};
constexpr const char* kModels[] = {"#d6353a", "#c98a1b", "#2a8c4a",
                                   "#6a4c93", "#b0487f", "#00838f"};
constexpr std::size_t kNamed = 24;  // more names than that only hide each other

template <std::size_t N>
std::string colourOf(const char* const (&colours)[N], std::size_t i) {
  return colours[i % N];
}

void drawPath(SvgDrawing& drawing, const PlanPage& page, const std::vector<glm::dvec2>& path,
              const std::string& colour, double width) {
  const double nearest = 1.0 / page.scale();  // points closer than a pixel say nothing more
  std::vector<glm::dvec2> points;
  glm::dvec2 last = path.front();
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i != 0 && i + 1 != path.size() && glm::distance(path[i], last) < nearest) continue;
    points.push_back(page.at(path[i]));
    last = path[i];
  }
  drawing.polyline(
      points, false,
      fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-opacity=\"0.85\"", colour,
                  prediction::svgNumber(width)));
  drawing.circle(points.front(), 1.2 * width + 2.0, fmt::format("fill=\"{}\"", colour));
  drawing.circle(points.back(), 1.2 * width + 1.6,
                 fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.8\"", colour));
}

std::string subtitleOf(const PathComparison& comparison) {
  std::string text;
  for (const PathGroup& group : comparison.groups) {
    text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", group.paths.size(), group.name);
  }
  return text + "; a dot where each begins, a ring where it ends";
}

}  // namespace

std::string pathPlan(const PathComparison& comparison, const PathPlanFrame& frame) {
  const navmesh::NavGraph* const floor = frame.floor;
  prediction::PlanBounds bounds;
  if (floor != nullptr) bounds = prediction::boundsOf(*floor);
  for (const ComparedPath& path : comparison.paths) {
    for (const glm::dvec2 point : path.points) bounds.add(point);
  }
  for (const std::vector<glm::dvec2>& outline : frame.outlines) {
    for (const glm::dvec2 point : outline) bounds.add(point);
  }
  const PlanPage page(bounds);
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  drawing.title(frame.title);
  prediction::drawHeading(drawing, page, frame.title,
                          frame.subtitle.empty() ? subtitleOf(comparison) : frame.subtitle);
  if (floor != nullptr) prediction::drawWalkable(drawing, page, *floor, {});
  for (const std::vector<glm::dvec2>& outline : frame.outlines) {
    std::vector<glm::dvec2> points;
    for (const glm::dvec2 point : outline) points.push_back(page.at(point));
    drawing.polyline(points, true,
                     "fill=\"#c9bfae\" fill-opacity=\"0.45\" stroke=\"#8d8371\" "
                     "stroke-width=\"1\"");
  }
  prediction::drawCoordinates(drawing, page);

  struct Line {
    std::size_t path;
    std::string colour;
    double width;
  };
  std::vector<Line> lines;
  const double thick = comparison.paths.size() <= kNamed ? 2.8 : 1.3;  // many hide each other
  for (std::size_t g = 0; g < comparison.groups.size(); ++g) {
    const std::vector<std::size_t>& members = comparison.groups[g].paths;
    for (std::size_t i = 0; i < members.size(); ++i) {
      lines.push_back({members[i], g == 0 ? colourOf(kPeople, i) : colourOf(kModels, g - 1),
                       g == 0 ? 1.6 : thick});
    }
  }
  for (const Line& line : lines) {
    drawPath(drawing, page, comparison.paths[line.path].points, line.colour, line.width);
  }
  if (lines.size() <= kNamed) {
    for (const Line& line : lines) {
      const ComparedPath& path = comparison.paths[line.path];
      drawing.text(page.at(path.points.back()) + glm::dvec2(8, 4),
                   path.walker.empty() ? path.name : path.walker, 11.5, Anchor::kStart,
                   fmt::format("fill=\"{}\" stroke=\"#fdfcfa\" stroke-width=\"3\" "
                               "paint-order=\"stroke\"",
                               line.colour));
    }
  }
  prediction::drawScaleBar(drawing, page);
  prediction::LegendCursor cursor = prediction::beginLegend(page);
  for (std::size_t g = 0; g < std::min(comparison.groups.size(), std::size(kModels) + 1); ++g) {
    const glm::dvec2 at = prediction::legendEntry(drawing, page, cursor, comparison.groups[g].name);
    drawing.line(at - glm::dvec2(11, 0), at + glm::dvec2(11, 0),
                 fmt::format("stroke=\"{}\" stroke-width=\"{}\"",
                             g == 0 ? colourOf(kPeople, 0) : colourOf(kModels, g - 1),
                             g == 0 ? "2" : "3.4"));
  }
  return drawing.finish();
}

}  // namespace forewalk::service
