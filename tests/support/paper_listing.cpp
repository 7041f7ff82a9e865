#include "tests/support/paper_listing.h"

#include <limits>
#include <set>

#include "navmesh/funnel.h"

namespace forewalk::testing {

using navmesh::index;
using navmesh::NavGraph;

namespace {

constexpr std::uint32_t kUndefined = 0xffffffffu;

struct State {
  const NavGraph& graph;
  std::vector<float> dist;
  std::vector<std::uint32_t> prev, prevPG, entry;

  explicit State(const NavGraph& g)
      : graph(g),
        dist(g.polygonCount(), std::numeric_limits<float>::infinity()),
        prev(g.polygonCount(), kUndefined),
        prevPG(g.polygonCount(), kUndefined),
        entry(g.polygonCount(), kUndefined) {}

  /// The portals walked from polygon `from`, an ancestor, to polygon `to`.
  std::vector<navmesh::Portal> corridor(std::uint32_t from, std::uint32_t to) const {
    std::vector<navmesh::Portal> portals;
    for (std::uint32_t at = to; at != from; at = prev[at])
      portals.push_back(graph.portals[entry[at]]);
    return {portals.rbegin(), portals.rend()};
  }
};

}  // namespace

Listing paperListing(const NavGraph& graph, const navmesh::Location& source, float horizon,
                     EdgeLength length) {
  State state(graph);
  std::set<std::uint32_t> branches, terminals;
  Listing result;
  const std::uint32_t s = index(source.polygon);

  const auto place = [&](std::uint32_t polygon) {
    return polygon == s ? source.plan : graph.centroid[polygon];
  };
  const auto edgeLength = [&](std::uint32_t u, std::uint32_t portal) {
    if (length == EdgeLength::kCentroids) {
      return glm::distance(place(u), graph.centroid[index(graph.portalTo[portal])]);
    }
    const bool flat = length == EdgeLength::kPortalMidpoints;
    const auto middle = [&](std::uint32_t at) {
      const navmesh::PortalHeights heights = graph.portalHeights[at];
      return glm::vec3(graph.portalMidpoint[at],
                       flat ? 0.0f : 0.5f * (heights.left + heights.right));
    };
    if (u == s) {
      return glm::distance(glm::vec3(source.plan, flat ? 0.0f : source.height), middle(portal));
    }
    if (!flat) return glm::distance(middle(state.entry[u]), middle(portal));
    return glm::distance(graph.portalMidpoint[state.entry[u]], graph.portalMidpoint[portal]);
  };

  // "Q <- all vertices", and the nearest is taken out until none is left that can be reached.
  std::set<std::pair<float, std::uint32_t>> queue;
  state.dist[s] = 0.0f;
  for (std::uint32_t v = 0; v < graph.polygonCount(); ++v) queue.insert({state.dist[v], v});
  while (!queue.empty() && queue.begin()->first < std::numeric_limits<float>::infinity()) {
    const auto [key, u] = *queue.begin();
    queue.erase(queue.begin());

    std::vector<glm::vec2> taut;
    navmesh::pullString(source.plan, place(u), state.corridor(s, u), taut);
    const float tautLength = navmesh::lengthOf(taut);
    const bool within = tautLength <= horizon;
    if (u != s) {
      const std::uint32_t before = state.prev[u];
      state.prevPG[u] = before == s || branches.count(before) > 0 ? before : state.prevPG[before];
    }
    result.settled.push_back(
        {u, state.prev[u], state.prevPG[u], state.entry[u], key, tautLength, within});
    if (!within) continue;
    if (u != s) {
      if (graph.neighbourCount[u] > 2) branches.insert(u);
      terminals.erase(state.prev[u]);
      terminals.insert(u);
    }
    for (std::uint32_t p = graph.portalStart[u]; p < graph.portalStart[u + 1]; ++p) {
      const std::uint32_t v = index(graph.portalTo[p]);
      const float alternative = state.dist[u] + edgeLength(u, p);
      if (alternative < state.dist[v]) {
        queue.erase({state.dist[v], v});
        queue.insert({alternative, v});
        state.dist[v] = alternative;
        state.prev[v] = u;
        state.entry[v] = p;
      }
    }
  }

  std::set<std::uint32_t> vertices = branches;
  vertices.insert(terminals.begin(), terminals.end());
  for (const std::uint32_t v : vertices) {
    const std::uint32_t to = state.prevPG[v];
    navmesh::pullString(place(to), place(v), state.corridor(to, v), result.paths.emplace_back());
  }
  result.branches.assign(branches.begin(), branches.end());
  result.terminals.assign(terminals.begin(), terminals.end());
  return result;
}

}  // namespace forewalk::testing
