// Runs of polygons with two neighbours each: who enters one can only walk through it.
//
// Most polygons of a building are like that (seven in ten of an office floor), so a search that
// jumps from the entrance of a chain to its exit has little left to order. Contracted chains are
// common in road networks (Geisberger et al., "Contraction Hierarchies", WEA 2008); here every
// polygon of a chain is wanted as well, so its rows stay.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

struct NavGraph;

/// No chain; of exits: a dead end.
inline constexpr std::uint32_t kNoChain = 0xffffffffu;

/// A polygon of a directed chain.
struct ChainRow {
  std::uint32_t portal;  ///< half-portal into it
  PolygonId polygon;
  float length;  ///< along portal midpoints from the chain's first to `portal`, metres

  bool operator==(const ChainRow&) const = default;
};

/// One way through a chain.
struct DirectedChain {
  std::uint32_t begin;  ///< first row
  std::uint32_t end;    ///< behind its last row
  std::uint32_t exit;   ///< half-portal out of the last; kNoChain at a dead end
  PolygonId exitTo;     ///< where that leads; kNoPolygon at a dead end
  float exitLength;     ///< metres, as a row's
  float farthest;       ///< largest `length` and the step from there to the row's centroid, metres

  bool operator==(const DirectedChain&) const = default;
};

/// Directed chain `d` is one way through, `d ^ 1` the way back, d / 2 their chain. Row r of a way
/// is row directed[d ^ 1].begin + directed[d].end - 1 - r of the way back.
///
/// A polygon with one half-portal (a dead end), or with two that lead to different neighbours,
/// belongs to exactly one chain, unless it is one of a ring of such polygons or of a component that
/// has no others; all others belong to none. A dead end is the last row of an even directed chain,
/// and the first row of the way back, where it is entered by no portal (kNoChain).
struct Chains {
  std::vector<std::uint32_t> enteredBy;  ///< per half-portal of a polygon in no chain: the directed
                                         ///< chain it leads into; else kNoChain
  std::vector<std::uint32_t> ofPolygon;  ///< per polygon: its chain, or kNoChain
  std::vector<std::uint32_t> rowOf;      ///< per polygon: its row in the even directed chain, or
                                         ///< kNoChain
  std::vector<DirectedChain> directed;
  std::vector<ChainRow> rows;

  std::uint32_t chainCount() const { return static_cast<std::uint32_t>(directed.size() / 2); }

  bool operator==(const Chains&) const = default;
};

/// Finds the chains of a graph whose search rows are filled. O(half-portals); chains in order of
/// the first half-portal that leads into them.
Chains findChains(const NavGraph& graph);

/// The same where polygons are closed or cost more (PolygonStates, whose two arrays these are):
/// what is closed counts as if it were not there, and what costs more than 1 belongs to no chain,
/// nor does what is `apart` (per polygon; empty: none).
Chains findChains(const NavGraph& graph, std::span<const float> cost,
                  std::span<const std::uint32_t> openNeighbours, std::span<const char> apart = {});

}  // namespace forewalk::navmesh
