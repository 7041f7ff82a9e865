#include "navmesh/build/detour_tiles.h"

#include <DetourAlloc.h>
#include <DetourNavMesh.h>
#include <DetourNavMeshBuilder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <utility>

#include "navmesh/build/build.h"
#include "navmesh/nav_graph.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"
#include "tests/support/mset.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;

constexpr float kClimb = 0.25f;

std::vector<DetourTile> tilesOf(const Scene& scene, float tile, std::uint32_t corners = 6) {
  BuildSettings settings;
  settings.tile = tile;
  settings.cornersMax = corners;
  auto tiles = buildTiles(scene, settings);
  if (!tiles) throw std::runtime_error(tiles.error().message);
  return std::move(*tiles);
}

PolygonMesh polygonsOf(std::span<const DetourTile> tiles, float climb = kClimb) {
  auto polygons = polygonsFromTiles(tiles, climb, "tiles");
  if (!polygons) throw std::runtime_error(polygons.error().message);
  return std::move(*polygons);
}

NavGraph graphOf(const PolygonMesh& polygons) {
  auto graph = makeNavGraph(polygons);
  if (!graph) throw std::runtime_error(graph.error().message);
  return std::move(*graph);
}

dtMeshHeader headerOf(const DetourTile& tile) {
  dtMeshHeader header;
  std::memcpy(&header, tile.data(), sizeof(header));
  return header;
}

/// Who touches whom, both ways.
using Neighbours = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Neighbours neighboursIn(const NavGraph& graph) {
  Neighbours pairs;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
      pairs.emplace(p, index(graph.portalTo[h]));
    }
  }
  return pairs;
}

/// The same as Detour links them, polygons counted in the order of `tiles`.
Neighbours neighboursInDetour(const std::vector<DetourTile>& tiles) {
  struct Free {
    void operator()(dtNavMesh* mesh) const { dtFreeNavMesh(mesh); }
  };
  const std::unique_ptr<dtNavMesh, Free> mesh(dtAllocNavMesh());
  const dtNavMeshParams params = testing::gridOf(tiles);
  EXPECT_TRUE(dtStatusSucceed(mesh->init(&params)));
  std::vector<std::vector<std::byte>> copies = tiles;  // Detour writes its links into them
  std::vector<std::uint32_t> first(static_cast<std::size_t>(params.maxTiles), 0);
  std::vector<unsigned> at;
  std::uint32_t total = 0;
  for (DetourTile& tile : copies) {
    dtTileRef ref = 0;
    EXPECT_TRUE(dtStatusSucceed(mesh->addTile(reinterpret_cast<unsigned char*>(tile.data()),
                                              static_cast<int>(tile.size()), 0, 0, &ref)));
    at.push_back(mesh->decodePolyIdTile(ref));
    first[at.back()] = total;
    total += static_cast<std::uint32_t>(headerOf(tile).polyCount);
  }
  Neighbours pairs;
  for (const unsigned place : at) {
    const dtMeshTile* tile = std::as_const(*mesh).getTile(static_cast<int>(place));
    for (int i = 0; i < tile->header->polyCount; ++i) {
      for (unsigned link = tile->polys[i].firstLink; link != DT_NULL_LINK;
           link = tile->links[link].next) {
        unsigned salt, other, polygon;
        mesh->decodePolyId(tile->links[link].ref, salt, other, polygon);
        pairs.emplace(first[place] + static_cast<unsigned>(i), first[other] + polygon);
      }
    }
  }
  return pairs;
}

