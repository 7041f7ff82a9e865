// What the rows of an experiment say: means with intervals, and comparisons in pairs.
//
// Walks of one scene, room, user, variant and seed have the same goals whoever steers, so
// controllers are compared walk by walk. Distributions are Boost.Math's.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "service/experiment/results.h"

namespace forewalk::service {

/// A mean with its 95 % interval by Student's t. The interval is that of the values' spread: with
/// one value it is unknown, and low and high are NaN.
struct Estimate {
  std::size_t count = 0;
  double mean = 0.0;  ///< NaN for no values
  double low = 0.0, high = 0.0;
  double deviation = 0.0;  ///< standard deviation; NaN for fewer than two
};
Estimate estimate(std::span<const double> values);

/// Two controllers on the same walks.
struct Comparison {
  Estimate difference;  ///< of the second minus the first
  double relative =
      0.0;  ///< (mean of the second) / (mean of the first) - 1; NaN where the first's is 0
  double tTest = 1.0;  ///< p of Student's paired t-test, two-sided; 1 where all differences are 0
  double signedRank = 1.0;  ///< p of Wilcoxon's signed-rank test, two-sided: exact up to 25
                            ///< differences without ties, else by the normal approximation with
                            ///< ties and continuity corrected; zeros are left out
};
/// `first` and `second` are of one length. O(n log n), exact ranks O(n^3).
Comparison compare(std::span<const double> first, std::span<const double> second);

/// Holm's adjustment of p values for having asked as many questions, in their order. O(n log n).
std::vector<double> holm(std::span<const double> p);

/// Rows of a plan that share some entries. Axes that are kAny are not asked about.
struct Selection {
  static constexpr std::size_t kAny = static_cast<std::size_t>(-1);
  std::array<std::size_t, kAxes> chosen{kAny, kAny, kAny, kAny, kAny, kAny, kAny};

  Selection with(Axis axis, std::size_t choice) const {
    Selection narrower = *this;
    narrower.chosen[static_cast<std::size_t>(axis)] = choice;
    return narrower;
  }
};

/// Whether the selection takes a row.
bool isIn(const ExperimentPlan& plan, const Row& row, const Selection& selection);

/// Values of a metric of all rows selected, in the order of runs; failed runs, and those that did
/// not measure it, are left out.
std::vector<double> valuesOf(const Results& results, const Selection& selection, Metric metric);

/// Compares two controllers on the rows selected, those that neither failed.
Comparison compareControllers(const Results& results, const Selection& selection, std::size_t first,
                              std::size_t second, Metric metric);

/// A part of an experiment that one table shows: one scene, user, reset, limits and variant, with
/// all its rooms and controllers.
struct Block {
  Selection selection;
  std::string title;  ///< the names of what is fixed and not the same for all blocks; may be empty
};
std::vector<Block> blocksOf(const Results& results);

/// Resets per 100 m with intervals, controllers down and rooms across, a table per block.
std::string resetTable(const Results& results);

}  // namespace forewalk::service
