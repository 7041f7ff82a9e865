#include "navmesh/chains.h"

#include <algorithm>
#include <utility>

#include "navmesh/nav_graph.h"
#include "navmesh/polygon_states.h"

namespace forewalk::navmesh {
namespace {

class ChainFinder {
 public:
  /// An empty `cost` is 1 everywhere.
  ChainFinder(const NavGraph& graph, std::span<const float> cost,
              std::span<const std::uint32_t> openNeighbours, std::span<const char> apart)
      : graph_(graph), cost_(cost), neighbourCount_(openNeighbours), apart_(apart) {}

  Chains find() {
    chains_.enteredBy.assign(graph_.portalCount(), kNoChain);
    chains_.rowOf.assign(graph_.polygonCount(), kNoChain);
    chains_.ofPolygon.assign(graph_.polygonCount(), kNoChain);
    for (std::uint32_t p = 0; p < graph_.polygonCount(); ++p) {
      if (isClosed(p) || belongs(p)) continue;
      for (std::uint32_t h = graph_.portalStart[p]; h < graph_.portalStart[p + 1]; ++h) {
        if (chains_.enteredBy[h] == kNoChain && isOpen(h)) walkFrom(h);
      }
    }
    return std::move(chains_);
  }

 private:
  bool isClosed(std::uint32_t polygon) const { return !cost_.empty() && cost_[polygon] == kClosed; }
  bool isOpen(std::uint32_t portal) const { return !isClosed(index(graph_.portalTo[portal])); }

  std::uint32_t waysOf(std::uint32_t polygon) const {
    const std::uint32_t begin = graph_.portalStart[polygon], end = graph_.portalStart[polygon + 1];
    if (cost_.empty()) return end - begin;
    std::uint32_t open = 0;
    for (std::uint32_t portal = begin; portal < end; ++portal) open += isOpen(portal) ? 1 : 0;
    return open;
  }
  bool passesThrough(std::uint32_t polygon) const {
    return waysOf(polygon) == 2 && neighbourCount_[polygon] == 2;
  }
  bool belongs(std::uint32_t polygon) const {
    if (!cost_.empty() && cost_[polygon] != 1.0f) return false;
    if (!apart_.empty() && apart_[polygon] != 0) return false;
    return waysOf(polygon) == 1 || passesThrough(polygon);
  }

  /// The chain that half-portal `first` leads into, if there is one, both ways.
  void walkFrom(std::uint32_t first) {
    walk_.clear();
    std::uint32_t exit = first;
    for (;;) {
      const std::uint32_t polygon = index(graph_.portalTo[exit]);
      if (!belongs(polygon)) break;
      chains_.ofPolygon[polygon] = chains_.chainCount();
      chains_.rowOf[polygon] = static_cast<std::uint32_t>(chains_.rows.size() + walk_.size());
      walk_.push_back(exit);
      if (waysOf(polygon) == 1) {
        deadEnd_ = PolygonId{polygon};
        exit = kNoChain;
        break;
      }
      const std::uint32_t back = graph_.portalTwin[exit];
      exit = graph_.portalStart[polygon];
      while (exit == back || !isOpen(exit)) ++exit;
    }
    if (walk_.empty()) return;
    chains_.enteredBy[first] = 2 * chains_.chainCount();
    addDirected(exit);
    // The way back enters its first polygon by the exit, and is left by the twin of `first`.
    std::uint32_t entrance = kNoChain;
    if (exit != kNoChain) {
      entrance = graph_.portalTwin[exit];
      chains_.enteredBy[entrance] = 2 * chains_.chainCount() + 1;
    }
    std::reverse(walk_.begin(), walk_.end());
    for (std::uint32_t& portal : walk_) {
      entrance = graph_.portalTwin[std::exchange(portal, entrance)];
    }
    addDirected(entrance);
  }

  void addDirected(std::uint32_t exit) {
    DirectedChain way{};
    way.begin = static_cast<std::uint32_t>(chains_.rows.size());
    way.exit = exit;
    way.exitTo = exit == kNoChain ? kNoPolygon : graph_.portalTo[exit];
    float length = 0.0f;
    std::uint32_t before = kNoChain;
    for (const std::uint32_t portal : walk_) {
      if (before != kNoChain) length += step(before, portal);
      if (portal != kNoChain) {
        way.farthest = std::max(way.farthest, length + graph_.portalToCentroid[portal]);
      }
      chains_.rows.push_back({portal, polygonBehind(portal), length});
      before = portal;
    }
    if (exit != kNoChain && before != kNoChain) length += step(before, exit);
    way.exitLength = length;
    way.end = static_cast<std::uint32_t>(chains_.rows.size());
    chains_.directed.push_back(way);
  }

  /// Where a half-portal leads; without one, the dead end that the way back starts from.
  PolygonId polygonBehind(std::uint32_t portal) const {
    return portal == kNoChain ? deadEnd_ : graph_.portalTo[portal];
  }

  /// From the midpoint of a half-portal to that of one of the polygon it leads to.
  float step(std::uint32_t from, std::uint32_t to) const {
    const std::uint32_t begin = graph_.portalStart[index(graph_.portalTo[from])];
    return graph_.successorLength[graph_.successorStart[from] + to - begin];
  }

  const NavGraph& graph_;
  std::span<const float> cost_;
  std::span<const std::uint32_t> neighbourCount_;
  std::span<const char> apart_;
  Chains chains_;
  PolygonId deadEnd_ = kNoPolygon;   // of the latest chain that has one
  std::vector<std::uint32_t> walk_;  // half-portals into the polygons of the chain at hand
};

}  // namespace

Chains findChains(const NavGraph& graph) {
  return ChainFinder(graph, {}, graph.neighbourCount, {}).find();
}

Chains findChains(const NavGraph& graph, std::span<const float> cost,
                  std::span<const std::uint32_t> openNeighbours, std::span<const char> apart) {
  return ChainFinder(graph, cost, openNeighbours, apart).find();
}

}  // namespace forewalk::navmesh
