#include "service/walk_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::service {
namespace {

using prediction::Anchor;
using prediction::PlanPage;
using prediction::SvgDrawing;
using Position = glm::dvec2 rdw::FrameRecord::*;

constexpr int kPieces = 48;  // of one colour each

// From blue over violet to orange: told apart in grey and by most colour-blind people too.
std::string colourAt(double share) {
  constexpr glm::dvec3 kStops[] = {{33, 79, 160}, {143, 72, 160}, {224, 92, 92}, {245, 168, 60}};
  const double place = std::clamp(share, 0.0, 1.0) * 3.0;
  const int stop = std::min(2, static_cast<int>(place));
  const glm::dvec3 colour = glm::mix(kStops[stop], kStops[stop + 1], place - stop);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(colour.x), static_cast<int>(colour.y),
                     static_cast<int>(colour.z));
}

std::string pieceStyle(int piece) {
  return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-opacity=\"0.75\"",
                     colourAt((piece + 0.5) / kPieces));
}

constexpr std::string_view kResetStyle = "fill=\"#d6353a\" stroke=\"#ffffff\" stroke-width=\"1\"";
constexpr std::string_view kStartStyle = "fill=\"#123a7a\" stroke=\"#ffffff\" stroke-width=\"2\"";
constexpr std::string_view kEndStyle = "fill=\"#ffffff\" stroke=\"#e0862a\" stroke-width=\"3\"";

void drawWalk(SvgDrawing& drawing, const PlanPage& page, std::span<const rdw::FrameRecord> frames,
              Position position) {
  drawing.beginClip(page.corner(), page.mapSize());
  const double nearest = 1.5 / page.scale();  // points closer than that say nothing more
  std::vector<glm::dvec2> points;
  for (int piece = 0; piece < kPieces && !frames.empty(); ++piece) {
    const std::size_t begin = frames.size() * static_cast<std::size_t>(piece) / kPieces;
    const std::size_t end = frames.size() * static_cast<std::size_t>(piece + 1) / kPieces;
    points.clear();
    glm::dvec2 last{1e30};
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec2 here = frames[i].*position;
      if (i != begin && i + 1 != end && glm::distance(here, last) < nearest) continue;
      points.push_back(page.at(here));
      last = here;
    }
    if (end < frames.size())
      points.push_back(page.at(frames[end].*position));  // no gap to the next
    drawing.polyline(points, false, pieceStyle(piece));
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].reset && (i == 0 || !frames[i - 1].reset)) {
      drawing.circle(page.at(frames[i].*position), 4.2, kResetStyle);
    }
  }
  if (!frames.empty()) {
    drawing.circle(page.at(frames.front().*position), 7, kStartStyle);
    drawing.circle(page.at(frames.back().*position), 6, kEndStyle);
  }
  drawing.endGroup();
}

void drawLegend(SvgDrawing& drawing, const PlanPage& page) {
  prediction::LegendCursor cursor = prediction::beginLegend(page);
  drawing.circle(prediction::legendEntry(drawing, page, cursor, "start"), 6, kStartStyle);
  drawing.circle(prediction::legendEntry(drawing, page, cursor, "end"), 5.5, kEndStyle);
  const glm::dvec2 at = prediction::legendEntry(drawing, page, cursor, "path, from start to end");
  for (int i = 0; i < 8; ++i) {
    const glm::dvec2 from = at + glm::dvec2(-12 + 3 * i, 0);
    drawing.line(from, from + glm::dvec2(3, 0),
                 fmt::format("stroke=\"{}\" stroke-width=\"4\" stroke-linecap=\"butt\"",
                             colourAt((i + 0.5) / 8)));
  }
  drawing.circle(prediction::legendEntry(drawing, page, cursor, "reset"), 4.5, kResetStyle);
}

}  // namespace

std::string virtualPlan(const navmesh::NavGraph& graph, std::span<const rdw::FrameRecord> frames,
                        std::string_view title, std::string_view subtitle) {
  prediction::PlanBounds bounds = prediction::boundsOf(graph);
  for (const rdw::FrameRecord& frame : frames) bounds.add(frame.virtualPosition);
  const PlanPage page(bounds);
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  drawing.title(title);
  prediction::drawHeading(drawing, page, title, subtitle);
  prediction::drawWalkable(drawing, page, graph, {});
  drawWalk(drawing, page, frames, &rdw::FrameRecord::virtualPosition);
  prediction::drawCoordinates(drawing, page);
  prediction::drawScaleBar(drawing, page);
  drawLegend(drawing, page);
  return drawing.finish();
}

std::string physicalPlan(const rdw::TrackedSpace& space, std::span<const rdw::FrameRecord> frames,
                         std::string_view title, std::string_view subtitle) {
  prediction::PlanBounds bounds;
  bounds.add(space.lowerBound());
  bounds.add(space.upperBound());
  for (const rdw::FrameRecord& frame : frames) bounds.add(frame.physicalPosition);
  const PlanPage page(bounds);
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  drawing.title(title);
  prediction::drawHeading(drawing, page, title, subtitle);
  std::string floor;
  for (std::size_t ring = 0; ring < space.ringCount(); ++ring) {
    const auto corners = space.ring(ring);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      (i == 0 ? prediction::moveTo : prediction::lineTo)(floor, page.at(corners[i]));
    }
    floor += 'Z';
  }
  drawing.path(floor,
               "fill=\"#e9efe6\" fill-rule=\"evenodd\" stroke=\"#3f4e5e\" stroke-width=\"2.4\"");
  drawWalk(drawing, page, frames, &rdw::FrameRecord::physicalPosition);
  prediction::drawCoordinates(drawing, page);
  prediction::drawScaleBar(drawing, page);
  drawLegend(drawing, page);
  return drawing.finish();
}

}  // namespace forewalk::service
