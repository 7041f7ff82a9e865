#include <gtest/gtest.h>

#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

TEST(Predict, AllocatesNothingFromTheFirstFrameOn) {
  const navmesh::NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(2, 30, 30));
  const std::vector<navmesh::Location> starts = testing::randomStarts(graph, 200, 2);
  Scratch scratch(graph);
  testing::allocationsSince();
  std::size_t nodes = 0;
  for (const float horizon : {1.0f, 5.0f, 20.0f, 200.0f}) {
    for (const navmesh::Location& start : starts)
      nodes += predict(graph, start, horizon, scratch).nodes.size();
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(nodes, 10000u);
  // The counter itself works.
  std::vector<int> grown(1000);
  EXPECT_EQ(testing::allocationsSince(), 1u);
}

}  // namespace
}  // namespace forewalk::prediction
