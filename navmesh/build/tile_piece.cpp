#include "navmesh/build/tile_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

/// How far rounding may move a vertex of a tile, metres.
float noiseOf(const TilePolygons& tile) {
  float largest = 0.0f;
  for (const glm::vec3 corner : {tile.low, tile.high}) {
    largest = std::max({largest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  }
  return 4.0f * std::numeric_limits<float>::epsilon() * largest;
}

/// How far a place lies within the tile's bounds on the plan, metres; negative outside.
float depthOf(glm::vec3 place, const TilePolygons& tile) {
  return std::min(std::min(place.x - tile.low.x, tile.high.x - place.x),
                  std::min(place.z - tile.low.z, tile.high.z - place.z));
}

}  // namespace

std::shared_ptr<const TileShape> shapeOf(DetourTile bytes, float spacing) {
  auto shape = std::make_shared<TileShape>();
  shape->bytes = std::move(bytes);
  auto polygons = polygonsOfTile(shape->bytes, {}, "");
  if (!polygons) {
    shape->odd = true;
    return shape;
  }
  shape->alone = std::move(*polygons);
  const TilePolygons& alone = shape->alone;
  const float noise = noiseOf(alone);
  shape->odd = alone.welded || !(spacing - noise > 4.0f * kWeld);
  for (std::uint32_t v = 0; v < alone.mesh.vertices.size(); ++v) {
    const float depth = depthOf(alone.mesh.vertices[v], alone);
    if (depth <= 2.0f * kWeld + noise) shape->border.push_back(v);
    shape->odd = shape->odd || !(depth >= -noise);
  }
  return shape;
}

TileWelds weld(const TileShape& shape, std::span<const TilePiece* const> earlier) {
  TileWelds welds;
  for (const std::uint32_t vertex : shape.border) {
    glm::vec3 place = shape.alone.mesh.vertices[vertex];
    char stays = 1;
    for (std::size_t i = 0; i < earlier.size() && stays != 0; ++i) {
      if (earlier[i] == nullptr) continue;
      const TileWelds& there = earlier[i]->welds;
      for (std::size_t k = 0; k < there.places.size(); ++k) {
        if (there.stays[k] == 0 || std::abs(there.places[k].x - place.x) > 2.0f * kWeld ||
            !isWelded(there.places[k], place)) {
          continue;
        }
        place = there.places[k];
        stays = 0;
        break;
      }
    }
    welds.places.push_back(place);
    welds.stays.push_back(stays);
  }
  return welds;
}

std::shared_ptr<const TilePiece> makePiece(std::shared_ptr<const TileShape> shape,
                                           TileWelds welds) {
  auto piece = std::make_shared<TilePiece>();
  piece->shape = std::move(shape);
  piece->welds = std::move(welds);
  const TileShape& from = *piece->shape;
  if (from.odd) {
    piece->odd = true;
    return piece;
  }
  std::vector<glm::vec3> places = from.alone.mesh.vertices;
  std::vector<char> onBorder(places.size(), 0);
  for (std::size_t k = 0; k < from.border.size(); ++k) {
    places[from.border[k]] = piece->welds.places[k];
    onBorder[from.border[k]] = 1;
  }
  const TilePolygons* polygons = &from.alone;
  tl::expected<TilePolygons, Error> moved;
  if (places != from.alone.mesh.vertices) {
    moved = polygonsOfTile(from.bytes, places, "");
    if (!moved || moved->welded) {
      piece->odd = true;
      return piece;
    }
    polygons = &*moved;
  }
  auto graph = makeNavGraph(polygons->mesh);
  if (!graph) {
    piece->odd = true;
    return piece;
  }
  piece->graph = std::move(*graph);
  piece->borderEdges = polygons->borderEdges;

  const PolygonMesh& mesh = polygons->mesh;
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    const std::uint32_t begin = mesh.ringStart[p], corners = mesh.ringStart[p + 1] - begin;
    for (std::uint32_t edge = 0; edge < corners; ++edge) {
      const std::uint32_t a = mesh.ring[begin + edge], b = mesh.ring[begin + (edge + 1) % corners];
      if (onBorder[a] == 0 || onBorder[b] == 0) continue;
      bool joined = false;
      for (std::uint32_t h = piece->graph.portalStart[p]; h < piece->graph.portalStart[p + 1]; ++h)
        joined = joined || piece->graph.portalEdge[h] == edge;
      piece->outer.push_back({p, edge, mesh.vertices[a], mesh.vertices[b], joined});
    }
  }
  return piece;
}

namespace {

bool isOuterJoined(const TilePiece& piece, std::uint32_t polygon, std::uint32_t edge) {
  return std::any_of(piece.outer.begin(), piece.outer.end(), [&](const auto& outer) {
    return outer.polygon == polygon && outer.edge == edge && outer.joined;
  });
}

Crossing crossing(std::uint32_t polygon, std::uint32_t edge, std::uint32_t otherPolygon,
                  std::uint32_t otherEdge, glm::vec3 left, glm::vec3 right, bool shared) {
  return {{polygon, otherPolygon},
          {edge, otherEdge},
          {toPlan(left), toPlan(right)},
          {left.y, right.y},
          shared};
}

void findSharedEdges(const TilePiece& one, const TilePiece& other, Seam& seam) {
  for (const TilePiece::OuterEdge& a : one.outer) {
    int met = 0;
    for (const TilePiece::OuterEdge& b : other.outer) {
      const bool opposite = a.from == b.to && a.to == b.from;
      const bool sameSide = a.from == b.from && a.to == b.to;
      if (!opposite && !sameSide) continue;
      seam.odd = seam.odd || sameSide || ++met > 1 || a.joined || b.joined;
      // Counter-clockwise, whoever walks out over an edge has its end on the left.
      seam.crossings.push_back(crossing(a.polygon, a.edge, b.polygon, b.edge, a.to, a.from, true));
    }
  }
}

void findOverlaps(const TilePiece& one, const TilePiece& other, float climb, Seam& seam) {
  const std::size_t begin = seam.crossings.size();
  for (const BorderEdge& a : one.borderEdges) {
    for (const BorderEdge& b : other.borderEdges) {
      if (a.axis != b.axis || a.positive == b.positive) continue;
      if (a.atLow == b.atLow && a.atHigh == b.atHigh) continue;  // shared
      const auto portal = portalBetween(a, b, climb);
      if (!portal) continue;
      seam.odd = seam.odd || isOuterJoined(one, a.polygon, a.edge) ||
                 isOuterJoined(other, b.polygon, b.edge);
      seam.crossings.push_back(
          crossing(a.polygon, a.edge, b.polygon, b.edge, portal->left, portal->right, false));
    }
  }
  std::sort(seam.crossings.begin() + static_cast<std::ptrdiff_t>(begin), seam.crossings.end(),
            [](const Crossing& a, const Crossing& b) {
              return std::tie(a.polygon[0], a.edge[0], a.polygon[1], a.edge[1]) <
                     std::tie(b.polygon[0], b.edge[0], b.polygon[1], b.edge[1]);
            });
}

}  // namespace

std::shared_ptr<const Seam> makeSeam(const TilePiece& one, const TilePiece& other, float climb) {
  auto seam = std::make_shared<Seam>();
  if (one.odd || other.odd) {
    seam->odd = true;
    return seam;
  }
  findSharedEdges(one, other, *seam);
  findOverlaps(one, other, climb, *seam);
  return seam;
}

}  // namespace forewalk::navmesh
