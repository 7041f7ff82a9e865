// Do several groups have the same mean, or the same spread? One-way tests.
//
// One-way analysis of variance (Fisher 1925); Levene's test of equal variances (Levene 1960, about
// the mean; about the median: Brown and Forsythe, JASA 69, 1974); and two tests of means that do
// not need equal variances: Welch's (Biometrika 38, 1951) and Brown and Forsythe's (Technometrics
// 16, 1974). These are what SPSS calls ANOVA, Levene statistic, Welch and Brown-Forsythe.
//
// A group is its observations. All functions REQUIRE two groups or more, of two observations or
// more each, all finite. They cost O(observations), O(n log n) about the median. Where a statistic
// is something over nothing it is infinite and p is 0; where it is nothing over nothing both are
// NaN.
#pragma once

#include <span>
#include <vector>

namespace forewalk::agents {

using Groups = std::span<const std::vector<double>>;

/// A statistic with the F distribution under the null hypothesis.
struct FTest {
  double statistic = 0.0;
  double df1 = 0.0, df2 = 0.0;
  double p = 0.0;  ///< the chance of a statistic this large or larger, were the hypothesis true
};

struct Anova {
  double between = 0.0;  ///< sum of squares between groups (SSB), df1 degrees of freedom
  double within = 0.0;   ///< sum of squares within groups (SSW), df2 degrees of freedom
  FTest test;

  double meanSquareWithin() const { return within / test.df2; }
};

/// Means are equal, given that variances are.
Anova anova(Groups groups);

enum class Centre { kMean, kMedian };

/// Variances are equal: analysis of variance of |x - centre of its group|.
FTest levene(Groups groups, Centre centre = Centre::kMean);

/// Means are equal. Groups are weighted by observations over variance, so one without spread gives
/// NaN. For two groups it is Welch's t test, squared.
FTest welch(Groups groups);

/// Means are equal: F* = SSB / sum (1 - n_i / N) s_i^2, with Satterthwaite's degrees of freedom.
/// Equal to the F of anova where groups are of one size; only the degrees of freedom then differ.
FTest brownForsythe(Groups groups);

double meanOf(std::span<const double> values);

/// Of a sample: over n - 1.
double varianceOf(std::span<const double> values);

}  // namespace forewalk::agents
