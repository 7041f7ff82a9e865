// The same building cut into other polygons gives the same branches, joins and ends of ways.
//
// Two comparisons. Floors that are the same to the last millimetre (polygons cut and merged) must
// agree to 1 cm. Floors that were built again (other cells, regions, tiles) differ by a cell along
// their walls, so nodes may move by two. In both, ways about as long as the persistence may be
// merged in one and not in the other: what one floor shows at a higher persistence must be found in
// the other at a lower one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <optional>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "navmesh/locate.h"
#include "prediction/front_graph.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using navmesh::Location;
using navmesh::NavGraph;
using navmesh::PolygonMesh;

constexpr float kPersistence = 0.75f;  // metres

/// A floor, and where to find places on it.
struct Floor {
  explicit Floor(const PolygonMesh& mesh)
      : graph(*navmesh::makeNavGraph(mesh)),
        locations(navmesh::makeLocationIndex(graph)),
        index(makeFrontIndex(graph)),
        scratch(graph, index) {}

  const PredictionGraph& ways(const Location& source, float horizon, float persistence) {
    return predictFronts(graph, source, horizon, scratch, {persistence});
  }

  NavGraph graph;
  navmesh::LocationIndex locations;
  FrontIndex index;
  FrontScratch scratch;
};

// --- The same floor in other polygons ---

/// Every polygon becomes a fan of triangles from its first corner. Heights are forgotten.
PolygonMesh inTriangles(const PolygonMesh& mesh) {
  PolygonMesh cut;
  cut.vertices = mesh.vertices;
  std::vector<std::uint32_t> first;  // triangle of each polygon
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    first.push_back(cut.polygonCount());
    const std::uint32_t* ring = mesh.ring.data() + mesh.ringStart[p];
    for (std::uint32_t k = 1; k + 1 < mesh.ringStart[p + 1] - mesh.ringStart[p]; ++k) {
      cut.ring.insert(cut.ring.end(), {ring[0], ring[k], ring[k + 1]});
      cut.ringStart.push_back(static_cast<std::uint32_t>(cut.ring.size()));
    }
  }
  const auto place = [&](PolygonId& polygon, std::uint32_t& edge) {
    const std::uint32_t p = index(polygon);
    const std::uint32_t corners = mesh.ringStart[p + 1] - mesh.ringStart[p];
    const std::uint32_t triangle = std::clamp(edge, 1u, corners - 2) - 1;
    polygon = PolygonId{first[p] + triangle};
    edge = edge == 0 ? 0 : edge == corners - 1 ? 2 : 1;
  };
  for (navmesh::BorderPortal portal : mesh.borderPortals) {
    place(portal.from, portal.fromEdge);
    place(portal.to, portal.toEdge);
    cut.borderPortals.push_back(portal);
  }
  std::sort(cut.borderPortals.begin(), cut.borderPortals.end(), [](const auto& a, const auto& b) {
    return std::tie(a.from, a.fromEdge, a.to, a.toEdge) <
           std::tie(b.from, b.fromEdge, b.to, b.toEdge);
  });
  return cut;
}

/// Every polygon becomes triangles around a corner in its middle. Heights are forgotten, and so
/// are border portals: for floors of one piece.
PolygonMesh inStars(const PolygonMesh& mesh) {
  PolygonMesh cut;
  cut.vertices = mesh.vertices;
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    const std::uint32_t* ring = mesh.ring.data() + mesh.ringStart[p];
    const std::uint32_t corners = mesh.ringStart[p + 1] - mesh.ringStart[p];
    glm::vec3 middle(0.0f);
    for (std::uint32_t k = 0; k < corners; ++k) middle += mesh.vertices[ring[k]];
    const auto centre = static_cast<std::uint32_t>(cut.vertices.size());
    cut.vertices.push_back(middle / static_cast<float>(corners));
    for (std::uint32_t k = 0; k < corners; ++k) {
      cut.ring.insert(cut.ring.end(), {ring[k], ring[(k + 1) % corners], centre});
      cut.ringStart.push_back(static_cast<std::uint32_t>(cut.ring.size()));
    }
  }
  return cut;
}

/// The same place on a floor that is cut otherwise: heights of cuts may differ a little.
std::optional<Location> samePlace(const Floor& floor, const Location& place) {
  return navmesh::locate(floor.graph, floor.locations, place.position(), {0.05f, 0.6f, 0.6f});
}

