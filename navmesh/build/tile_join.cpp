#include "navmesh/build/tile_join.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "navmesh/graph_rows.h"

namespace forewalk::navmesh {
namespace {

constexpr std::uint32_t kNoTile = 0xffffffffu;

/// One side of a crossing, in the row of its polygon.
struct CrossingEnd {
  std::uint32_t polygon;  // of its tile
  std::uint32_t edge;
  float along;
  std::uint32_t to;      // polygon of the whole graph
  std::uint32_t number;  // of the crossing, over all seams
  const Crossing* crossing;
  int side;
};

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from, std::uint32_t begin,
            std::uint32_t end) {
  to.insert(to.end(), from.begin() + begin, from.begin() + end);
}

/// Puts the tiles' graphs behind each other, their rows with the crossings in them.
class Assembly {
 public:
  void reserve(std::span<const std::shared_ptr<const TilePiece>> pieces, std::size_t crossings) {
    std::size_t polygons = 0, corners = 0, halves = 2 * crossings, triangles = 0;
    for (const auto& piece : pieces) {
      if (piece == nullptr) continue;
      const NavGraph& graph = piece->graph;
      polygons += graph.polygonCount();
      corners += graph.ring.size();
      halves += graph.portalCount();
      triangles += graph.heightTriangles.size();
    }
    graph_.portalStart.reserve(polygons + 1);
    graph_.ringStart.reserve(polygons + 1);
    graph_.centroid.reserve(polygons);
    graph_.centroidHeight.reserve(polygons);
    graph_.ring.reserve(corners);
    graph_.ringHeight.reserve(corners);
    graph_.portalTo.reserve(halves);
    graph_.portalTwin.reserve(halves);
    graph_.portalToCentroid.reserve(halves);
    graph_.portalMidpoint.reserve(halves);
    graph_.portals.reserve(halves);
    graph_.portalEdge.reserve(halves);
    graph_.portalHeights.reserve(halves);
    graph_.heightTriangles.reserve(triangles);
    if (triangles > 0) {
      graph_.heightStart.reserve(polygons + 1);
      graph_.heightStart.push_back(0);
    }
    ends_.resize(crossings);
  }

  std::uint32_t polygonCount() const { return graph_.polygonCount(); }

  /// All that knows nothing of other tiles: of every tile, before the first addRows.
  void addShapes(const NavGraph& tile) {
    const auto corners = static_cast<std::uint32_t>(graph_.ring.size());
    for (std::uint32_t p = 0; p < tile.polygonCount(); ++p) {
      graph_.ringStart.push_back(corners + tile.ringStart[p + 1]);
    }
    append(graph_.ring, tile.ring);
    append(graph_.ringHeight, tile.ringHeight);
    append(graph_.centroid, tile.centroid);
    append(graph_.centroidHeight, tile.centroidHeight);
    if (graph_.heightStart.empty()) return;
    const auto triangles = static_cast<std::uint32_t>(graph_.heightTriangles.size());
    for (std::uint32_t p = 0; p < tile.polygonCount(); ++p) {
      graph_.heightStart.push_back(triangles +
                                   (tile.heightStart.empty() ? 0 : tile.heightStart[p + 1]));
    }
    append(graph_.heightTriangles, tile.heightTriangles);
  }