/// A strip of rectangles along z on one side of the line x = 0, as a tile: cuts[i] to cuts[i + 1],
/// in whole metres, at whole heights.
DetourTile strip(bool left, const std::vector<int>& cuts, const std::vector<int>& heights,
                 int offMeshConnections = 0, int layer = 0) {
  constexpr unsigned short kNone = 0xffff;
  constexpr int kWidth = 4;
  std::vector<unsigned short> verts, polys;
  std::vector<unsigned> detailMeshes;
  std::vector<float> detailVerts;
  std::vector<unsigned char> detailTris;
  const auto count = static_cast<int>(heights.size());
  for (int i = 0; i < count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const auto base = static_cast<unsigned short>(verts.size() / 3);
    const auto y = static_cast<unsigned short>(heights[n]);
    const auto z0 = static_cast<unsigned short>(cuts[n]),
               z1 = static_cast<unsigned short>(cuts[n + 1]);
    // Counter-clockwise on the plan: z falls as plan y rises.
    for (const auto& [x, z] :
         {std::pair<unsigned short, unsigned short>{0, z1}, {kWidth, z1}, {kWidth, z0}, {0, z0}}) {
      for (const unsigned short value : {x, y, z}) verts.push_back(value);
      for (const unsigned short value : {x, y, z}) detailVerts.push_back(value);
    }
    for (unsigned short k = 0; k < 6; ++k) {
      polys.push_back(k < 4 ? static_cast<unsigned short>(base + k) : kNone);
    }
    // Sides: 0 is x-, 2 is x+ in Recast's numbering.
    for (int edge = 0; edge < 6; ++edge) {
      const bool border = edge == (left ? 1 : 3);
      polys.push_back(border ? static_cast<unsigned short>(0x8000 | (left ? 2 : 0)) : kNone);
    }
    for (const unsigned value :
         {static_cast<unsigned>(4 * i), 4u, static_cast<unsigned>(2 * i), 2u}) {
      detailMeshes.push_back(value);
    }
    for (const unsigned char value : {0, 1, 2, 0, 0, 2, 3, 0}) detailTris.push_back(value);
  }
  std::vector<unsigned short> flags(heights.size(), 1);
  std::vector<unsigned char> areas(heights.size(), 0);

  dtNavMeshCreateParams params{};
  params.verts = verts.data();
  params.vertCount = 4 * count;
  params.polys = polys.data();
  params.polyFlags = flags.data();
  params.polyAreas = areas.data();
  params.polyCount = count;
  params.nvp = 6;
  params.detailMeshes = detailMeshes.data();
  params.detailVerts = detailVerts.data();
  params.detailVertsCount = 4 * count;
  params.detailTris = detailTris.data();
  params.detailTriCount = 2 * count;
  const std::vector<float> ends = {left ? -3.0f : 1.0f, 0.1f, 0.5f,
                                   left ? -2.0f : 2.0f, 0.1f, 0.6f};
  const float reach = 0.3f;
  const unsigned short connectionFlags = 1;
  const unsigned char connectionArea = 0, both = DT_OFFMESH_CON_BIDIR;
  const unsigned user = 1;
  if (offMeshConnections > 0) {
    params.offMeshConVerts = ends.data();
    params.offMeshConRad = &reach;
    params.offMeshConFlags = &connectionFlags;
    params.offMeshConAreas = &connectionArea;
    params.offMeshConDir = &both;
    params.offMeshConUserID = &user;
    params.offMeshConCount = 1;
  }
  params.tileX = left ? 0 : 1;
  params.tileLayer = layer;
  params.bmin[0] = left ? -static_cast<float>(kWidth) : 0.0f;
  params.bmax[0] = params.bmin[0] + kWidth;
  params.bmax[1] = 100.0f;
  params.bmax[2] = static_cast<float>(cuts.back());
  params.walkableHeight = 1.8f;
  params.walkableClimb = kClimb;
  params.cs = params.ch = 1.0f;
  params.buildBvTree = true;
  unsigned char* data = nullptr;
  int size = 0;
  if (!dtCreateNavMeshData(&params, &data, &size)) throw std::runtime_error("no tile");
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  DetourTile tile(bytes, bytes + size);
  dtFree(data);
  return tile;
}

