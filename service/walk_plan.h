// A walk drawn twice: the way through the virtual building, and the same walk in the room.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "navmesh/nav_graph.h"
#include "rdw/trace.h"
#include "rdw/tracked_space.h"

namespace forewalk::service {

/// SVG of the navmesh with the virtual path, coloured from start to end, and a red dot at every
/// reset. O(polygons + frames).
std::string virtualPlan(const navmesh::NavGraph& graph, std::span<const rdw::FrameRecord> frames,
                        std::string_view title, std::string_view subtitle);

/// SVG of the tracked space with the physical path, coloured alike, and a red dot at every reset.
std::string physicalPlan(const rdw::TrackedSpace& space, std::span<const rdw::FrameRecord> frames,
                         std::string_view title, std::string_view subtitle);

}  // namespace forewalk::service