  /// The rows of a tile whose polygons begin at `base`, with its sorted crossings.
  void addRows(const NavGraph& tile, std::uint32_t base, std::span<const CrossingEnd> crossings) {
    const std::uint32_t first = graph_.portalCount();
    // Where each half-portal of the tile's own goes: behind the crossings of the rows before it.
    places_.resize(tile.portalCount());
    auto next = crossings.begin();
    std::uint32_t copied = 0;
    for (std::uint32_t p = 0; p < tile.polygonCount(); ++p) {
      for (; next != crossings.end() && next->polygon == p; ++next) {
        std::uint32_t h = copied;
        while (h < tile.portalStart[p + 1] &&
               (h < tile.portalStart[p] || tile.portalEdge[h] < next->edge)) {
          ++h;
        }
        copyRows(tile, base, copied, h);
        copied = h;
        addCrossing(*next);
      }
      if (next == crossings.end() || next->polygon != p + 1) continue;
      copyRows(tile, base, copied, tile.portalStart[p + 1]);
      copied = tile.portalStart[p + 1];
    }
    copyRows(tile, base, copied, tile.portalCount());
    for (std::uint32_t h = 0; h < tile.portalCount(); ++h) {
      graph_.portalTwin[places_[h]] = places_[tile.portalTwin[h]];
    }
    auto crossing = crossings.begin();
    std::uint32_t before = first;
    for (std::uint32_t p = 0; p < tile.polygonCount(); ++p) {
      for (; crossing != crossings.end() && crossing->polygon == p; ++crossing) ++before;
      graph_.portalStart.push_back(before + tile.portalStart[p + 1]);
    }
  }

  std::optional<NavGraph> finish() && {
    for (const auto& [one, other] : ends_) {
      graph_.portalTwin[one] = other;
      graph_.portalTwin[other] = one;
    }
    if (!completeRows(graph_)) return std::nullopt;
    return std::move(graph_);
  }

 private:
  void copyRows(const NavGraph& tile, std::uint32_t base, std::uint32_t begin, std::uint32_t end) {
    std::uint32_t place = graph_.portalCount();
    for (std::uint32_t h = begin; h < end; ++h) {
      places_[h] = place++;
      graph_.portalTo.push_back(PolygonId{base + index(tile.portalTo[h])});
    }
    graph_.portalTwin.resize(place);
    append(graph_.portalToCentroid, tile.portalToCentroid, begin, end);
    append(graph_.portalMidpoint, tile.portalMidpoint, begin, end);
    append(graph_.portals, tile.portals, begin, end);
    append(graph_.portalEdge, tile.portalEdge, begin, end);
    append(graph_.portalHeights, tile.portalHeights, begin, end);
  }

  void addCrossing(const CrossingEnd& end) {
    ends_[end.number][end.side] = graph_.portalCount();
    const Crossing& crossing = *end.crossing;
    const bool back = end.side == 1;
    const Portal ends = back ? Portal{crossing.ends.right, crossing.ends.left} : crossing.ends;
    const PortalHeights heights =
        back ? PortalHeights{crossing.heights.right, crossing.heights.left} : crossing.heights;
    const glm::vec2 middle = midpointOf(ends);
    graph_.portalTo.push_back(PolygonId{end.to});
    graph_.portalTwin.push_back(0);
    graph_.portalToCentroid.push_back(glm::distance(middle, graph_.centroid[end.to]));
    graph_.portalMidpoint.push_back(middle);
    graph_.portals.push_back(ends);
    graph_.portalEdge.push_back(end.edge);
    graph_.portalHeights.push_back(heights);
  }

  NavGraph graph_;
  std::vector<std::array<std::uint32_t, 2>> ends_;  // per crossing: its half-portals
  std::vector<std::uint32_t> places_;               // of one tile's half-portals in the graph
};

/// The crossings of one tile in the order of its rows.
class EndsOfTile {
 public:
  void restart(const TilePiece& piece) {
    piece_ = &piece;
    ends_.clear();
  }

  /// `side` is this tile's; `base` where the other tile's polygons begin; `number` that of the
  /// seam's first crossing.
  void add(const Seam& seam, int side, std::uint32_t base, std::uint32_t number) {
    const NavGraph& graph = piece_->graph;
    for (const Crossing& crossing : seam.crossings) {
      const std::uint32_t polygon = crossing.polygon[side], edge = crossing.edge[side];
      const std::span<const glm::vec2> ring = graph.ringOf(PolygonId{polygon});
      const Portal ends =
          side == 1 ? Portal{crossing.ends.right, crossing.ends.left} : crossing.ends;
      const float along = alongEdge(ring[edge], ring[edge + 1 < ring.size() ? edge + 1 : 0], ends);
      ends_.push_back(
          {polygon, edge, along, base + crossing.polygon[1 - side], number++, &crossing, side});
    }
  }

