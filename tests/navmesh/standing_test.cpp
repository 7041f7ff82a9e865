#include "navmesh/standing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <random>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

World worldOf(const PolygonMesh& mesh) { return makeWorld(*makeNavGraph(mesh)); }

std::vector<std::uint32_t> blockedIn(const World& world, const Standing& standing) {
  std::vector<PolygonCost> blocked;
  blockedBy(world.graph, world.locations, standing, blocked);
  std::vector<std::uint32_t> polygons;
  for (const PolygonCost& one : blocked) {
    EXPECT_EQ(one.cost, standing.cost);
    polygons.push_back(index(one.polygon));
  }
  return polygons;
}

TEST(Standing, BlocksACorridorAndNotARoom) {
  const World corridor = worldOf(testing::gridMesh(5, 1));
  EXPECT_THAT(blockedIn(corridor, {{2.5f, 0.0f, -0.5f}, 0.6f}), ElementsAre(2));
  EXPECT_THAT(blockedIn(corridor, {{2.5f, 0.0f, -0.5f}, 0.4f}), IsEmpty()) << "there is room";
  EXPECT_THAT(blockedIn(corridor, {{2.0f, 0.0f, -0.5f}, 0.6f}), ElementsAre(1, 2)) << "both";
  EXPECT_THAT(blockedIn(corridor, {{0.5f, 0.0f, -0.5f}, 0.6f}), IsEmpty()) << "a dead end";
  EXPECT_THAT(blockedIn(corridor, {{2.5f, 3.0f, -0.5f}, 0.6f}), IsEmpty()) << "a storey above";
  EXPECT_THAT(blockedIn(corridor, {{2.5f, 0.0f, 9.0f}, 0.6f}), IsEmpty());
  EXPECT_THAT(blockedIn(corridor, {{2.5f, 0.0f, -0.5f}, 9.0f}), ElementsAre(0, 1, 2, 3, 4));
  const World hall = worldOf(testing::gridMesh(3, 1, 4.0f));
  EXPECT_THAT(blockedIn(hall, {{6.0f, 0.0f, -2.0f}, 0.6f}), IsEmpty());
  EXPECT_THAT(blockedIn(hall, {{6.0f, 0.0f, -2.0f}, 2.1f}), ElementsAre(1));
  EXPECT_THAT(blockedIn(worldOf(testing::gridMesh(3, 3)), {{1.5f, 0.0f, -1.5f}, 0.72f}),
              ElementsAre(4))
      << "from no side to another";
  EXPECT_THAT(blockedIn(worldOf(testing::gridMesh(3, 3)), {{1.5f, 0.0f, -1.5f}, 0.55f}), IsEmpty())
      << "around its corners";
  const World none = makeWorld(NavGraph{});
  EXPECT_THAT(blockedIn(none, {}), IsEmpty());
}

/// Whether two portals are joined by the cells of a fine grid that lie in the polygon, off the
/// disc.
bool joinedOnAGrid(const NavGraph& graph, PolygonId polygon, glm::vec2 centre, float radius) {
  constexpr int kCells = 150;
  glm::vec2 low(1e9f), high(-1e9f);
  for (const glm::vec2 corner : graph.ringOf(polygon)) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const glm::vec2 step = (high - low) / static_cast<float>(kCells);
  std::vector<int> label(kCells * kCells, -1);
  const auto place = [&](int cell) {
    return low + step * glm::vec2(static_cast<float>(cell % kCells) + 0.5f,
                                  static_cast<float>(cell / kCells) + 0.5f);
  };
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const bool free =
        contains(graph, polygon, place(cell)) && glm::distance(place(cell), centre) >= radius;
    label[static_cast<std::size_t>(cell)] = free ? 0 : -1;
  }
  int pieces = 0;
  std::vector<int> open;
  for (int seed = 0; seed < kCells * kCells; ++seed) {
    if (label[static_cast<std::size_t>(seed)] != 0) continue;
    label[static_cast<std::size_t>(seed)] = ++pieces;
    open.push_back(seed);
    while (!open.empty()) {
      const int cell = open.back();
      open.pop_back();
      for (const int to :
           {cell % kCells > 0 ? cell - 1 : -1, cell % kCells + 1 < kCells ? cell + 1 : -1,
            cell - kCells, cell + kCells}) {
        if (to < 0 || to >= kCells * kCells || label[static_cast<std::size_t>(to)] != 0) continue;
        label[static_cast<std::size_t>(to)] = pieces;
        open.push_back(to);
      }
    }
  }
  // Which pieces each portal touches.
  const float near = 2.0f * glm::length(step);
  std::vector<std::uint32_t> seenBy(static_cast<std::size_t>(pieces) + 1, 0);
  for (std::uint32_t h = graph.portalStart[index(polygon)];
       h < graph.portalStart[index(polygon) + 1]; ++h) {
    std::vector<char> touched(seenBy.size(), 0);
    const Portal& portal = graph.portals[h];
    for (int cell = 0; cell < kCells * kCells; ++cell) {
      const int piece = label[static_cast<std::size_t>(cell)];
      if (piece <= 0) continue;
      const glm::vec2 edge = portal.right - portal.left, off = place(cell) - portal.left;
      const float share = std::clamp(glm::dot(off, edge) / glm::dot(edge, edge), 0.0f, 1.0f);
      if (glm::length(off - share * edge) < near) touched[static_cast<std::size_t>(piece)] = 1;
    }
    for (std::size_t i = 0; i < touched.size(); ++i) seenBy[i] += touched[i] ? 1 : 0;
  }
  return std::any_of(seenBy.begin(), seenBy.end(), [](std::uint32_t n) { return n >= 2; });
}