// --- What is compared ---

enum class Role { kBranch, kJoin, kMeeting, kDeadEnd, kHorizon };

/// A node, by what a person would call it.
struct Mark {
  Role role;
  glm::vec2 plan;
  float distance;
  Front front;  // of ways to the horizon
};

std::vector<Mark> marksOf(const PredictionGraph& graph) {
  std::vector<Mark> marks;
  std::size_t terminals = 0;
  for (const Node& node : graph.nodes) {
    const auto add = [&](Role role, const Front& front = {}) {
      marks.push_back({role, node.plan, node.distance, front});
    };
    if (node.kind == NodeKind::kSource) continue;
    if (node.branch) add(Role::kBranch);
    if (node.kind == NodeKind::kJoin) add(Role::kJoin);
    if (node.kind != NodeKind::kTerminal) continue;
    const Front& front = graph.fronts[terminals++];
    if (node.reason == TerminalReason::kHorizon) add(Role::kHorizon, front);
    if (node.reason == TerminalReason::kMeeting) add(Role::kMeeting);
    if (node.reason == TerminalReason::kDeadEnd) add(Role::kDeadEnd);
  }
  return marks;
}

/// Whether two marks stand for the same within `reach` metres. Ways that meet and hardly go on end
/// there, so a join at a lower persistence is a meeting at a higher one. A way to the horizon is
/// known by its middle or by a wall at which its front ends: no two fronts end at one place, and at
/// a higher persistence a front holds its neighbours too. One that is closed all around the user
/// has no end.
bool areTheSame(const Mark& a, const Mark& b, float reach) {
  const auto near = [&](glm::vec2 p, glm::vec2 q) { return glm::distance(p, q) <= reach; };
  const bool together = (a.role == Role::kJoin || a.role == Role::kMeeting) &&
                        (b.role == Role::kJoin || b.role == Role::kMeeting);
  if (a.role != b.role && !together) return false;
  if (std::abs(a.distance - b.distance) > reach) return false;
  if (near(a.plan, b.plan)) return true;
  if (a.role != Role::kHorizon) return false;
  const auto closed = [](const Front& front) { return front.from == front.to; };
  if (closed(a.front) || closed(b.front)) {
    return closed(a.front) && closed(b.front) &&
           std::abs(a.front.length - b.front.length) < 0.1f * a.front.length;
  }
  return near(a.front.from, b.front.from) || near(a.front.to, b.front.to) ||
         near(a.front.from, b.front.to) || near(a.front.to, b.front.from);
}

struct Count {
  int compared = 0, missed = 0;

  double share() const { return compared == 0 ? 0.0 : static_cast<double>(missed) / compared; }
};

struct Counts {
  std::array<Count, 5> roles;

  Count of(std::initializer_list<Role> some) const {
    Count sum;
    for (const Role role : some) {
      sum.compared += roles[static_cast<std::size_t>(role)].compared;
      sum.missed += roles[static_cast<std::size_t>(role)].missed;
    }
    return sum;
  }
};

std::ostream& operator<<(std::ostream& out, const Counts& counts) {
  constexpr const char* kNames[] = {"branches", "joins", "meetings", "dead ends", "horizon"};
  for (std::size_t r = 0; r < counts.roles.size(); ++r) {
    out << (r == 0 ? "missed: " : ", ") << counts.roles[r].missed << " of "
        << counts.roles[r].compared << ' ' << kNames[r];
  }
  return out;
}

struct Tolerance {
  float margin;  // of the persistence, metres
  float reach;   // by which nodes may move, metres
};

/// Counts the marks of `one` at the higher persistence that `other` does not show at the lower.
void compare(Floor& one, const Location& inOne, Floor& other, const Location& inOther,
             float horizon, const Tolerance& tolerance, Counts& counts) {
  const auto wanted = marksOf(one.ways(inOne, horizon, kPersistence + tolerance.margin));
  const auto found = marksOf(other.ways(inOther, horizon, kPersistence - tolerance.margin));
  for (const Mark& mark : wanted) {
    Count& count = counts.roles[static_cast<std::size_t>(mark.role)];
    ++count.compared;
    count.missed += std::none_of(found.begin(), found.end(), [&](const Mark& candidate) {
      return areTheSame(mark, candidate, tolerance.reach);
    });
  }
}