  /// Empty optional where an edge is shared and has another crossing, too.
  std::optional<std::span<const CrossingEnd>> sorted() {
    std::sort(ends_.begin(), ends_.end(), [](const CrossingEnd& a, const CrossingEnd& b) {
      return std::tie(a.polygon, a.edge, a.along, a.to, a.number) <
             std::tie(b.polygon, b.edge, b.along, b.to, b.number);
    });
    for (std::size_t i = 1; i < ends_.size(); ++i) {
      const CrossingEnd &a = ends_[i - 1], &b = ends_[i];
      if (a.polygon == b.polygon && a.edge == b.edge && (a.crossing->shared || b.crossing->shared))
        return std::nullopt;
    }
    return ends_;
  }

 private:
  const TilePiece* piece_ = nullptr;
  std::vector<CrossingEnd> ends_;
};

}  // namespace

TileJoin::TileJoin(std::size_t columns, std::size_t rows, const BuildSettings& settings)
    : columns_(columns),
      rows_(rows),
      climb_(settings.climb),
      // On one place of the grid Recast takes corners for one up to two voxels apart in height.
      spacing_(std::min(settings.cell, 3.0f * settings.cellHeight)),
      pieces_(columns * rows),
      east_(columns * rows),
      south_(columns * rows) {}

std::uint32_t TileJoin::neighbour(std::uint32_t tile, int east, int south) const {
  const auto column = static_cast<std::ptrdiff_t>(tile % columns_) + east;
  const auto row = static_cast<std::ptrdiff_t>(tile / columns_) + south;
  if (column < 0 || row < 0 || column >= static_cast<std::ptrdiff_t>(columns_) ||
      row >= static_cast<std::ptrdiff_t>(rows_)) {
    return kNoTile;
  }
  return static_cast<std::uint32_t>(row * static_cast<std::ptrdiff_t>(columns_) + column);
}

const TilePiece* TileJoin::pieceAt(std::uint32_t tile) const {
  return tile == kNoTile ? nullptr : pieces_[tile].get();
}

/// Makes the piece of a tile again where its shape is new or its vertices weld elsewhere.
void TileJoin::renew(std::uint32_t tile, std::shared_ptr<const TileShape> shape,
                     std::vector<char>& changed) {
  const std::array<const TilePiece*, 4> earlier{
      pieceAt(neighbour(tile, -1, -1)), pieceAt(neighbour(tile, 0, -1)),
      pieceAt(neighbour(tile, 1, -1)), pieceAt(neighbour(tile, -1, 0))};
  TileWelds welds = weld(*shape, earlier);
  const TilePiece* before = pieces_[tile].get();
  if (before != nullptr && before->shape == shape && before->welds == welds) return;
  changed[tile] = 1;
  pieces_[tile] = makePiece(std::move(shape), std::move(welds));
}

