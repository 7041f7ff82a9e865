#include "rdw/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>

namespace forewalk::rdw {
namespace {

// A negative zero is the same place as zero, and has to print and hash alike.
double plain(double value) { return value == 0.0 ? 0.0 : value; }

// Gains are single precision; written as doubles they would show digits that nobody set.
double shown(float value) { return std::round(static_cast<double>(value) * 1e7) / 1e7; }

}  // namespace

std::string_view traceHeader() {
  return "t,virtual_x,virtual_z,virtual_heading,physical_x,physical_z,physical_heading,translation,"
         "rotation,curvature,injected_yaw,reset,graph_nodes,predict_us,steer_us,border_distance,"
         "frame_us";
}

std::string traceCsv(std::span<const FrameRecord> frames) {
  fmt::memory_buffer text;
  const bool inCompany = !frames.empty() && frames.front().company.has_value();
  fmt::format_to(std::back_inserter(text), "{}{}\n", traceHeader(),
                 inCompany ? ",agent_clearance,agent_collisions,blocked_polygons" : "");
  for (const FrameRecord& f : frames) {
    fmt::format_to(
        std::back_inserter(text),
        "{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.9f},{:d},{},"
        "{:.3f},{:.3f},{:.6f},{:.3f}",
        f.t, plain(f.virtualPosition.x), plain(-f.virtualPosition.y), plain(f.virtualHeading),
        plain(f.physicalPosition.x), plain(-f.physicalPosition.y), plain(f.physicalHeading),
        f.gains.translation, f.gains.rotation, plain(static_cast<double>(f.gains.curvature)),
        plain(f.injectedYaw), f.reset, f.graphNodes, f.predictMicroseconds, f.steerMicroseconds,
        plain(f.borderDistance), f.frameMicroseconds);
    if (inCompany) {
      const CompanyRecord company = f.company.value_or(CompanyRecord{});
      const std::string clearance = std::isfinite(company.clearance)
                                        ? fmt::format("{:.6f}", plain(company.clearance))
                                        : std::string();
      fmt::format_to(std::back_inserter(text), ",{},{},{}", clearance, company.collisions,
                     company.blockedPolygons);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

void TraceHash::add(const FrameRecord& f) {
  const auto mix = [&](double value) {
    std::uint64_t bits = 0;
    const double positiveZero = plain(value);
    std::memcpy(&bits, &positiveZero, sizeof bits);
    for (int byte = 0; byte < 8; ++byte) {  // by value, so that byte order does not matter
      hash_ = (hash_ ^ ((bits >> (8 * byte)) & 0xffu)) * 1099511628211u;
    }
  };
  const double values[] = {f.t,
                           f.virtualPosition.x,
                           f.virtualPosition.y,
                           f.virtualHeading,
                           f.physicalPosition.x,
                           f.physicalPosition.y,
                           f.physicalHeading,
                           static_cast<double>(f.gains.translation),
                           static_cast<double>(f.gains.rotation),
                           static_cast<double>(f.gains.curvature),
                           static_cast<double>(f.gains.bending),
                           f.injectedYaw,
                           f.reset ? 1.0 : 0.0,
                           static_cast<double>(f.graphNodes),
                           f.borderDistance};
  for (const double value : values) mix(value);
  if (!f.company) return;
  mix(f.company->clearance);
  mix(static_cast<double>(f.company->collisions));
  mix(static_cast<double>(f.company->blockedPolygons));
}

std::string_view nameOf(WalkEnd end) {
  switch (end) {
    case WalkEnd::kMetres:
      return "metres";
    case WalkEnd::kSeconds:
      return "seconds";
    case WalkEnd::kFinished:
      return "finished";
    case WalkEnd::kStuck:
      return "stuck";
    case WalkEnd::kInterrupted:
      return "interrupted";
  }
  return "unknown";
}

Quantiles quantilesOf(std::vector<double>& values) {
  if (values.empty()) return {};
  const auto nearestRank = [&](double share) {
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    const auto at = values.begin() + (static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  return {nearestRank(0.5), nearestRank(0.99), nearestRank(1.0)};
}

double Summary::resetsPer100Metres() const {
  return virtualMetres > 0.0 ? 100.0 * static_cast<double>(resets) / virtualMetres : 0.0;
}

double Summary::metresBetweenResets() const {
  return resets > 0 ? virtualMetres / static_cast<double>(resets) : virtualMetres;
}

std::string summaryJson(const Summary& s) {
  using Json = nlohmann::ordered_json;
  const auto times = [&](const Quantiles& q) {
    if (!s.timed) return Json();
    return Json{{"median", q.median}, {"p99", q.p99}, {"worst", q.worst}};
  };
  Json limits;
  for (const GainPreset& preset : gainPresets()) {
    if (preset.limits == s.limits) {
      limits["preset"] = preset.name;
      break;
    }
  }
  limits["translation"] = {shown(s.limits.translationMin), shown(s.limits.translationMax)};
  limits["rotation"] = {shown(s.limits.rotationMin), shown(s.limits.rotationMax)};
  limits["curvature_max"] = shown(s.limits.curvatureMax);
  limits["bending"] = {shown(s.limits.bendingMin), shown(s.limits.bendingMax)};

  Json summary = {
      {"format", "forewalk.summary/1"},
      {"controller", s.controller},
      {"limits", limits},
      {"horizon", s.horizon},
      {"rate_hz", s.rate},
      {"seed", s.seed},
      {"space_area", s.spaceArea},
      {"virtual_area", s.virtualArea},
      {"frames", s.frames},
      {"duration", s.seconds},
      {"virtual_metres", s.virtualMetres},
      {"physical_metres", s.physicalMetres},
      {"end", nameOf(s.end)},
      {"stuck", s.end == WalkEnd::kStuck},
      {"resets", s.resets},
      {"resets_per_100m", s.resetsPer100Metres()},
      {"metres_between_resets", s.metresBetweenResets()},
      {"reset_duration", s.resetSeconds},
      {"mean_gains",
       {{"translation", s.meanTranslation},
        {"rotation", s.meanRotation},
        {"rotation_offset", s.meanRotationOffset},
        {"curvature", s.meanCurvature}}},
      {"violations",
       {{"count", s.violations},
        {"frames", s.violationFrames},
        {"metres", s.violationMetres},
        {"depth", s.violationDepth}}},
      {"mean_graph_nodes", s.meanGraphNodes},
      {"graph_us", times(s.graphMicroseconds)},
      {"frame_us", times(s.frameMicroseconds)},
      {"trace_hash", fmt::format("{:016x}", s.traceHash)},
  };
  if (s.company) {
    const CompanySummary& c = *s.company;
    summary["agents"] = {
        {"count", c.others},
        {"user_avoids", c.userAvoids},
        {"collisions", c.collisions},
        {"collision_duration", c.collisionSeconds},
        {"collisions_among_agents", c.othersCollisions},
        {"minimum_separation",
         std::isfinite(c.minimumSeparation) ? Json(c.minimumSeparation) : Json()},
        {"blocked_duration", c.blockedSeconds},
        {"blocked_polygons_most", c.blockedPolygons},
        {"state_changes", c.stateChanges},
        {"hash", fmt::format("{:016x}", c.hash)},
    };
  }
  return summary.dump(2) + "\n";
}

}  // namespace forewalk::rdw
