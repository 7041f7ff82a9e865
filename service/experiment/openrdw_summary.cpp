#include "service/experiment/openrdw_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "rdw/pose.h"
#include "service/experiment/results.h"
#include "service/timing.h"

namespace forewalk::service {
namespace {

constexpr double kSampleSeconds = 0.1;
constexpr double kDegrees = 180.0 / rdw::kPi;
constexpr double kMoves = 1e-9;  // metres or radians a frame; less is rounding

/// What a gain did in a frame, and what it was in each sample.
struct GainSeries {
  double neutral;
  double sum = 0.0;  // injected
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  std::vector<double> samples{}, injectedSamples{};
  std::vector<double> now{}, injectedNow{};  // of the sample being taken

  void apply(double gain, double injected) {
    sum += injected;
    least = std::min(least, gain);
    most = std::max(most, gain);
    now.push_back(gain);
    injectedNow.push_back(injected);
  }

  void endSample() {
    samples.push_back(now.empty() ? neutral : mean(now));
    injectedSamples.push_back(mean(injectedNow));
    now.clear();
    injectedNow.clear();
  }

  double absoluteMean() const {
    double total = 0.0;
    for (const double sample : samples) total += std::abs(sample);
    return samples.empty() ? 0.0 : total / static_cast<double>(samples.size());
  }

  /// Between samples, a second.
  std::vector<double> changes(double seconds) const {
    std::vector<double> all;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      all.push_back(std::abs(samples[i] - samples[i - 1]) / seconds);
    }
    return all;
  }
};

double most(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

/// Infinity and NaN are no numbers in that form.
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "N/A"; }

/// A cell that keeps to its column.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), ';', ',');
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

constexpr std::string_view kHeader =
    "experiment_start_time;redirector;resetter;path;tracking_space;virtual_space;limits;variant;"
    "seed;user;reset_count;virtual_way_distance;virtual_distance_between_resets_average;"
    "time_elapsed_between_resets_average;sum_injected_translation(IN METERS);"
    "sum_injected_rotation_g_r(IN DEGREES);sum_injected_rotation_g_c(IN DEGREES);"
    "sum_real_distance_travelled(IN METERS);sum_virtual_distance_travelled(IN METERS);"
    "min_g_t;max_g_t;min_g_r;max_g_r;min_g_c;max_g_c;experiment_duration;execute_duration;"
    "g_t_average;injected_translation_average;g_r_average;"
    "injected_rotation_from_rotation_gain_average;g_c_average;"
    "injected_rotation_from_curvature_gain_average;injected_rotation_average;g_t_change_max;"
    "g_c_change_max;g_t_change_average;g_c_change_average;real_position_average;"
    "virtual_position_average;distance_to_boundary_average;average_sampling_interval;";

void addUser(std::string& text, const ExperimentPlan& plan, const Row& row, std::size_t user) {
  const UserRow& of = row.users[user];
  const auto chosen = plan.choicesOf(row.run);
  const auto name = [&](Axis axis) {
    return cell(plan.choice(axis, chosen[static_cast<std::size_t>(axis)]).name);
  };
  const auto metric = [&](Metric which) { return of.values[static_cast<std::size_t>(which)]; };
  const auto value = [&](OpenRdwValue which) {
    return cell(of.openRdw[static_cast<std::size_t>(which)]);
  };
  const auto pair = [&](OpenRdwValue x, OpenRdwValue y) {
    return fmt::format("({}, {})", value(x), value(y));
  };
  using V = OpenRdwValue;
  const double pieces = metric(Metric::kResets) + 1.0;
  const double rotation = of.openRdw[static_cast<std::size_t>(V::kInjectedByRotationMean)];
  const double curvature = of.openRdw[static_cast<std::size_t>(V::kInjectedByCurvatureMean)];
  const std::string cells[] = {
      "0",
      name(Axis::kController),
      name(Axis::kReset),
      name(Axis::kUser),
      name(Axis::kRoom),
      name(Axis::kScene),
      name(Axis::kLimits),
      name(Axis::kVariant),
      fmt::format("{}", plan.seedOf(row.run)),
      fmt::format("{}", user),
      cell(metric(Metric::kResets)),
      cell(metric(Metric::kVirtualMetres)),
      cell(metric(Metric::kVirtualMetres) / pieces),
      cell(metric(Metric::kSeconds) / pieces),
      value(V::kInjectedTranslation),
      value(V::kInjectedByRotation),
      value(V::kInjectedByCurvature),
      cell(metric(Metric::kPhysicalMetres)),
      cell(metric(Metric::kVirtualMetres)),
      value(V::kTranslationLeast),
      value(V::kTranslationMost),
      value(V::kRotationLeast),
      value(V::kRotationMost),
      value(V::kCurvatureLeast),
      value(V::kCurvatureMost),
      cell(metric(Metric::kSeconds)),
      "0",
      value(V::kTranslationMean),
      value(V::kInjectedTranslationMean),
      value(V::kRotationMean),
      value(V::kInjectedByRotationMean),
      value(V::kCurvatureMean),
      value(V::kInjectedByCurvatureMean),
      cell(0.5 * (rotation + curvature)),
      value(V::kTranslationChangeMost),
      value(V::kCurvatureChangeMost),
      value(V::kTranslationChangeMean),
      value(V::kCurvatureChangeMean),
      pair(V::kRealX, V::kRealY),
      pair(V::kVirtualX, V::kVirtualY),
      cell(metric(Metric::kBorderMean)),
      value(V::kSampleSeconds),
  };
  for (const std::string& one : cells) text += one + ';';
  text += '\n';
}

}  // namespace

