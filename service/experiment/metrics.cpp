// What a run's frames come to: metrics of each user, and of all together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "rdw/gains.h"
#include "rdw/pose.h"
#include "service/experiment/results.h"
#include "service/files.h"

namespace forewalk::service {
namespace {

/// Equal to the bit but for NaN, which is like any other.
template <std::size_t N>
bool same(const std::array<double, N>& a, const std::array<double, N>& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// Whether people notice what a gain does in this frame: those of walking while walking, that of
/// turning while turning.
bool isNoticed(const rdw::FrameRecord& frame, const rdw::FrameRecord& before) {
  static const rdw::GainLimits threshold = *rdw::gainLimitsByName("steinicke");
  constexpr float kRounding = 1e-4f;
  constexpr double kWalking = 0.1;                      // m/s
  constexpr double kTurning = 10.0 * rdw::kPi / 180.0;  // rad/s
  const rdw::Gains& gains = frame.gains;
  const double dt = frame.t - before.t;
  const bool walks = glm::distance(frame.physicalPosition, before.physicalPosition) > kWalking * dt;
  const bool turns =
      std::abs(rdw::wrapAngle(frame.physicalHeading - before.physicalHeading)) > kTurning * dt;
  return (walks && (gains.translation < threshold.translationMin - kRounding ||
                    gains.translation > threshold.translationMax + kRounding ||
                    std::abs(gains.curvature) > threshold.curvatureMax + kRounding)) ||
         (turns && (gains.rotation < threshold.rotationMin - kRounding ||
                    gains.rotation > threshold.rotationMax + kRounding));
}

/// Time over what people notice, distances from the border, flips, places.
void addFrames(std::span<const rdw::FrameRecord> frames, const rdw::TrackedSpace& space,
               UserRow& row, HeatMap& heat) {
  const glm::dvec2 low = space.lowerBound();
  const glm::dvec2 size = space.upperBound() - low;
  double metres = 0.0, seconds = 0.0, over = 0.0, border = 0.0;
  double least = std::numeric_limits<double>::infinity();
  std::size_t flips = 0;
  float side = 0.0f;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const rdw::FrameRecord& frame = frames[i];
    border += frame.borderDistance;
    least = std::min(least, frame.borderDistance);
    const glm::dvec2 cell = (frame.physicalPosition - low) / size * static_cast<double>(kHeatSide);
    const auto column = static_cast<std::size_t>(std::clamp(cell.x, 0.0, kHeatSide - 1.0));
    const auto line = static_cast<std::size_t>(std::clamp(cell.y, 0.0, kHeatSide - 1.0));
    ++heat[line * kHeatSide + column];
    // The frame in which a reset ends is still turned by it.
    if (frame.reset || i == 0 || frames[i - 1].reset) continue;
    metres += glm::distance(frame.physicalPosition, frames[i - 1].physicalPosition);
    const double dt = frame.t - frames[i - 1].t;
    seconds += dt;
    if (isNoticed(frame, frames[i - 1])) over += dt;
    const float curvature = frame.gains.curvature;
    if (curvature != 0.0f) {
      if (side * curvature < 0.0f) ++flips;
      side = curvature;
    }
  }
  const auto set = [&](Metric metric, double value) {
    row.values[static_cast<std::size_t>(metric)] = value;
  };
  const double count = std::max<double>(1.0, static_cast<double>(frames.size()));
  set(Metric::kOverThreshold, seconds > 0.0 ? over / seconds : 0.0);
  set(Metric::kBorderMean, border / count);
  set(Metric::kBorderLeast, frames.empty() ? 0.0 : least);
  set(Metric::kFlipsPer100Metres, metres > 0.0 ? 100.0 * static_cast<double>(flips) / metres : 0.0);
}

UserRow userOf(const rdw::SimulationResult& result, const rdw::TrackedSpace& space, HeatMap& heat) {
  const rdw::Summary& s = result.summary;
  UserRow row;
  row.end = rdw::nameOf(s.end);
  row.traceHash = s.traceHash;
  const auto set = [&](Metric metric, double value) {
    row.values[static_cast<std::size_t>(metric)] = value;
  };
  const auto resets = static_cast<double>(s.resets);
  set(Metric::kResets, resets);
  set(Metric::kResetsPer100Metres, s.resetsPer100Metres());
  set(Metric::kMetresBetweenResets, s.metresBetweenResets());
  set(Metric::kSecondsBetweenResets,
      s.resets > 0 ? (s.seconds - s.resetSeconds) / resets : s.seconds);
  set(Metric::kResetSeconds, s.resetSeconds);
  set(Metric::kVirtualMetres, s.virtualMetres);
  set(Metric::kPhysicalMetres, s.physicalMetres);
  set(Metric::kSeconds, s.seconds);
  set(Metric::kTranslation, s.meanTranslation);
  set(Metric::kRotation, s.meanRotation);
  set(Metric::kRotationOffset, s.meanRotationOffset);
  set(Metric::kCurvature, s.meanCurvature);
  set(Metric::kViolations, static_cast<double>(s.violations));
  set(Metric::kViolationDepth, s.violationDepth);
  set(Metric::kGraphNodes, s.meanGraphNodes);
  set(Metric::kRoomArea, s.spaceArea);
  addFrames(result.frames, space, row, heat);
  setQuality({}, row);
  row.openRdw = openRdwValues(result.frames);
  return row;
}

}  // namespace

bool UserRow::sameAs(const UserRow& other) const {
  return end == other.end && traceHash == other.traceHash && same(values, other.values) &&
         same(openRdw, other.openRdw);
}

bool Row::sameAs(const Row& other) const {
  return run == other.run && end == other.end && reason == other.reason && heat == other.heat &&
         std::equal(users.begin(), users.end(), other.users.begin(), other.users.end(),
                    [](const UserRow& a, const UserRow& b) { return a.sameAs(b); });
}

void setQuality(const PredictionQuality& quality, UserRow& user) {
  const auto set = [&](Metric metric, double value, std::size_t samples) {
    user.values[static_cast<std::size_t>(metric)] = samples > 0 ? value : kNotMeasured;
  };
  const auto settled = static_cast<double>(quality.settled);
  set(Metric::kWaySamples, settled, quality.settled);
  set(Metric::kWayInGraph, static_cast<double>(quality.contained) / settled, quality.settled);
  set(Metric::kWayJunctions, static_cast<double>(quality.junctions), quality.settled);
  set(Metric::kWayNll, quality.nll, quality.junctions);
  set(Metric::kWayFirst, quality.first, quality.junctions);
  set(Metric::kWayRank, quality.rank, quality.junctions);
}

Row rowOf(std::size_t run, std::span<const rdw::SimulationResult> results,
          std::span<const rdw::TrackedSpace* const> spaces) {
  Row row;
  row.run = run;
  for (std::size_t i = 0; i < results.size(); ++i) {
    row.users.push_back(userOf(results[i], *spaces[i], row.heat));
    const rdw::Summary& s = results[i].summary;
    if (!s.timed) continue;
    // Of several users the slowest.
    const double times[] = {s.graphMicroseconds.median, s.graphMicroseconds.p99,
                            s.graphMicroseconds.worst,  s.frameMicroseconds.median,
                            s.frameMicroseconds.p99,    s.frameMicroseconds.worst};
    for (std::size_t t = 0; t < kTimings; ++t) row.times[t] = std::max(row.times[t], times[t]);
  }
  together(row);
  return row;
}

void together(Row& row) {
  const std::vector<UserRow>& users = row.users;
  row.end = users.front().end;
  row.values = users.front().values;
  row.traceHash = users.front().traceHash;
  if (users.size() == 1) return;
  const auto count = static_cast<double>(users.size());
  const auto set = [&](Metric metric, double value) {
    row.values[static_cast<std::size_t>(metric)] = value;
  };
  const auto sum = [&](Metric metric) {
    double total = 0.0;
    for (const UserRow& user : users) total += std::isnan(user[metric]) ? 0.0 : user[metric];
    return total;
  };
  const auto extreme = [&](Metric metric, bool largest) {
    double found = users.front()[metric];
    for (const UserRow& user : users) {
      found = largest ? std::max(found, user[metric]) : std::min(found, user[metric]);
    }
    return found;
  };
  const auto weighed = [&](Metric metric, Metric weight) {
    double total = 0.0, weights = 0.0;
    for (const UserRow& user : users) {
      if (std::isnan(user[metric])) continue;
      total += user[metric] * user[weight];
      weights += user[weight];
    }
    return weights > 0.0 ? total / weights : kNotMeasured;
  };
  for (std::size_t metric = 0; metric < kMetrics; ++metric) {
    row.values[metric] = sum(static_cast<Metric>(metric)) / count;
  }
  for (const Metric metric : {Metric::kResets, Metric::kResetSeconds, Metric::kVirtualMetres,
                              Metric::kPhysicalMetres, Metric::kViolations}) {
    set(metric, sum(metric));
  }
  for (const Metric metric : {Metric::kWaySamples, Metric::kWayJunctions}) {
    set(metric, sum(Metric::kWaySamples) > 0.0 ? sum(metric) : kNotMeasured);
  }
  const double resets = row[Metric::kResets], metres = row[Metric::kVirtualMetres];
  const double walked = sum(Metric::kSeconds);
  set(Metric::kResetsPer100Metres, metres > 0.0 ? 100.0 * resets / metres : 0.0);
  set(Metric::kMetresBetweenResets, resets > 0.0 ? metres / resets : metres);
  set(Metric::kSecondsBetweenResets,
      resets > 0.0 ? (walked - row[Metric::kResetSeconds]) / resets : walked);
  set(Metric::kSeconds, extreme(Metric::kSeconds, true));
  set(Metric::kViolationDepth, extreme(Metric::kViolationDepth, true));
  set(Metric::kBorderLeast, extreme(Metric::kBorderLeast, false));
  set(Metric::kWayInGraph, weighed(Metric::kWayInGraph, Metric::kWaySamples));
  for (const Metric metric : {Metric::kWayNll, Metric::kWayFirst, Metric::kWayRank}) {
    set(metric, weighed(metric, Metric::kWayJunctions));
  }
  std::string hashes;
  for (const UserRow& user : users) {
    hashes += fmt::format("{:016x}", user.traceHash);
    if (user.end == rdw::nameOf(rdw::WalkEnd::kStuck)) row.end = user.end;
  }
  row.traceHash = contentHash(hashes);
}

}  // namespace forewalk::service