/// Both ways round, from random places.
void compareFloors(Floor& one, Floor& other, const Tolerance& tolerance, std::uint64_t seed,
                   Counts& counts) {
  for (const Location& start : testing::randomStarts(one.graph, 8, seed)) {
    const auto there = samePlace(other, start);
    if (!there) continue;
    for (const float horizon : {5.0f, 10.0f, 20.0f}) {
      compare(one, start, other, *there, horizon, tolerance, counts);
      compare(other, *there, one, start, horizon, tolerance, counts);
    }
  }
}

// --- Scenes ---

std::vector<navmesh::Scene> scenes() {
  std::vector<navmesh::Scene> all;
  const auto add = [&](const std::filesystem::path& file) {
    auto scene = navmesh::importScene(file);
    EXPECT_TRUE(scene) << scene.error().message;
    all.push_back(std::move(*scene));
  };
  for (const char* name : {"office", "museum", "two_storey", "corridor", "maze"}) {
    add(std::string(FOREWALK_ASSETS "/scenes/") + name + ".obj");
  }
  const std::filesystem::path real(FOREWALK_SHARED_DATA "/scenes/nav_test.obj");
  if (std::filesystem::exists(real)) {
    add(real);
  } else {
    std::cout << "left out, as it is not here: " << real << '\n';
  }
  return all;
}

PolygonMesh built(const navmesh::Scene& scene, const navmesh::BuildSettings& settings) {
  const auto mesh = navmesh::buildNavMesh(scene, settings);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return navmesh::flatten(*mesh);
}

// Measured: one branch and one join of 15,194 nodes are missed.
TEST(FrontIndependence, ShowsTheSameWaysOnAFloorThatIsCutOtherwise) {
  Counts all;
  for (const auto& scene : scenes()) {
    for (const float tile : {0.0f, 6.4f}) {
      const PolygonMesh mesh = built(scene, {.tile = tile});
      Floor floor(mesh);
      Floor triangles(inTriangles(mesh));
      compareFloors(floor, triangles, {0.01f, 0.01f}, 1, all);
      if (tile > 0.0f) continue;
      Floor stars(inStars(mesh));
      compareFloors(floor, stars, {0.01f, 0.01f}, 2, all);
    }
  }
  EXPECT_GT(all.of({Role::kBranch}).compared, 4000);
  EXPECT_LE(all.of({Role::kBranch}).share(), 0.001) << all;
  EXPECT_LE(all.of({Role::kDeadEnd}).share(), 0.001) << all;
  EXPECT_LE(all.of({Role::kHorizon}).share(), 0.001) << all;
  EXPECT_LE(all.of({Role::kJoin, Role::kMeeting}).share(), 0.002) << all;
}

// Measured: 1.6 % of branches, 1.3 % of dead ends, 2.2 % of ways to the horizon and 1.7 % of joins
// and meetings are missed. Four in ten of these are there at the same distance, within a metre
// along a wall that the front meets almost flat; the outlines differ by a cell.
TEST(FrontIndependence, ShowsTheSameWaysInABuildingThatIsBuiltOtherwise) {
  using navmesh::Partition;
  const navmesh::BuildSettings usual;
  std::vector<navmesh::BuildSettings> others(4, usual);
  others[0].cell = 0.15f;
  others[1].partition = Partition::kMonotone;
  others[2].partition = Partition::kLayers;
  others[3].tile = 6.4f;
  Counts all;
  for (const auto& scene : scenes()) {
    Floor floor(built(scene, usual));
    for (const navmesh::BuildSettings& settings : others) {
      Floor other(built(scene, settings));
      // Two cells, and what outlines may leave their cells by.
      const float reach = 2.0f * settings.cell + settings.edgeError;
      compareFloors(floor, other, {4.0f * settings.cell, reach}, 3, all);
    }
  }
  EXPECT_GT(all.of({Role::kBranch}).compared, 4000);
  EXPECT_LE(all.of({Role::kBranch}).share(), 0.03) << all;
  EXPECT_LE(all.of({Role::kDeadEnd}).share(), 0.03) << all;
  EXPECT_LE(all.of({Role::kHorizon}).share(), 0.04) << all;
  EXPECT_LE(all.of({Role::kJoin, Role::kMeeting}).share(), 0.04) << all;
}

}  // namespace
}  // namespace forewalk::prediction
