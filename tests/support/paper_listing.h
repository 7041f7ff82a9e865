// The paper's listing, word for word: the reference that predict() must agree with, and the price
// of taking it literally.
//
// Azmandian et al. 2016, Algorithm 1, with the mends of DESIGN.md section 3 and nothing else:
// arrays over the whole navgraph, and a taut path from S pulled anew for every settled node.
#pragma once

#include <cstdint>
#include <vector>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::testing {

/// How long an edge between two polygons is taken to be (the paper does not say).
enum class EdgeLength {
  kPortalMidpoints,    ///< as predict() does it
  kPortalMidpoints3d,  ///< the same with heights, as Detour does it
  kCentroids,
};

struct ListingNode {
  std::uint32_t polygon;
  std::uint32_t prev;    ///< polygon
  std::uint32_t prevPG;  ///< polygon
  std::uint32_t entry;   ///< half-portal it was entered by; of S: 0xffffffff
  float dist;            ///< Dijkstra's, metres
  float taut;            ///< of the taut path from S, metres
  bool within;
};

struct Listing {
  std::vector<ListingNode> settled;           ///< in settling order, S first
  std::vector<std::uint32_t> branches;        ///< B, ascending
  std::vector<std::uint32_t> terminals;       ///< T, ascending
  std::vector<std::vector<glm::vec2>> paths;  ///< of E: from each of B + T to its prevPG
};

Listing paperListing(const navmesh::NavGraph& graph, const navmesh::Location& source, float horizon,
                     EdgeLength length = EdgeLength::kPortalMidpoints);

}  // namespace forewalk::testing
