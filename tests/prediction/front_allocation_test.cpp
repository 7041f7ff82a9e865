#include <gtest/gtest.h>

#include "prediction/front_graph.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

TEST(FrontGraph, AllocatesNothingAfterTheFirstFrames) {
  const navmesh::NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(2, 30, 30));
  const FrontIndex index = makeFrontIndex(graph);
  const std::vector<navmesh::Location> starts = testing::randomStarts(graph, 200, 2);
  FrontScratch scratch(graph, index);
  const auto frames = [&](std::size_t from, std::size_t to) {
    std::size_t nodes = 0;
    for (const float horizon : {1.0f, 5.0f, 20.0f}) {
      for (std::size_t i = from; i < to; ++i)
        nodes += predictFronts(graph, starts[i], horizon, scratch).nodes.size();
    }
    return nodes;
  };
  frames(0, 30);
  testing::allocationsSince();
  const std::size_t nodes = frames(30, starts.size());
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(nodes, 1000u);
}

}  // namespace
}  // namespace forewalk::prediction
