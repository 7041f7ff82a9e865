#include "agents/evaluation/dtw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

using Path = std::vector<glm::dvec2>;

Path randomPath(std::mt19937_64& rng, std::size_t samples) {
  Path path{{navmesh::uniform(rng, -5.0, 5.0), navmesh::uniform(rng, -5.0, 5.0)}};
  while (path.size() < samples) {
    path.push_back(path.back() +
                   glm::dvec2(navmesh::uniform(rng, -1.0, 1.0), navmesh::uniform(rng, -1.0, 1.0)));
  }
  return path;
}

// Every alignment there is, one by one: from the last pair of samples back to the first.
double overAllAlignments(const Path& a, const Path& b, std::size_t i, std::size_t j) {
  const double here = glm::distance(a[i], b[j]);
  if (i == 0 && j == 0) return here;
  double least = std::numeric_limits<double>::infinity();
  if (i > 0) least = std::min(least, overAllAlignments(a, b, i - 1, j));
  if (j > 0) least = std::min(least, overAllAlignments(a, b, i, j - 1));
  if (i > 0 && j > 0) least = std::min(least, overAllAlignments(a, b, i - 1, j - 1));
  return here + least;
}

// The table of the thesis, whole.
double byTable(const Path& a, const Path& b) {
  const double outside = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> g(a.size() + 1, std::vector<double>(b.size() + 1, outside));
  g[0][0] = 0.0;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      g[i][j] =
          glm::distance(a[i - 1], b[j - 1]) + std::min({g[i - 1][j], g[i - 1][j - 1], g[i][j - 1]});
    }
  }
  return g[a.size()][b.size()];
}

TEST(Dtw, OfSinglePointsIsTheirDistance) {
  EXPECT_EQ(dtw(Path{{1, 2}}, Path{{4, 6}}), 5.0);
  EXPECT_EQ(dtw(Path{{1, 2}}, Path{{1, 2}}), 0.0);
  EXPECT_EQ(dtw(Path{{0, 0}}, Path{{1, 0}, {2, 0}, {3, 0}}), 6.0);
}

TEST(Dtw, IsTheBestOfAllAlignments) {
  std::mt19937_64 rng(1);
  for (int round = 0; round < 300; ++round) {
    const Path a = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 7)));
    const Path b = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 7)));
    EXPECT_NEAR(dtw(a, b), overAllAlignments(a, b, a.size() - 1, b.size() - 1), 1e-12);
  }
}

TEST(Dtw, IsTheLastCellOfTheTableToTheLastBit) {
  std::mt19937_64 rng(2);
  for (int round = 0; round < 100; ++round) {
    const Path a = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 60)));
    const Path b = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 60)));
    EXPECT_EQ(dtw(a, b), byTable(a, b)) << a.size() << " x " << b.size();
  }
}

TEST(Dtw, IsSymmetricAndZeroToItself) {
  std::mt19937_64 rng(3);
  for (int round = 0; round < 50; ++round) {
    const Path a = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 200)));
    const Path b = randomPath(rng, 1 + static_cast<std::size_t>(navmesh::uniformInt(rng, 200)));
    EXPECT_EQ(dtw(a, b), dtw(b, a));
    EXPECT_EQ(dtw(a, a), 0.0);
    EXPECT_GE(dtw(a, b),
              std::max(glm::distance(a.front(), b.front()), glm::distance(a.back(), b.back())));
  }
}

TEST(Dtw, IsTheSameWalkedBackwardsMovedOrTurned) {
  std::mt19937_64 rng(4);
  const Path a = randomPath(rng, 90), b = randomPath(rng, 70);
  const double distance = dtw(a, b);
  const auto both = [&](auto&& map) {
    Path mappedA = a, mappedB = b;
    for (glm::dvec2& point : mappedA) point = map(point);
    for (glm::dvec2& point : mappedB) point = map(point);
    return dtw(mappedA, mappedB);
  };
  EXPECT_NEAR(dtw(Path(a.rbegin(), a.rend()), Path(b.rbegin(), b.rend())), distance, 1e-9);
  EXPECT_NEAR(both([](glm::dvec2 p) { return p + glm::dvec2(3, -8); }), distance, 1e-9);
  EXPECT_NEAR(
      both([](glm::dvec2 p) { return glm::dvec2(0.6 * p.x - 0.8 * p.y, 0.8 * p.x + 0.6 * p.y); }),
      distance, 1e-9);
  EXPECT_NEAR(both([](glm::dvec2 p) { return 4.0 * p; }), 4.0 * distance, 1e-9);
}

TEST(Dtw, SeesNoDifferenceInStandingStill) {
  std::mt19937_64 rng(5);
  const Path a = randomPath(rng, 40);
  Path waiting = a;
  waiting.insert(waiting.begin() + 17, 25, a[17]);
  EXPECT_EQ(dtw(a, waiting), 0.0);
}

