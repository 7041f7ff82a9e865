// How distances rise and fall along walls.
#include "prediction/wall_profile.h"

#include <gtest/gtest.h>

#include "prediction/front_graph.h"
#include "tests/support/linked_fronts.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

/// The walls of a random floor as seen from a place, out to a horizon.
struct Profile {
  Profile(const navmesh::NavGraph& graph, const FrontIndex& index)
      : field(graph, index.ends),
        views(graph.polygonCount(), 1u << 15),
        walls(index.cells, index.ends.count()) {}

  void measure(const navmesh::Location& source, float horizon) {
    field.run(source, horizon);
    views.gather(field);
    walls.measure(field, views, horizon);
  }

  DistanceField field;
  Views views;
  WallProfile walls;
};

// A level beyond the top of a stretch once led around its border for ever, where all of that lies
// within the level.
TEST(WallProfile, BeyondTheTopOfAStretchIsItsTop) {
  std::size_t tops = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const navmesh::World world = testing::worldOf(testing::meshOf(seed));
    const FrontIndex index = makeFrontIndex(world.graph);
    Profile profile(world.graph, index);
    for (const navmesh::Location& start : testing::randomStarts(world.graph, 4, seed)) {
      constexpr float kAll = 200.0f;  // metres, beyond all there is
      profile.measure(start, kAll);
      const WallProfile& walls = profile.walls;
      for (std::uint32_t s = 0; s < walls.stretches().size(); ++s) {
        const WallProfile::Stretch& stretch = walls.stretches()[s];
        ASSERT_LE(stretch.top, kAll) << "every border is closed";
        const WallProfile::Reach reach = walls.reachOf(s, 0.5f * (stretch.top + kAll));
        ASSERT_LE(reach.from, reach.to);
        const glm::vec2 place(walls.placeNear(s, 0.5f * (stretch.top + kAll)));
        const CellMesh::Edge& edge = index.cells.edges[index.cells.walls[reach.wall].edge];
        EXPECT_NEAR(profile.field.distanceAt(edge.left, place), stretch.top, 2e-3f)
            << "seed " << seed << " stretch " << s;
        ++tops;
      }
    }
  }
  EXPECT_GT(tops, 500u);
}

/// A stretch is as far away at each level as it says.
TEST(WallProfile, AStretchReachesEveryLevelUpToItsTop) {
  std::size_t levels = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const navmesh::World world = testing::worldOf(testing::meshOf(seed));
    const FrontIndex index = makeFrontIndex(world.graph);
    Profile profile(world.graph, index);
    for (const navmesh::Location& start : testing::randomStarts(world.graph, 4, seed)) {
      profile.measure(start, 7.0f);
      const WallProfile& walls = profile.walls;
      for (std::uint32_t s = 0; s < walls.stretches().size(); ++s) {
        const float low = walls.samples()[walls.stretches()[s].low].value;
        const float top = std::min(walls.stretches()[s].top, 7.0f);
        for (const float share : {0.1f, 0.5f, 0.9f}) {
          const float level = low + share * (top - low);
          const WallProfile::Reach reach = walls.reachOf(s, level);
          const CellMesh::Wall& wall = index.cells.walls[reach.wall];
          const CellMesh::Line& line = index.cells.lines[wall.edge];
          const auto at = [&](double along) {
            return profile.field.distanceAt(index.cells.edges[wall.edge].left,
                                            glm::vec2(line.from + along * line.along));
          };
          const float from = at(reach.from), to = at(reach.to);
          EXPECT_LE(std::min(from, to), level + 2e-3f) << "seed " << seed << " stretch " << s;
          EXPECT_GE(std::max(from, to), level - 2e-3f) << "seed " << seed << " stretch " << s;
          ++levels;
        }
      }
    }
  }
  EXPECT_GT(levels, 1000u);
}

}  // namespace
}  // namespace forewalk::prediction
