// The example of prediction/README.md, compiled and run; the last test sees that the two stay
// equal.
#include <gmock/gmock.h>

#include <string>

#include "tests/support/random_mesh.h"
#include "tests/support/readme.h"

// clang-format off
#include "prediction/predict.h"

using namespace forewalk;

// How many metres until the user has to decide, looking ahead from a place on the navmesh.
float metresToTheNextChoice(const navmesh::NavGraph& graph, const navmesh::Location& user) {
  prediction::Scratch scratch(graph);  // keep it from frame to frame, and nothing is allocated
  const prediction::PredictionGraph& ahead = prediction::predict(graph, user, 20.0f, scratch);
  const prediction::NodeId branch = prediction::branchAhead(ahead);
  return branch == prediction::kNoNode ? 0.0f : ahead.node(branch).distance;
}
// clang-format on

namespace {

TEST(PredictionReadme, MeasuresTheWayToTheCrossing) {
  // A plus of five squares, entered from the end of a sixth.
  const navmesh::PolygonMesh grid = forewalk::testing::gridMesh(4, 3, 2.0f);
  navmesh::PolygonMesh plus;
  plus.vertices = grid.vertices;
  for (const std::uint32_t kept : {4u, 5u, 6u, 2u, 7u, 10u}) {
    plus.ring.insert(plus.ring.end(), grid.ring.begin() + grid.ringStart[kept],
                     grid.ring.begin() + grid.ringStart[kept + 1]);
    plus.ringStart.push_back(static_cast<std::uint32_t>(plus.ring.size()));
  }
  const navmesh::NavGraph graph = *navmesh::makeNavGraph(plus);
  const navmesh::Location user{navmesh::PolygonId{0}, graph.centroid[0], 0.0f, false};
  EXPECT_NEAR(metresToTheNextChoice(graph, user), 4.0f, 1e-5f);
}

TEST(PredictionReadme, ShowsTheExampleThatIsCompiledHere) {
  using forewalk::testing::contentsOf;
  EXPECT_THAT(contentsOf(FOREWALK_SOURCE "/tests/prediction/prediction_readme_test.cpp"),
              ::testing::HasSubstr(
                  forewalk::testing::firstExampleIn(FOREWALK_SOURCE "/prediction/README.md")));
}

}  // namespace