float planDistance(glm::vec2 point, glm::vec2 a, glm::vec2 b) {
  const float t = std::clamp(glm::dot(point - a, b - a) / glm::dot(b - a, b - a), 0.0f, 1.0f);
  return glm::distance(point, a + t * (b - a));
}

/// Ends on both edges, left and right as the walker has them, sorted, each pair of edges once.
void expectSoundPortals(const PolygonMesh& mesh) {
  const auto key = [](const BorderPortal& p) {
    return std::tuple(p.from, p.fromEdge, p.to, p.toEdge);
  };
  for (std::size_t i = 0; i < mesh.borderPortals.size(); ++i) {
    const BorderPortal& portal = mesh.borderPortals[i];
    if (i > 0) {
      EXPECT_LT(key(mesh.borderPortals[i - 1]), key(portal));
    }
    EXPECT_LT(portal.from, portal.to);
    const glm::vec2 left = toPlan(portal.left), right = toPlan(portal.right);
    EXPECT_GT(glm::distance(left, right), 1e-3f);
    bool first = true;
    for (const auto& [polygon, edge] :
         {std::pair{portal.from, portal.fromEdge}, {portal.to, portal.toEdge}}) {
      const std::uint32_t begin = mesh.ringStart[index(polygon)];
      const std::uint32_t corners = mesh.ringStart[index(polygon) + 1] - begin;
      const glm::vec2 a = toPlan(mesh.vertices[mesh.ring[begin + edge]]);
      const glm::vec2 b = toPlan(mesh.vertices[mesh.ring[begin + (edge + 1) % corners]]);
      EXPECT_LE(planDistance(left, a, b), 1.1e-3f);
      EXPECT_LE(planDistance(right, a, b), 1.1e-3f);
      // Out of `from` the edge runs from right to left, and of `to` the other way.
      EXPECT_GT(glm::dot(left - right, first ? b - a : a - b), 0.0f);
      first = false;
    }
  }
}

// ---- Damaged and foreign bytes

TEST(PolygonsFromTiles, RefusesNoTilesAtAll) {
  const auto polygons = polygonsFromTiles({}, kClimb, "nothing");
  ASSERT_FALSE(polygons);
  EXPECT_EQ(polygons.error().code, ErrorCode::kSceneEmpty);
}

TEST(PolygonsFromTiles, RefusesEveryTruncation) {
  const DetourTile whole = tilesOf(testing::twoRooms(0.9f), 0.0f)[0];
  // What follows the detail triangles (tree, off-mesh connections) is not needed, but is promised.
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<DetourTile> tiles{
        DetourTile(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))};
    const auto polygons = polygonsFromTiles(tiles, kClimb, "short");
    ASSERT_FALSE(polygons) << size;
    EXPECT_EQ(polygons.error().code, ErrorCode::kDataDamaged);
    EXPECT_THAT(polygons.error().message, HasSubstr("tile 0"));
  }
}

TEST(PolygonsFromTiles, NamesTileAndByteOfAWildIndex) {
  std::vector<DetourTile> tiles{strip(true, {0, 2, 4}, {0, 0}), strip(false, {0, 4}, {0})};
  const std::size_t polygon = sizeof(dtMeshHeader) + 12 * 4;
  const unsigned short wild = 4;
  std::memcpy(tiles[1].data() + polygon + offsetof(dtPoly, verts), &wild, sizeof(wild));
  const auto polygons = polygonsFromTiles(tiles, kClimb, "wild");
  ASSERT_FALSE(polygons);
  EXPECT_EQ(polygons.error().code, ErrorCode::kDataDamaged);
  EXPECT_THAT(polygons.error().message, HasSubstr("wild: tile 1, byte 148"));
}

TEST(PolygonsFromTiles, RefusesCoordinatesThatAreNoPlaces) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), 1e7f}) {
    std::vector<DetourTile> tiles{strip(true, {0, 4}, {0})};
    std::memcpy(tiles[0].data() + sizeof(dtMeshHeader) + 16, &bad, sizeof(bad));
    const auto polygons = polygonsFromTiles(tiles, kClimb, "far");
    ASSERT_FALSE(polygons);
    EXPECT_EQ(polygons.error().code, ErrorCode::kDataDamaged);
  }
}

