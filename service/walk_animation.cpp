#include "service/walk_animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/trigonometric.hpp>
#include <optional>
#include <vector>

#include "navmesh/plan.h"
#include "prediction/plan_drawing.h"
#include "prediction/svg.h"

namespace forewalk::service {
namespace {

using glm::dvec2;
using prediction::Anchor;
using prediction::PlanPage;
using prediction::PredictionGraph;
using prediction::SvgDrawing;

constexpr double kRate = 15.0;     // frames per second that the likelihood sees
constexpr double kLeast = 0.02;    // of a way to be drawn
constexpr double kLabelled = 0.1;  // of a way to be told in numbers
constexpr double kWidest = 16.0;   // pixels, of a way that is certain
constexpr std::string_view kWay = "#e2711d", kTrail = "#123a7a";

double widthOf(double likelihood) { return 0.8 + kWidest * likelihood; }

// A piece of the taut paths ahead; pieces that ways share bear their sum.
struct Stroke {
  dvec2 from, to;
  double likelihood;
};
struct End {
  dvec2 at;
  double likelihood;
};

// What is seen at one step.
struct Moment {
  dvec2 plan;
  double heading;  // radians
  std::vector<Stroke> strokes;
  std::vector<End> ends;
  double none = 1.0;
};

Moment look(const PredictionGraph& graph, const prediction::WayLikelihood& likelihood) {
  Moment moment;
  moment.none = likelihood.none();
  const auto ways = likelihood.ways();
  const auto probabilities = likelihood.probabilities();
  std::vector<double> through(graph.corners.size(), 0.0);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const prediction::Node& node = graph.node(ways[i].terminal);
    for (std::uint32_t corner = node.corner; corner != 0; corner = graph.corners[corner].previous) {
      through[corner] += probabilities[i];
    }
    if (probabilities[i] < kLeast) continue;
    moment.strokes.push_back(
        {dvec2(graph.corners[node.corner].plan), dvec2(node.plan), probabilities[i]});
    moment.ends.push_back({dvec2(node.plan), probabilities[i]});
  }
  for (std::size_t corner = 1; corner < through.size(); ++corner) {
    if (through[corner] < kLeast) continue;
    const prediction::Corner& to = graph.corners[corner];
    moment.strokes.push_back(
        {dvec2(graph.corners[to.previous].plan), dvec2(to.plan), through[corner]});
  }
  const auto lessLikely = [](const auto& a, const auto& b) { return a.likelihood < b.likelihood; };
  std::stable_sort(moment.strokes.begin(), moment.strokes.end(), lessLikely);
  std::stable_sort(moment.ends.begin(), moment.ends.end(), lessLikely);
  return moment;
}

std::vector<Moment> watch(const navmesh::World& world, const rdw::Walk& walk,
                          const MethodFactory& method,
                          const prediction::LikelihoodParameters& parameters,
                          const WalkAnimationSettings& settings) {
  const std::vector<rdw::WalkFrame> frames = rdw::resample(walk, kRate);
  const GraphMaker graphOf = method(world);
  prediction::WayLikelihood likelihood(parameters);
  const navmesh::SnapLimits snap{0.5f, 2.2f, 2.2f}, anyHeight{0.5f, 1e6f, 1e6f};
  std::optional<navmesh::Location> last;
  std::vector<Moment> moments;
  double next = settings.from;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double now = static_cast<double>(f) / kRate;
    if (now > settings.from + settings.seconds + 1e-9) break;
    const glm::vec3 position =
        navmesh::toSpace(glm::vec2(frames[f].plan), last ? last->height : 0.0f);
    const auto place =
        last ? navmesh::locateFrom(world.graph, world.locations, *last, position, snap)
             : navmesh::locate(world.graph, world.locations, position, anyHeight);
    PredictionGraph nowhere;
    nowhere.flags = prediction::kSourceOffMesh;
    nowhere.source.plan = glm::vec2(frames[f].plan);
    const PredictionGraph& graph = place ? graphOf(*place, settings.horizon) : nowhere;
    if (place) last = place;
    likelihood.update(graph, {f == 0 ? 0.0 : 1.0 / kRate, {}, {}});
    if (now < next - 1e-9) continue;
    next += settings.step;
    moments.push_back(look(graph, likelihood));
    moments.back().plan = frames[f].plan;
    moments.back().heading = frames[f].heading;
  }
  return moments;
}