TEST(Standing, BlocksWhereAFloodFindsNoWayPast) {
  std::mt19937_64 rng(4);
  int blocked = 0, open = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const World world = worldOf(testing::randomMesh(seed, 5, 5));
    const NavGraph& graph = world.graph;
    for (int trial = 0; trial < 40; ++trial) {
      const auto p =
          static_cast<std::uint32_t>(uniformInt(rng, static_cast<int>(graph.polygonCount())));
      if (graph.portalStart[p + 1] - graph.portalStart[p] < 2) continue;
      const glm::vec2 centre =
          graph.centroid[p] + glm::vec2(uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5));
      const auto radius = static_cast<float>(uniform(rng, 0.2, 1.2));
      const auto blocks = [&](float r) {
        const auto all = blockedIn(world, {toSpace(centre, 0.0f), r});
        return std::find(all.begin(), all.end(), p) != all.end();
      };
      const bool now = blocks(radius);
      if (blocks(0.95f * radius) != now || blocks(1.05f * radius) != now) continue;
      (now ? blocked : open) += 1;
      wrong += joinedOnAGrid(graph, PolygonId{p}, centre, radius) == now ? 1 : 0;
    }
  }
  EXPECT_GT(blocked, 30);
  EXPECT_GT(open, 100);
  EXPECT_LE(wrong, (blocked + open) / 100);
}

TEST(Standing, SaysWhatIsWrong) {
  Standing standing;
  EXPECT_TRUE(validate(standing));
  standing.radius = 0.0f;
  EXPECT_THAT(validate(standing).error().message, HasSubstr("a radius of 0 m"));
  standing.radius = 11.0f;
  EXPECT_EQ(validate(standing).error().code, ErrorCode::kSettingOutOfRange);
  standing = {};
  standing.cost = 0.5f;
  EXPECT_EQ(validate(standing).error().code, ErrorCode::kSettingOutOfRange);
  standing = {};
  standing.foot.y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(validate(standing).error().code, ErrorCode::kDataDamaged);
}

TEST(Standing, JoinsAreasByTheHigherCost) {
  const World world = worldOf(testing::gridMesh(5, 1));
  std::vector<PolygonCost> blocked;
  blockedBy(world.graph, world.locations, {{2.5f, 0.0f, -0.5f}, 0.6f, 4.0f}, blocked);
  const PlanArea all{{{-1, -1}, {9, -1}, {9, 2}, {-1, 2}}};
  EXPECT_EQ(makePolygonStates(world.graph, std::vector<AreaCost>{{all, 2.0f}}, {}, blocked)->cost,
            (std::vector<float>{2, 2, 4, 2, 2}));
  EXPECT_EQ(makePolygonStates(world.graph, std::vector<AreaCost>{{all, 6.0f}}, {}, blocked)->cost,
            (std::vector<float>{6, 6, 6, 6, 6}));
}

}  // namespace
}  // namespace forewalk::navmesh