TEST(ImportMset, RefusesEveryTruncationAndAnythingBehind) {
  const std::vector<std::byte> whole = testing::msetOf(tilesOf(testing::twoRooms(0.9f), 6.4f));
  ASSERT_TRUE(importMset(whole, "whole"));
  for (std::size_t size = 0; size < whole.size(); size += size < 400 ? 1 : 37) {
    const auto navMesh = importMset(std::span(whole).first(size), "short.bin");
    ASSERT_FALSE(navMesh) << size;
    EXPECT_THAT(navMesh.error().message, HasSubstr("short.bin"));
  }
  std::vector<std::byte> longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(importMset(longer, "long"));
}

TEST(ImportMset, SurvivesFlippedBytes) {
  const std::vector<std::byte> whole = testing::msetOf(tilesOf(testing::twoRooms(0.9f), 6.4f));
  std::mt19937_64 rng(1);
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> damaged = whole;
    for (int flips = 1 + uniformInt(rng, 4); flips > 0; --flips) {
      damaged[static_cast<std::size_t>(uniformInt(rng, static_cast<int>(damaged.size())))] =
          static_cast<std::byte>(uniformInt(rng, 256));
    }
    const auto navMesh = importMset(damaged, "flipped");
    refused += !navMesh;
    if (navMesh) {
      EXPECT_TRUE(makeNavGraph(flatten(*navMesh)));
    } else {
      EXPECT_FALSE(navMesh.error().message.empty());
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(ImportMset, NamesWhatItDoesNotRead) {
  const std::vector<std::byte> good = testing::msetOf({strip(true, {0, 4}, {0})});
  ASSERT_TRUE(importMset(good, "good"));

  std::vector<std::byte> bytes = good;
  std::reverse(bytes.begin(), bytes.begin() + 4);
  EXPECT_EQ(importMset(bytes, "m").error().code, ErrorCode::kFormatUnsupported);
  EXPECT_THAT(importMset(bytes, "m").error().message, HasSubstr("byte order"));

  bytes = good;
  bytes[3] = std::byte{'T'};
  EXPECT_EQ(importMset(bytes, "m").error().code, ErrorCode::kFormatUnsupported);
  EXPECT_THAT(importMset(bytes, "m").error().message, HasSubstr("TSET"));

  bytes = good;
  bytes[4] = std::byte{2};
  EXPECT_EQ(importMset(bytes, "m").error().code, ErrorCode::kFormatUnsupported);
  EXPECT_THAT(importMset(bytes, "m").error().message, HasSubstr("version 2"));

  // With 64-bit references the tile header is 16 bytes: reference, size, padding.
  bytes = good;
  bytes.insert(bytes.begin() + 44, 4, std::byte{0});
  bytes.insert(bytes.begin() + 52, 4, std::byte{0});
  EXPECT_EQ(importMset(bytes, "m").error().code, ErrorCode::kFormatUnsupported);
  EXPECT_THAT(importMset(bytes, "m").error().message, HasSubstr("64 bits"));

  bytes = good;
  bytes[0] = std::byte{'x'};
  EXPECT_EQ(importMset(bytes, "m").error().code, ErrorCode::kFormatUnknown);
}

// ---- Sound tiles

TEST(ImportMset, BringsBackWhatRecastBuilt) {
  for (const Scene& scene : {testing::twoStoreys(), testing::twoRooms(0.9f), testing::islands()}) {
    for (const float side : {0.0f, 3.2f}) {
      const std::vector<DetourTile> tiles = tilesOf(scene, side);
      const auto navMesh = importMset(testing::msetOf(tiles), "set");
      ASSERT_TRUE(navMesh) << navMesh.error().message;
      EXPECT_EQ(flatten(*navMesh), polygonsOf(tiles));
      const BuildSettings built;
      EXPECT_EQ(navMesh->settings.radius, built.radius);
      EXPECT_EQ(navMesh->settings.height, built.height);
      EXPECT_EQ(navMesh->settings.climb, built.climb);
      EXPECT_FLOAT_EQ(navMesh->settings.cell, built.cell);
      EXPECT_FLOAT_EQ(navMesh->settings.tile, side);
      const auto valid = validate(*navMesh);
      EXPECT_TRUE(valid) << valid.error().message;
    }
  }
}

TEST(PolygonsFromTiles, NumbersPolygonsAsDetourDoesAndJoinsTheSameOnes) {
  for (const Scene& scene : {testing::twoStoreys(), testing::twoRooms(0.9f), testing::islands()}) {
    for (const float side : {0.0f, 1.6f, 3.2f, 5.0f}) {
      for (const std::uint32_t corners : {3u, 6u}) {
        const std::vector<DetourTile> tiles = tilesOf(scene, side, corners);
        const PolygonMesh polygons = polygonsOf(tiles);
        std::uint32_t count = 0;
        for (const DetourTile& tile : tiles) {
          count += static_cast<std::uint32_t>(headerOf(tile).polyCount);
        }
        EXPECT_EQ(polygons.polygonCount(), count);
        EXPECT_EQ(neighboursIn(graphOf(polygons)), neighboursInDetour(tiles))
            << scene.name << " tile " << side << " corners " << corners;
        expectSoundPortals(polygons);
      }
    }
  }
}

TEST(PolygonsFromTiles, LeavesOffMeshConnectionsOut) {
  const std::vector<DetourTile> plain{strip(true, {0, 2, 4}, {0, 0}), strip(false, {0, 4}, {0})};
  const std::vector<DetourTile> with{strip(true, {0, 2, 4}, {0, 0}, 1),
                                     strip(false, {0, 4}, {0}, 1)};
  ASSERT_GT(headerOf(with[0]).polyCount, headerOf(plain[0]).polyCount);
  EXPECT_EQ(polygonsOf(with), polygonsOf(plain));
}

TEST(PolygonsFromTiles, WeldsAcrossBordersThatDifferBelowAMillimetre) {
  std::mt19937_64 rng(2);
  const std::vector<DetourTile> tiles = tilesOf(testing::twoStoreys(), 1.6f);
  const Neighbours exact = neighboursIn(graphOf(polygonsOf(tiles)));
  for (int round = 0; round < 5; ++round) {
    std::vector<DetourTile> noisy = tiles;
    for (DetourTile& tile : noisy) {
      for (int i = 0; i < 3 * headerOf(tile).vertCount; ++i) {
        const std::size_t at = sizeof(dtMeshHeader) + 4 * static_cast<std::size_t>(i);
        float value;
        std::memcpy(&value, tile.data() + at, sizeof(value));
        value += static_cast<float>(uniform(rng, -2e-4, 2e-4));
        std::memcpy(tile.data() + at, &value, sizeof(value));
      }
    }
    const PolygonMesh polygons = polygonsOf(noisy);
    EXPECT_EQ(neighboursIn(graphOf(polygons)), exact);
    expectSoundPortals(polygons);
  }
}

TEST(PolygonsFromTiles, KeepsTheCornersOfATinyPolygonApart) {
  std::vector<DetourTile> tiles{strip(true, {0, 4}, {0})};
  // In kilometres: all corners within a weld of each other.
  for (std::size_t i = 0; i < 12; ++i) {
    const std::size_t at = sizeof(dtMeshHeader) + 4 * i;
    float value;
    std::memcpy(&value, tiles[0].data() + at, sizeof(value));
    value *= 1e-4f;
    std::memcpy(tiles[0].data() + at, &value, sizeof(value));
  }
  const PolygonMesh polygons = polygonsOf(tiles);
  ASSERT_EQ(polygons.polygonCount(), 1u);
  EXPECT_EQ(std::set(polygons.ring.begin(), polygons.ring.end()).size(), 4u);
}

TEST(PolygonsFromTiles, JoinsPartialEdgesWhereTheyOverlapAndNowhereElse) {
  std::mt19937_64 rng(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> cuts[2], heights[2];
    for (int side = 0; side < 2; ++side) {
      std::set<int> places;
      while (places.size() < 2 + static_cast<std::size_t>(uniformInt(rng, 6))) {
        places.insert(uniformInt(rng, 20));
      }
      cuts[side].assign(places.begin(), places.end());
      for (std::size_t i = 0; i + 1 < cuts[side].size(); ++i)
        heights[side].push_back(uniformInt(rng, 2));
    }
    const std::vector<DetourTile> tiles{strip(true, cuts[0], heights[0]),
                                        strip(false, cuts[1], heights[1])};
    const PolygonMesh polygons = polygonsOf(tiles);
    expectSoundPortals(polygons);

    // Brute force: the overlap of every pair of level edges of one height.
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> expected;
    for (std::size_t a = 0; a < heights[0].size(); ++a) {
      for (std::size_t b = 0; b < heights[1].size(); ++b) {
        const int overlap =
            std::min(cuts[0][a + 1], cuts[1][b + 1]) - std::max(cuts[0][a], cuts[1][b]);
        if (overlap > 0 && heights[0][a] == heights[1][b]) {
          expected[{static_cast<std::uint32_t>(a),
                    static_cast<std::uint32_t>(heights[0].size() + b)}] =
              static_cast<float>(overlap);
        }
      }
    }
    const NavGraph graph = graphOf(polygons);
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> found;
    for (std::uint32_t p = 0; p < heights[0].size(); ++p) {
      for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
        const std::uint32_t to = index(graph.portalTo[h]);
        if (to < heights[0].size()) continue;  // along the strip
        found[{p, to}] += glm::distance(graph.portals[h].left, graph.portals[h].right);
      }
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(PolygonsFromTiles, KeepsStoreysApartAcrossABorder) {
  // Two layers at each place: ground at 0 m, and a floor at 3 m.
  const std::vector<DetourTile> tiles{
      strip(true, {0, 4}, {0}, 0, 0), strip(true, {0, 4}, {3}, 0, 1),
      strip(false, {1, 4}, {0}, 0, 0), strip(false, {1, 4}, {3}, 0, 1)};
  const NavGraph graph = graphOf(polygonsOf(tiles));
  EXPECT_EQ(neighboursIn(graph), (Neighbours{{0, 2}, {2, 0}, {1, 3}, {3, 1}}));
}

TEST(PolygonsFromTiles, CutsAPortalWhereOneSideRisesAboveAStep) {
  // The left edge rises by 2 m over 4 m, the right one is level: they part after climb / slope.
  std::vector<DetourTile> tiles{strip(true, {0, 4}, {0}), strip(false, {0, 4}, {0})};
  const float risen = 2.0f;
  for (const std::size_t corner : {std::size_t{2}, std::size_t{3}}) {  // at z = 0
    std::memcpy(tiles[0].data() + sizeof(dtMeshHeader) + 12 * corner + 4, &risen, sizeof(risen));
  }
  const PolygonMesh polygons = polygonsOf(tiles);
  ASSERT_EQ(polygons.borderPortals.size(), 1u);
  const BorderPortal& portal = polygons.borderPortals[0];
  EXPECT_NEAR(glm::distance(toPlan(portal.left), toPlan(portal.right)), kClimb / (risen / 4.0f),
              1e-5f);
  EXPECT_NEAR(std::max(portal.left.z, portal.right.z), 4.0f, 1e-5f);
  expectSoundPortals(polygons);
}

}  // namespace
}  // namespace forewalk::navmesh