prediction::PlanBounds shownBounds(const navmesh::NavGraph& graph,
                                   const std::vector<Moment>& moments) {
  prediction::PlanBounds all = prediction::boundsOf(graph), seen;
  for (const Moment& moment : moments) {
    seen.add(moment.plan);
    for (const End& end : moment.ends) seen.add(end.at);
  }
  if (all.empty() || seen.empty()) return all.empty() ? seen : all;
  const dvec2 low = glm::max(all.low, seen.low - 1.5), high = glm::min(all.high, seen.high + 1.5);
  return low.x < high.x && low.y < high.y ? prediction::PlanBounds{low, high} : seen;
}

std::string joined(const std::vector<std::string>& values) {
  return fmt::format("{}", fmt::join(values, ";"));
}

void drawMoment(SvgDrawing& drawing, const PlanPage& page, const Moment& moment) {
  drawing.beginGroup(fmt::format("opacity=\"0.85\" stroke=\"{}\"", kWay));
  for (const Stroke& stroke : moment.strokes) {
    std::string data;
    prediction::moveTo(data, page.at(stroke.from));
    prediction::lineTo(data, page.at(stroke.to));
    drawing.path(data, fmt::format("stroke-width=\"{:.1f}\"", widthOf(stroke.likelihood)));
  }
  drawing.endGroup();
  drawing.beginGroup("fill=\"#1f9d55\" stroke=\"#fff\"");
  for (const End& end : moment.ends) {
    drawing.circle(page.at(end.at), 3.0 + 7.0 * std::sqrt(end.likelihood), "");
  }
  drawing.endGroup();
  drawing.beginGroup(
      "fill=\"#14532d\" font-weight=\"bold\" paint-order=\"stroke\" stroke=\"#fff\" "
      "stroke-width=\"3\"");
  for (const End& end : moment.ends) {
    if (end.likelihood < kLabelled) continue;
    drawing.text(page.at(end.at) + dvec2(0, -13), fmt::format("{:.0f} %", 100.0 * end.likelihood),
                 13, Anchor::kMiddle, "");
  }
  drawing.endGroup();
}

void drawLegend(SvgDrawing& drawing, const PlanPage& page) {
  prediction::LegendCursor cursor = prediction::beginLegend(page);
  dvec2 at = prediction::legendEntry(drawing, page, cursor, "the walker");
  drawing.circle(at, 6.5, "fill=\"#123a7a\"");
  at = prediction::legendEntry(drawing, page, cursor, "walked");
  drawing.line(at - dvec2(12, 0), at + dvec2(12, 0),
               fmt::format("stroke=\"{}\" stroke-width=\"3\" stroke-opacity=\"0.7\"", kTrail));
  for (const double likelihood : {0.1, 0.5, 0.9}) {
    at = prediction::legendEntry(drawing, page, cursor,
                                 fmt::format("{:.0f} % likely", 100.0 * likelihood));
    drawing.line(at - dvec2(10, 0), at + dvec2(10, 0),
                 fmt::format("stroke=\"{}\" stroke-opacity=\"0.85\" stroke-width=\"{}\"", kWay,
                             prediction::svgNumber(widthOf(likelihood))));
  }
}

}  // namespace

