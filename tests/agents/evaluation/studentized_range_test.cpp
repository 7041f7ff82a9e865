#include "agents/evaluation/studentized_range.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace forewalk::agents {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

TEST(StudentizedRange, IsStudentsTForTwo) {
  for (const double df : {0.5, 1.0, 2.0, 3.7, 10.0, 110.0, 1e4, 1e8}) {
    const boost::math::students_t_distribution<double> student(df);
    for (double q = 0.01; q < 100.0; q *= 1.4) {
      const double t = q / std::numbers::sqrt2;
      const double above = 2.0 * boost::math::cdf(boost::math::complement(student, t));
      EXPECT_NEAR(studentizedRangeBelow(q, 2, df), 1.0 - above, 1e-12) << q << " " << df;
      EXPECT_NEAR(studentizedRangeAbove(q, 2, df), above, 1e-12);
      if (above < 1e-12) continue;
      EXPECT_NEAR(studentizedRangeAbove(q, 2, df) / above, 1.0, 1e-7) << q << " " << df;
    }
  }
}

TEST(StudentizedRange, IsInThePublishedTables) {
  // Upper percentage points as printed (e.g. Harter, Ann. Math. Stat. 31, 1960), to their last
  // digit.
  const struct {
    double p;
    int k;
    double df, q, digit;
  } table[] = {{0.05, 2, 1, 17.97, 0.01},          {0.05, 3, 1, 26.98, 0.01},
               {0.05, 2, 10, 3.151, 0.001},        {0.05, 3, 10, 3.877, 0.001},
               {0.05, 10, 10, 5.60, 0.01},         {0.05, 3, 20, 3.578, 0.001},
               {0.05, 20, 5, 8.208, 0.001},        {0.05, 10, 120, 4.560, 0.001},
               {0.05, 2, kForEver, 2.772, 0.001},  {0.05, 3, kForEver, 3.314, 0.001},
               {0.05, 10, kForEver, 4.474, 0.001}, {0.05, 20, kForEver, 5.012, 0.001},
               {0.01, 2, 10, 4.482, 0.001},        {0.01, 5, 20, 5.29, 0.01},
               {0.01, 10, 30, 5.756, 0.001},       {0.01, 3, kForEver, 4.120, 0.001}};
  for (const auto& row : table) {
    EXPECT_NEAR(studentizedRangeQuantile(row.p, row.k, row.df), row.q, 0.5001 * row.digit)
        << row.p << " " << row.k << " " << row.df;
  }
}

// Both integrals as they stand in the header, by Simpson's rule on fine grids.
double bySimpson(double q, int k, double df) {
  const auto integral = [](double from, double to, int pieces, auto&& value) {
    double sum = 0.0;
    for (int i = 0; i <= pieces; ++i) {
      const double weight = i == 0 || i == pieces ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum += weight * value(from + (to - from) * i / pieces);
    }
    return sum * (to - from) / pieces / 3.0;
  };
  const auto normal = [](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); };
  const auto range = [&](double w) {
    return integral(-8.0, 8.0, 800, [&](double z) {
      return k * std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi) *
             std::pow(normal(z) - normal(z - w), k - 1);
    });
  };
  const double scale = std::log(2.0) + 0.5 * df * std::log(0.5 * df) - std::lgamma(0.5 * df);
  return integral(0.0, 1.0 + 9.0 / std::sqrt(df), 1600, [&](double s) {
    return s == 0.0 ? 0.0
                    : std::exp(scale + (df - 1.0) * std::log(s) - 0.5 * df * s * s) * range(q * s);
  });
}

TEST(StudentizedRange, IsItsIntegrals) {
  const struct {
    double q;
    int k;
    double df;
  } cases[] = {{3.5, 3, 4.0}, {4.6, 11, 110.0}, {2.0, 11, 6.5}, {7.0, 100, 9.0}};
  for (const auto& c : cases) {
    EXPECT_NEAR(studentizedRangeBelow(c.q, c.k, c.df), bySimpson(c.q, c.k, c.df), 1e-9)
        << c.q << " " << c.k << " " << c.df;
  }
}

TEST(StudentizedRange, HasTheKnownMeans) {
  // The mean range of k standard normals: 2 / sqrt(pi), 3 / sqrt(pi), and 2.05875 for four.
  const double means[] = {2.0 / std::sqrt(std::numbers::pi), 3.0 / std::sqrt(std::numbers::pi),
                          2.0587507460};
  for (int k = 2; k <= 4; ++k) {
    double mean = 0.0;  // the integral of P(range > q), by the trapezoidal rule
    constexpr double kStep = 1.0 / 256;
    for (double q = 0.0; q < 16.0; q += kStep) {
      mean += (q == 0.0 ? 0.5 : 1.0) * kStep * studentizedRangeAbove(q, k, kForEver);
    }
    EXPECT_NEAR(mean, means[k - 2], 1e-5) << k;
  }
}

TEST(StudentizedRange, RunsIntoItsLimit) {
  for (const int k : {2, 5, 40}) {
    for (const double q : {0.7, 3.0, 5.0}) {
      const double limit = studentizedRangeBelow(q, k, kForEver);
      EXPECT_EQ(studentizedRangeBelow(q, k, 1e10), limit);
      EXPECT_NEAR(studentizedRangeBelow(q, k, 0.99e10), limit, 1e-8);
      // The difference falls as 1 / df.
      const double once = studentizedRangeBelow(q, k, 1e5) - limit;
      const double twice = studentizedRangeBelow(q, k, 2e5) - limit;
      EXPECT_NEAR(once / twice, 2.0, 0.01);
    }
  }
}

TEST(StudentizedRange, IsADistribution) {
  for (const int k : {2, 3, 11, 100, 1000}) {
    for (const double df : {1.0, 6.5, 110.0, kForEver}) {
      EXPECT_EQ(studentizedRangeBelow(0.0, k, df), 0.0);
      EXPECT_EQ(studentizedRangeBelow(-1.0, k, df), 0.0);
      EXPECT_EQ(studentizedRangeAbove(kForEver, k, df), 0.0);
      double last = 0.0;
      for (double q = 0.05; q < 40.0; q *= 1.25) {
        const double below = studentizedRangeBelow(q, k, df),
                     above = studentizedRangeAbove(q, k, df);
        EXPECT_GE(below, last - 1e-13);
        EXPECT_NEAR(below + above, 1.0, 1e-12);
        last = below;
      }
    }
  }
}

TEST(StudentizedRange, GrowsWithTheNumberOfMeansAndFallsWithDegreesOfFreedom) {
  for (const double p : {0.2, 0.05, 0.001}) {
    for (int k = 2; k < 40; k += 7) {
      for (const double df : {2.0, 12.0, 150.0}) {
        const double q = studentizedRangeQuantile(p, k, df);
        EXPECT_NEAR(studentizedRangeAbove(q, k, df), p, 1e-10);
        EXPECT_LT(q, studentizedRangeQuantile(p, k + 1, df));
        EXPECT_GT(q, studentizedRangeQuantile(p, k, df * 1.5));
      }
    }
  }
}

TEST(StudentizedRange, InvertsItselfFarOut) {
  for (const double p : {1e-9, 1e-4, 0.5, 0.99, 1.0 - 1e-6}) {
    for (const double df : {1.0, 30.0, kForEver}) {
      EXPECT_NEAR(studentizedRangeAbove(studentizedRangeQuantile(p, 5, df), 5, df) / p, 1.0, 1e-7)
          << p << " " << df;
    }
  }
}

}  // namespace
}  // namespace forewalk::agents