TEST(ResampleByLength, KeepsEndsAndSpacing) {
  const Path corner{{0, 0}, {3, 0}, {3, 0}, {3, 4}};
  EXPECT_DOUBLE_EQ(pathLength(corner), 7.0);
  const Path even = resampleByLength(corner, 0.5);
  ASSERT_EQ(even.size(), 15u);
  EXPECT_EQ(even.front(), corner.front());
  EXPECT_EQ(even.back(), corner.back());
  for (std::size_t i = 0; i < even.size(); ++i) {
    const double along = 0.5 * static_cast<double>(i);
    const glm::dvec2 expected =
        along <= 3.0 ? glm::dvec2(along, 0.0) : glm::dvec2(3.0, along - 3.0);
    EXPECT_NEAR(glm::distance(even[i], expected), 0.0, 1e-12);
  }
  EXPECT_EQ(resampleByLength(corner, 100.0), (Path{{0, 0}, {3, 4}}));
}

TEST(ResampleByLength, OfAStandingWalkerIsOnePoint) {
  EXPECT_EQ(resampleByLength(Path{{2, 1}}, 0.1), (Path{{2, 1}}));
  EXPECT_EQ(resampleByLength(Path{{2, 1}, {2, 1}, {2, 1}}, 0.1), (Path{{2, 1}}));
}

TEST(NormalisedDtw, IsTheDistanceOfPathsSideBySide) {
  for (const double length : {0.05, 1.0, 30.0}) {
    const Path a{{0, 0}, {length, 0}}, b{{0, 0.02}, {length, 0.02}};
    EXPECT_NEAR(normalisedDtw(a, b, 0.1), 0.02, 1e-12);
  }
}

TEST(NormalisedDtw, DoesNotDependOnWhereALegIsCut) {
  std::mt19937_64 rng(6);
  for (int round = 0; round < 20; ++round) {
    const Path a = randomPath(rng, 30), b = randomPath(rng, 20);
    Path cut;  // the same polyline, some legs sampled much denser and some waited on
    for (std::size_t i = 0; i + 1 < a.size(); ++i) {
      const int pieces = 1 + navmesh::uniformInt(rng, 9);
      for (int piece = 0; piece < pieces; ++piece) {
        cut.push_back(a[i] + static_cast<double>(piece) / pieces * (a[i + 1] - a[i]));
      }
      if (pieces > 6) cut.push_back(cut.back());
    }
    cut.push_back(a.back());
    EXPECT_GT(std::abs(dtw(cut, b) / dtw(a, b) - 1.0), 0.2);  // the raw sum does
    EXPECT_NEAR(normalisedDtw(cut, b, 0.1), normalisedDtw(a, b, 0.1), 1e-9);
    EXPECT_LT(normalisedDtw(cut, a, 0.1), 1e-9);
  }
}

TEST(NormalisedDtw, HardlyDependsOnRateSpeedOrSpacing) {
  // A winding walk and a straighter one, seen by trackers of several rates, by walkers of several
  // speeds who slow down on their way.
  const auto walk = [](double bend, double rate, double speed) {
    Path path;
    for (double t = 0.0; t * speed <= 20.0; t += 1.0 / rate) {
      const double along = t * speed - 1.5 * std::sin(t * speed * 0.3);
      path.push_back({along, bend * std::sin(0.5 * along)});
    }
    return path;
  };
  const double expected = normalisedDtw(walk(1.0, 90, 1.0), walk(0.2, 90, 1.0), 0.05);
  EXPECT_GT(expected, 0.2);
  for (const double rate : {15.0, 30.0, 90.0}) {
    for (const double speed : {0.5, 1.0, 1.8}) {
      for (const double spacing : {0.05, 0.1, 0.2}) {
        EXPECT_NEAR(normalisedDtw(walk(1.0, rate, speed), walk(0.2, 30, 1.0), spacing), expected,
                    0.03 * expected)
            << rate << " Hz, " << speed << " m/s, every " << spacing << " m";
      }
    }
  }
}

TEST(NormalisedDtw, ScalesWithThePlan) {
  std::mt19937_64 rng(7);
  Path a = randomPath(rng, 30), b = randomPath(rng, 25);
  const double distance = normalisedDtw(a, b, 0.1);
  EXPECT_EQ(distance, normalisedDtw(b, a, 0.1));
  for (Path* path : {&a, &b}) {
    for (glm::dvec2& point : *path) point *= 8.0;
  }
  EXPECT_NEAR(normalisedDtw(a, b, 0.8), 8.0 * distance, 1e-9);
}

}  // namespace
}  // namespace forewalk::agents
