#include "prediction/front_arc.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/line_world.h"

namespace forewalk::prediction {
namespace {

PredictionGraph withFront(glm::vec2 from, glm::vec2 middle, glm::vec2 to, float length) {
  PredictionGraph graph = testing::lineGraph({0, 0}, glm::length(middle), {{{{middle}}}});
  graph.fronts.push_back({from, to, length});
  return graph;
}

glm::vec2 onCircle(float radius, float angle) {
  return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

TEST(FrontArc, LiesOnTheCircleThroughEndsAndMiddle) {
  for (const float radius : {0.5f, 3.0f, 20.0f}) {
    for (const float span : {-6.0f, -3.2f, -1.0f, 0.3f, 2.0f, 3.14159f, 4.0f, 6.2f}) {
      const float start = 0.7f;
      const FrontLine line =
          frontLine(withFront(onCircle(radius, start), onCircle(radius, start + 0.5f * span),
                              onCircle(radius, start + span), radius * std::abs(span)),
                    0);
      for (int i = 0; i < kFrontPoints; ++i) {
        const float angle = start + span * static_cast<float>(i) / (kFrontPoints - 1);
        EXPECT_LT(glm::distance(line[static_cast<std::size_t>(i)], onCircle(radius, angle)),
                  1e-3f * radius)
            << "radius " << radius << ", span " << span << ", point " << i;
      }
    }
  }
}

TEST(FrontArc, IsStraightWhereTheThreePointsAre) {
  const FrontLine line = frontLine(withFront({0, 0}, {2, 2}, {6, 6}, 8.485f), 0);
  for (std::size_t i = 0; i < line.size(); ++i) {
    EXPECT_NEAR(line[i].x, line[i].y, 1e-5f);
    if (i > 0) {
      EXPECT_GT(line[i].x, line[i - 1].x);
    }
  }
  EXPECT_EQ(line[kFrontPoints / 2], glm::vec2(2, 2));
  EXPECT_EQ(line.back(), glm::vec2(6, 6));
}

TEST(FrontArc, GoesAllAroundWhereTheFrontIsClosed) {
  const FrontLine line = frontLine(withFront({3, 0}, {-3, 0}, {3, 0}, 18.85f), 0);
  glm::vec2 sum(0.0f);
  for (std::size_t i = 1; i < line.size(); ++i) {
    EXPECT_NEAR(glm::length(line[i]), 3.0f, 1e-3f);
    sum += line[i];
  }
  EXPECT_LT(glm::length(sum), 1e-3f);
}

TEST(FrontArc, IsThePointWhereThereIsNoFront) {
  PredictionGraph graph = testing::lineGraph({0, 0}, 5.0f, {{{{1, 2}}}});
  for (const glm::vec2 point : frontLine(graph, 0)) EXPECT_EQ(point, glm::vec2(1, 2));
  graph.fronts.push_back({{1, 2}, {1, 2}, 0.0f});
  for (const glm::vec2 point : frontLine(graph, 0)) EXPECT_EQ(point, glm::vec2(1, 2));
}

TEST(FrontArc, MeasuresDistanceToThePiecesOfALine) {
  const glm::vec2 line[] = {{0, 0}, {2, 0}, {2, 2}, {2, 2}};
  EXPECT_FLOAT_EQ(distanceToLine({1, 1}, line), 1.0f);
  EXPECT_FLOAT_EQ(distanceToLine({-3, 4}, line), 5.0f);
  EXPECT_FLOAT_EQ(distanceToLine({2, 5}, line), 3.0f);
  EXPECT_FLOAT_EQ(distanceToLine({4, 1}, std::span(line, 1)), std::sqrt(17.0f));
}

}  // namespace
}  // namespace forewalk::prediction