OpenRdwValues openRdwValues(std::span<const rdw::FrameRecord> frames) {
  OpenRdwValues values{};
  const auto set = [&](OpenRdwValue which, double value) {
    values[static_cast<std::size_t>(which)] = value;
  };
  GainSeries translation{1.0}, rotation{1.0}, curvature{0.0};
  const double frameSeconds = frames.size() > 1 ? frames[1].t - frames[0].t : kSampleSeconds;
  const auto perSample =
      static_cast<std::size_t>(std::max(1.0, std::round(kSampleSeconds / frameSeconds)));
  const double sampleSeconds = static_cast<double>(perSample) * frameSeconds;
  glm::dvec2 real(0.0), seen(0.0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const rdw::FrameRecord& frame = frames[i];
    real += frame.physicalPosition;
    seen += frame.virtualPosition;
    if (i == 0) continue;
    const rdw::FrameRecord& before = frames[i - 1];
    // The frame in which a reset ends is still turned by it.
    if (!frame.reset && !before.reset) {
      const double step = glm::distance(frame.physicalPosition, before.physicalPosition);
      const double turn = std::abs(rdw::wrapAngle(frame.physicalHeading - before.physicalHeading));
      const auto gain = [](float value) { return static_cast<double>(value); };
      if (step > kMoves) {
        const double t = gain(frame.gains.translation);
        translation.apply(t, std::abs(t - 1.0) * step);
        const double c = gain(frame.gains.curvature);
        curvature.apply(c, std::abs(c) * step * kDegrees);
      }
      if (turn > kMoves) {
        const double r = gain(frame.gains.rotation);
        rotation.apply(r, std::abs(r - 1.0) * turn * kDegrees);
      }
    }
    if (i % perSample != 0) continue;
    for (GainSeries* series : {&translation, &rotation, &curvature}) series->endSample();
  }
  const double count = std::max<double>(1.0, static_cast<double>(frames.size()));
  using V = OpenRdwValue;
  set(V::kInjectedTranslation, translation.sum);
  set(V::kInjectedByRotation, rotation.sum);
  set(V::kInjectedByCurvature, curvature.sum);
  set(V::kTranslationLeast, translation.least);
  set(V::kTranslationMost, translation.most);
  set(V::kRotationLeast, rotation.least);
  set(V::kRotationMost, rotation.most);
  set(V::kCurvatureLeast, curvature.least);
  set(V::kCurvatureMost, curvature.most);
  set(V::kTranslationMean, translation.absoluteMean());
  set(V::kRotationMean, rotation.absoluteMean());
  set(V::kCurvatureMean, curvature.absoluteMean());
  set(V::kInjectedTranslationMean, mean(translation.injectedSamples));
  set(V::kInjectedByRotationMean, mean(rotation.injectedSamples));
  set(V::kInjectedByCurvatureMean, mean(curvature.injectedSamples));
  const auto translationChanges = translation.changes(sampleSeconds);
  const auto curvatureChanges = curvature.changes(sampleSeconds);
  set(V::kTranslationChangeMost, most(translationChanges));
  set(V::kCurvatureChangeMost, most(curvatureChanges));
  set(V::kTranslationChangeMean, mean(translationChanges));
  set(V::kCurvatureChangeMean, mean(curvatureChanges));
  set(V::kRealX, real.x / count);
  set(V::kRealY, real.y / count);
  set(V::kVirtualX, seen.x / count);
  set(V::kVirtualY, seen.y / count);
  set(V::kSampleSeconds, sampleSeconds);
  for (double& value : values) {
    if (!std::isfinite(value)) value = std::numeric_limits<double>::quiet_NaN();
  }
  return values;
}

std::string openRdwSummary(const ExperimentPlan& plan, std::span<const Row> rows) {
  std::string text = "sep=;\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const bool sound = !row.failed() && row.end != rdw::nameOf(rdw::WalkEnd::kStuck);
    if (i > 0) text += '\n';
    text += fmt::format("TrialId = {};EndState = {}\n", row.run, sound ? "Normal" : "Invalid");
    if (row.users.empty()) continue;
    text += kHeader;
    text += '\n';
    for (std::size_t user = 0; user < row.users.size(); ++user) addUser(text, plan, row, user);
  }
  return text;
}

}  // namespace forewalk::service
