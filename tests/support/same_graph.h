// Whether two navgraphs are the same to the last bit, and where they first differ.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "navmesh/world.h"

namespace forewalk::testing {

/// The names of the arrays that differ in size or bytes, empty where none does. Floats are compared
/// as bytes.
inline std::string differences(const navmesh::NavGraph& a, const navmesh::NavGraph& b) {
  std::string names;
  const auto compare = [&](const char* name, const auto& x, const auto& y) {
    static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(x[0])>>);
    const bool same = x.size() == y.size() &&
                      (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
    if (!same) names += std::string(names.empty() ? "" : ", ") + name;
  };
  compare("portalStart", a.portalStart, b.portalStart);
  compare("portalTo", a.portalTo, b.portalTo);
  compare("successorStart", a.successorStart, b.successorStart);
  compare("successorLength", a.successorLength, b.successorLength);
  compare("portalToCentroid", a.portalToCentroid, b.portalToCentroid);
  compare("portalMidpoint", a.portalMidpoint, b.portalMidpoint);
  compare("portals", a.portals, b.portals);
  compare("centroid", a.centroid, b.centroid);
  compare("neighbourCount", a.neighbourCount, b.neighbourCount);
  compare("ringStart", a.ringStart, b.ringStart);
  compare("ring", a.ring, b.ring);
  compare("ringHeight", a.ringHeight, b.ringHeight);
  compare("portalTwin", a.portalTwin, b.portalTwin);
  compare("portalEdge", a.portalEdge, b.portalEdge);
  compare("portalHeights", a.portalHeights, b.portalHeights);
  compare("centroidHeight", a.centroidHeight, b.centroidHeight);
  compare("component", a.component, b.component);
  compare("heightStart", a.heightStart, b.heightStart);
  compare("heightTriangles", a.heightTriangles, b.heightTriangles);
  compare("chains.enteredBy", a.chains.enteredBy, b.chains.enteredBy);
  compare("chains.ofPolygon", a.chains.ofPolygon, b.chains.ofPolygon);
  compare("chains.rowOf", a.chains.rowOf, b.chains.rowOf);
  compare("chains.directed", a.chains.directed, b.chains.directed);
  compare("chains.rows", a.chains.rows, b.chains.rows);
  if (a.componentCount != b.componentCount) names += " componentCount";
  return names;
}

/// The same, with the location index.
inline std::string differences(const navmesh::World& a, const navmesh::World& b) {
  std::string names = differences(a.graph, b.graph);
  const navmesh::LocationIndex &x = a.locations, &y = b.locations;
  if (x.origin != y.origin || x.cellSize != y.cellSize || x.columns != y.columns ||
      x.rows != y.rows || x.cellStart != y.cellStart || x.polygons != y.polygons) {
    names += " locations";
  }
  return names;
}

}  // namespace forewalk::testing
