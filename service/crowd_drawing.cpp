#include "service/crowd_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::service {
namespace {

using glm::dvec2;
using prediction::Anchor;
using prediction::PlanPage;
using prediction::SvgDrawing;

// Told apart by most colour-blind people too (Okabe and Ito 2008), the first ones best.
constexpr std::string_view kColours[] = {"#0072b2", "#e69f00", "#009e73",
                                         "#cc79a7", "#d55e00", "#56b4e9"};

std::string_view colourOf(std::uint32_t group) { return kColours[group % std::size(kColours)]; }

prediction::PlanBounds boundsOf(const CrowdResult& result, const navmesh::NavGraph* graph) {
  prediction::PlanBounds bounds;
  for (const CrowdSample& sample : result.recording.samples) {
    bounds.add(dvec2(sample.plan) - 0.5);
    bounds.add(dvec2(sample.plan) + 0.5);
  }
  if (graph) {
    const prediction::PlanBounds all = prediction::boundsOf(*graph);
    bounds.add(all.low);
    bounds.add(all.high);
    return bounds;
  }
  for (const agents::Wall& wall : result.walls) {
    const dvec2 reach(wall.isCircle() ? -static_cast<double>(wall.clearance) : 0.0);
    bounds.add(dvec2(wall.from) - reach);
    bounds.add(dvec2(wall.from) + reach);
  }
  return bounds;
}

void drawGround(SvgDrawing& drawing, const PlanPage& page, const CrowdResult& result,
                const navmesh::NavGraph* graph) {
  if (graph) prediction::drawWalkable(drawing, page, *graph, {});
  drawing.beginGroup("fill=\"#d9d4cb\" stroke=\"#3f4e5e\" stroke-width=\"2\"");
  for (const agents::Wall& wall : result.walls) {
    if (wall.isCircle()) {
      drawing.circle(page.at(wall.from), -static_cast<double>(wall.clearance) * page.scale(), "");
    } else if (!graph || wall.clearance == 0.0f) {  // the navmesh draws its own border
      drawing.line(page.at(wall.from), page.at(wall.to), "");
    }
  }
  drawing.endGroup();
}

void drawLegend(SvgDrawing& drawing, const PlanPage& page, const CrowdConfig& config) {
  prediction::LegendCursor cursor = prediction::beginLegend(page);
  for (std::uint32_t g = 0; g < config.groups.size(); ++g) {
    const CrowdGroup& group = config.groups[g];
    const dvec2 at =
        prediction::legendEntry(drawing, page, cursor,
                                group.human ? fmt::format("{} (human)", group.name)
                                            : fmt::format("{} ({})", group.name, group.model));
    drawing.circle(at, 6.0,
                   fmt::format("fill=\"{}\"{}", colourOf(g),
                               group.human ? " stroke=\"#111\" stroke-width=\"2\"" : ""));
  }
}

SvgDrawing begin(const PlanPage& page, const CrowdResult& result, const navmesh::NavGraph* graph,
                 const CrowdConfig& config, const std::string& title, const std::string& subtitle) {
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  drawing.title(title);
  prediction::drawHeading(drawing, page, title, subtitle);
  drawGround(drawing, page, result, graph);
  prediction::drawCoordinates(drawing, page);
  prediction::drawScaleBar(drawing, page);
  drawLegend(drawing, page, config);
  return drawing;
}

}  // namespace

std::string crowdPlan(const CrowdResult& result, const CrowdConfig& config,
                      const navmesh::NavGraph* graph, const std::string& title,
                      const std::string& subtitle) {
  const PlanPage page(boundsOf(result, graph));
  SvgDrawing drawing = begin(page, result, graph, config, title, subtitle);
  const CrowdRecording& recording = result.recording;
  const std::size_t frames = recording.frames();
  drawing.beginClip(page.corner(), page.mapSize());
  const double nearest = 1.5 / page.scale();  // points closer than that say nothing more
  std::vector<dvec2> points;
  for (std::uint32_t agent = 0; agent < recording.agents && frames > 0; ++agent) {
    const std::string_view colour = colourOf(recording.group[agent]);
    points.clear();
    dvec2 last(1e30);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const dvec2 here(recording.at(frame, agent).plan);
      if (frame + 1 != frames && glm::distance(here, last) < nearest) continue;
      points.push_back(page.at(here));
      last = here;
    }
    drawing.polyline(points, false,
                     fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\" "
                                 "stroke-opacity=\"0.55\"",
                                 colour));
    drawing.circle(points.front(), 3.0, fmt::format("fill=\"#fff\" stroke=\"{}\"", colour));
    const double radius =
        std::max(2.5, static_cast<double>(recording.radius[agent]) * page.scale());
    drawing.circle(points.back(), radius, fmt::format("fill=\"{}\" fill-opacity=\"0.85\"", colour));
  }
  drawing.endGroup();
  return drawing.finish();
}

std::string animateCrowd(const CrowdResult& result, const CrowdConfig& config,
                         const navmesh::NavGraph* graph, const CrowdAnimationSettings& settings,
                         const std::string& title, const std::string& subtitle) {
  const PlanPage page(boundsOf(result, graph));
  SvgDrawing drawing = begin(page, result, graph, config, title, subtitle);
  const CrowdRecording& recording = result.recording;
  std::vector<std::size_t> shown;  // frames
  const double end = settings.from + settings.seconds + 1e-9;
  for (double t = settings.from; t <= end; t += std::max(settings.step, recording.tick)) {
    const auto frame = static_cast<std::size_t>(std::lround(t / recording.tick));
    if (frame >= recording.frames()) break;
    shown.push_back(frame);
  }
  if (shown.size() < 2) return drawing.finish();
  const double seconds = static_cast<double>(shown.back() - shown.front()) * recording.tick;
  const std::size_t still = shown.size() / 2;

  drawing.beginClip(page.corner(), page.mapSize());
  std::string places;
  for (std::uint32_t agent = 0; agent < recording.agents; ++agent) {
    const auto textOf = [&](std::size_t frame) {
      const dvec2 at = page.at(dvec2(recording.at(frame, agent).plan));
      return prediction::svgNumber(at.x) + ',' + prediction::svgNumber(at.y);
    };
    places.clear();
    for (const std::size_t frame : shown) {
      if (!places.empty()) places += ';';
      places += textOf(frame);
    }
    drawing.beginGroup(fmt::format("transform=\"translate({})\"", textOf(shown[still])));
    drawing.animateTransform("translate", places, seconds);
    const bool human = config.groups[recording.group[agent]].human;
    drawing.circle(
        dvec2(0.0), std::max(2.0, static_cast<double>(recording.radius[agent]) * page.scale()),
        fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"",
                    colourOf(recording.group[agent]), human ? "#111" : "#fff", human ? 2.5 : 0.8));
    drawing.endGroup();
  }
  drawing.endGroup();
  drawing.text(page.corner() + dvec2(page.mapSize().x, -10),
               fmt::format("{:.0f} s to {:.0f} s", settings.from, settings.from + seconds), 12,
               Anchor::kEnd, "fill=\"#5a6675\"");
  return drawing.finish();
}

}  // namespace forewalk::service
