// The navmesh as JSON, for people, pages and scripts: `forewalk build SCENE --dump FILE.json`.
#pragma once

#include <string>

#include "navmesh/build/settings.h"
#include "navmesh/links.h"
#include "navmesh/nav_graph.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// JSON of format `forewalk.navmesh/1`: settings, then each polygon with its id, vertices
/// (counter-clockwise from above), centroid, component, and portals in the graph's order, left and
/// right as one walks out. World space, metres, y up; slope in radians. Every number reads back as
/// the same float. The same navmesh gives the same text.
///
/// With links, a list of their ways follows the polygons: id, from and to (polygons), entry, exit,
/// length, and whether it is the way back.
///
/// `graph` must have been made from `mesh`, as must `links`. O(size of the text).
std::string dumpNavMesh(const PolygonMesh& mesh, const NavGraph& graph,
                        const BuildSettings& settings, const Links& links = {});

}  // namespace forewalk::navmesh
