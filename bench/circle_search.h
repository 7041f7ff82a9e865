// Detour's findPolysAroundCircle, rule for rule, on our navgraph: the same search on other data.
//
// Only for bench/prediction_peer, to say what the flat navgraph alone is worth. The rules are
// Detour 1.5's: a portal is passed if it comes within `radius` of the start on the plan, nodes sit
// at the midpoint of the portal they are first seen through and stay there, lengths count heights.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "navmesh/key_queue.h"
#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::bench {

class CircleSearch {
 public:
  explicit CircleSearch(const navmesh::NavGraph& graph);

  struct Visit {
    std::uint32_t polygon;
    std::uint32_t parent;  ///< polygon; of the start: 0xffffffff
    float cost;
  };

  /// In settling order. Lives until the next call.
  const std::vector<Visit>& run(const navmesh::Location& start, float radius);

 private:
  struct Reach {
    float cost = std::numeric_limits<float>::infinity();
    std::uint32_t seenThrough = 0xffffffffu;  // half-portal
    std::uint32_t parent = 0xffffffffu;
    bool closed = false;
  };

  const navmesh::NavGraph* graph_;
  std::vector<glm::vec3> midpoint_;     // per half-portal, plan and height
  std::vector<float> successorLength_;  // as NavGraph's, with heights
  std::vector<Reach> reach_;
  navmesh::KeyQueue queue_;
  std::vector<Visit> visits_;
};

}  // namespace forewalk::bench
