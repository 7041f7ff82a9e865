// The graph of a tiled world, made again when some of its tiles change, without what has not.
//
//   tiles --shapes, welds--> a piece each: a graph of the tile alone
//         --neighbours-----> a seam for each two that touch: the portals between them
//   pieces, seams --join--> the NavGraph
//
// Replacing a tile makes its piece and its seams again, and the pieces of neighbours whose vertices
// weld elsewhere now. What is left for the whole world are copies and the passes that number it:
// successors, components, chains. The result equals polygonsFromTiles and makeNavGraph, to the
// byte; where a world has what this does not expect (tiles whose vertices nearly touch, edges with
// three polygons) join() says so, and they do the work. Internal to the builders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "navmesh/build/settings.h"
#include "navmesh/build/tile_piece.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// A value: cheap to copy, for pieces and seams are shared and never change. A change is made to a
/// copy, which takes the place of the original when all has gone well.
class TileJoin {
 public:
  TileJoin() = default;

  /// `columns` times `rows` tiles without ground, of a build with these settings.
  TileJoin(std::size_t columns, std::size_t rows, const BuildSettings& settings);

  /// Puts tiles[i], which may be empty, in the place of tile numbers[i]; ascending, row by row.
  void replace(std::span<const std::uint32_t> numbers, std::span<const DetourTile> tiles);

  /// The graph of all tiles; one without polygons where none has ground. None: the world is not
  /// what this expects. O(polygons), 0.1 ms a thousand.
  std::optional<NavGraph> join() const;

  bool hasGround() const;

  /// The tiles that have ground, as they came.
  std::vector<DetourTile> tilesWithGround() const;

 private:
  std::uint32_t neighbour(std::uint32_t tile, int east, int south) const;
  const TilePiece* pieceAt(std::uint32_t tile) const;
  void renew(std::uint32_t tile, std::shared_ptr<const TileShape> shape,
             std::vector<char>& changed);

  std::size_t columns_ = 0, rows_ = 0;
  float climb_ = 0.0f;                                     // metres
  float spacing_ = 0.0f;                                   // of vertices of one tile, metres
  std::vector<std::shared_ptr<const TilePiece>> pieces_;   // null without ground
  std::vector<std::shared_ptr<const Seam>> east_, south_;  // null where one side has no ground
};

}  // namespace forewalk::navmesh
