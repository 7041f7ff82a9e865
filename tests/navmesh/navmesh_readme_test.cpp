// The example of navmesh/README.md, compiled and run; the last test sees that the two stay equal.
#include <gmock/gmock.h>

#include <string>

#include "tests/support/readme.h"

// clang-format off
#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
#include "navmesh/locate.h"

using namespace forewalk::navmesh;

// The taut path on the floor from one place to another; empty where there is no way.
std::vector<glm::vec3> wayBetween(const NavGraph& graph, const LocationIndex& index, glm::vec3 a, glm::vec3 b) {
  const std::optional<Location> from = locate(graph, index, a);
  const std::optional<Location> to = locate(graph, index, b);
  CorridorScratch scratch;  // keep these three from call to call, and nothing is allocated
  std::vector<std::uint32_t> corridor;
  std::vector<glm::vec2> path;
  if (!from || !to || !findCorridor(graph, *from, *to, scratch, corridor)) return {};
  pullString(graph, from->plan, to->plan, corridor, path);
  std::vector<glm::vec3> lifted;
  liftPath(graph, from->polygon, corridor, path, 0.02f, lifted);
  return lifted;
}
// clang-format on

namespace {

// A floor of 2 m x 2 m without its far right quarter, made of three squares.
PolygonMesh lShapedFloor() {
  PolygonMesh mesh;
  for (const glm::vec2 p :
       {glm::vec2{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}, {0, 2}, {1, 2}}) {
    mesh.vertices.push_back({p.x, 0.5f, -p.y});
  }
  mesh.ring = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6};
  mesh.ringStart = {0, 4, 8, 12};
  return mesh;
}

TEST(NavmeshReadme, FindsTheWayAroundACorner) {
  const NavGraph graph = *makeNavGraph(lShapedFloor());
  const LocationIndex index = makeLocationIndex(graph);
  const std::vector<glm::vec3> way =
      wayBetween(graph, index, {1.9f, 0.5f, -0.9f}, {0.9f, 0.5f, -1.9f});
  EXPECT_EQ(
      way, (std::vector<glm::vec3>{{1.9f, 0.5f, -0.9f}, {1.0f, 0.5f, -1.0f}, {0.9f, 0.5f, -1.9f}}));
  EXPECT_TRUE(wayBetween(graph, index, {1.9f, 0.5f, -0.9f}, {50.0f, 0.5f, 0.0f}).empty());
}

TEST(NavmeshReadme, ShowsTheExampleThatIsCompiledHere) {
  using forewalk::testing::contentsOf;
  EXPECT_THAT(contentsOf(FOREWALK_SOURCE "/tests/navmesh/navmesh_readme_test.cpp"),
              ::testing::HasSubstr(
                  forewalk::testing::firstExampleIn(FOREWALK_SOURCE "/navmesh/README.md")));
}

}  // namespace