void TileJoin::replace(std::span<const std::uint32_t> numbers, std::span<const DetourTile> tiles) {
  std::vector<char> changed(pieces_.size(), 0);
  std::vector<std::uint32_t> around;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    changed[numbers[i]] = 1;
    // Gone before its neighbours look at it.
    pieces_[numbers[i]] = nullptr;
    for (int south = -1; south <= 1; ++south) {
      for (int east = -1; east <= 1; ++east) {
        const std::uint32_t tile = neighbour(numbers[i], east, south);
        if (tile != kNoTile) around.push_back(tile);
      }
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  // In ascending order: a tile's welds depend on those of the ones before it.
  for (const std::uint32_t tile : around) {
    const auto number = std::lower_bound(numbers.begin(), numbers.end(), tile);
    if (number != numbers.end() && *number == tile) {
      const DetourTile& bytes = tiles[static_cast<std::size_t>(number - numbers.begin())];
      if (!bytes.empty()) renew(tile, shapeOf(bytes, spacing_), changed);
    } else if (pieces_[tile] != nullptr) {
      renew(tile, pieces_[tile]->shape, changed);
    }
  }
  const auto renewSeam = [&](std::shared_ptr<const Seam>& seam, std::uint32_t one,
                             std::uint32_t other) {
    if (other == kNoTile || (changed[one] == 0 && changed[other] == 0)) return;
    const TilePiece *a = pieceAt(one), *b = pieceAt(other);
    seam = a == nullptr || b == nullptr ? nullptr : makeSeam(*a, *b, climb_);
  };
  for (const std::uint32_t tile : around) {
    for (const auto& [one, east, south] :
         {std::tuple(tile, 1, 0), std::tuple(tile, 0, 1), std::tuple(neighbour(tile, -1, 0), 1, 0),
          std::tuple(neighbour(tile, 0, -1), 0, 1)}) {
      if (one == kNoTile) continue;
      renewSeam(east == 1 ? east_[one] : south_[one], one, neighbour(one, east, south));
    }
  }
}

std::optional<NavGraph> TileJoin::join() const {
  if (!hasGround()) return NavGraph{};
  Assembly assembly;
  std::uint32_t crossings = 0;
  std::vector<std::uint32_t> polygonBase(pieces_.size(), 0), eastNumber(pieces_.size(), 0),
      southNumber(pieces_.size(), 0);
  for (std::size_t tile = 0; tile < pieces_.size(); ++tile) {
    if (pieces_[tile] != nullptr && pieces_[tile]->odd) return std::nullopt;
    for (const auto& [seam, number] : {std::pair(&east_[tile], &eastNumber[tile]),
                                       std::pair(&south_[tile], &southNumber[tile])}) {
      if (*seam == nullptr) continue;
      if ((*seam)->odd) return std::nullopt;
      *number = crossings;
      crossings += static_cast<std::uint32_t>((*seam)->crossings.size());
    }
  }
  assembly.reserve(pieces_, crossings);
  for (std::size_t tile = 0; tile < pieces_.size(); ++tile) {
    polygonBase[tile] = assembly.polygonCount();
    if (pieces_[tile] != nullptr) assembly.addShapes(pieces_[tile]->graph);
  }
  EndsOfTile ends;
  for (std::uint32_t tile = 0; tile < pieces_.size(); ++tile) {
    if (pieces_[tile] == nullptr) continue;
    ends.restart(*pieces_[tile]);
    const std::uint32_t west = neighbour(tile, -1, 0), north = neighbour(tile, 0, -1);
    if (north != kNoTile && south_[north]) {
      ends.add(*south_[north], 1, polygonBase[north], southNumber[north]);
    }
    if (west != kNoTile && east_[west]) {
      ends.add(*east_[west], 1, polygonBase[west], eastNumber[west]);
    }
    if (east_[tile]) ends.add(*east_[tile], 0, polygonBase[tile + 1], eastNumber[tile]);
    if (south_[tile]) {
      ends.add(*south_[tile], 0, polygonBase[tile + columns_], southNumber[tile]);
    }
    const auto sorted = ends.sorted();
    if (!sorted) return std::nullopt;
    assembly.addRows(pieces_[tile]->graph, polygonBase[tile], *sorted);
  }
  return std::move(assembly).finish();
}

bool TileJoin::hasGround() const {
  return std::any_of(pieces_.begin(), pieces_.end(),
                     [](const auto& piece) { return piece != nullptr; });
}

std::vector<DetourTile> TileJoin::tilesWithGround() const {
  std::vector<DetourTile> tiles;
  for (const auto& piece : pieces_) {
    if (piece != nullptr) tiles.push_back(piece->shape->bytes);
  }
  return tiles;
}

}  // namespace forewalk::navmesh