std::string animateWalk(const navmesh::World& world, const rdw::Walk& walk,
                        const MethodFactory& method,
                        const prediction::LikelihoodParameters& likelihood,
                        const WalkAnimationSettings& settings, const std::string& title,
                        const std::string& subtitle) {
  const std::vector<Moment> moments = watch(world, walk, method, likelihood, settings);
  const PlanPage page(shownBounds(world.graph, moments));
  SvgDrawing drawing(page.pageSize().x, page.pageSize().y, "#fdfcfa");
  drawing.title(title);
  prediction::drawHeading(drawing, page, title, subtitle);
  prediction::drawWalkable(drawing, page, world.graph, {});
  prediction::drawCoordinates(drawing, page);
  prediction::drawScaleBar(drawing, page);
  drawLegend(drawing, page);
  if (moments.empty()) return drawing.finish();

  // A picture stays until the next; the last one as long as the others.
  const std::size_t count = moments.size();
  const double seconds = settings.step * static_cast<double>(count);
  const std::size_t still = count / 2;
  const auto share = [&](std::size_t i) {
    return static_cast<double>(i) / static_cast<double>(count);
  };

  std::vector<dvec2> trail;
  std::vector<double> walked;  // metres at each moment
  std::vector<std::string> places, turns, rests;
  double degrees = 0.0;
  for (std::size_t i = 0; i <= count; ++i) {  // the last twice: it stands for a step
    const Moment& moment = moments[std::min(i, count - 1)];
    const dvec2 at = page.at(moment.plan);
    trail.push_back(at);
    walked.push_back(i == 0 ? 0.0 : walked.back() + glm::distance(trail[i], trail[i - 1]));
    // Clockwise on the page; the shorter way round from the one before.
    const double heading = -glm::degrees(moment.heading);
    degrees = i == 0 ? heading : degrees + std::remainder(heading - degrees, 360.0);
    places.push_back(prediction::svgNumber(at.x) + ',' + prediction::svgNumber(at.y));
    turns.push_back(fmt::format("{:.0f}", degrees));
  }
  // A dash as long as the trail and a gap as long: shifted back, it ends where the walker is.
  const double length = walked.back();
  for (const double metres : walked) rests.push_back(fmt::format("{:.1f}", length - metres + 1.0));

  drawing.beginClip(page.corner(), page.mapSize());
  drawing.beginGroup(
      fmt::format("fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.7\" stroke-width=\"3\" "
                  "stroke-dasharray=\"{:.1f}\" stroke-dashoffset=\"{}\" stroke-linecap=\"butt\"",
                  kTrail, length + 1.0, rests[still]));
  drawing.animate("stroke-dashoffset", joined(rests), seconds);
  drawing.polyline(trail, false, "");
  drawing.endGroup();
  for (std::size_t i = 0; i < count; ++i) {
    drawing.beginGroup(i == still ? "" : "visibility=\"hidden\"");
    drawing.showDuring(share(i), share(i + 1), seconds);
    drawMoment(drawing, page, moments[i]);
    drawing.endGroup();
  }
  drawing.beginGroup(fmt::format("transform=\"translate({})\"", places[still]));
  drawing.animateTransform("translate", joined(places), seconds);
  drawing.beginGroup(fmt::format("transform=\"rotate({})\"", turns[still]));
  drawing.animateTransform("rotate", joined(turns), seconds);
  prediction::drawUser(drawing, {0.0, 0.0}, 0.0f, true);
  drawing.endGroup();
  drawing.endGroup();
  drawing.endGroup();

  // How far the picture is, and what is left for none of the ways.
  const dvec2 bar = page.corner() + dvec2(page.mapSize().x - 200, -22);
  drawing.rectangle(bar, {200, 5}, "fill=\"#e3e6e9\" rx=\"2.5\"");
  drawing.beginGroup(fmt::format("transform=\"translate({},{})\"", prediction::svgNumber(bar.x),
                                 prediction::svgNumber(bar.y)));
  drawing.beginGroup(fmt::format("transform=\"scale({} 1)\"", share(still)));
  drawing.animateTransform("scale", "0 1;1 1", seconds);
  drawing.rectangle({0, 0}, {200, 5}, fmt::format("fill=\"{}\"", kTrail));
  drawing.endGroup();
  drawing.endGroup();
  for (std::size_t i = 0; i < count; ++i) {
    drawing.beginGroup(i == still ? "" : "visibility=\"hidden\"");
    drawing.showDuring(share(i), share(i + 1), seconds);
    drawing.text(bar + dvec2(200, -8),
                 fmt::format("{:.1f} s, none of these: {:.0f} %",
                             settings.from + settings.step * static_cast<double>(i),
                             100.0 * moments[i].none),
                 12, Anchor::kEnd, "fill=\"#5a6675\"");
    drawing.endGroup();
  }
  return drawing.finish();
}

}  // namespace forewalk::service
