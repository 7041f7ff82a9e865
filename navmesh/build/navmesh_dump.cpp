#include "navmesh/build/navmesh_dump.h"

#include <fmt/format.h>

#include <cassert>
#include <iterator>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

// fmt writes a float with the fewest digits that read back as the same float. A JSON library would
// widen it to double first, and 0.1f would become 0.10000000149011612.
class JsonText {
 public:
  template <typename... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), text, std::forward<Args>(args)...);
  }
  void add(glm::vec3 point) { add("[{},{},{}]", point.x, point.y, point.z); }

  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

const char* nameOf(Partition partition) {
  switch (partition) {
    case Partition::kWatershed:
      return "watershed";
    case Partition::kMonotone:
      return "monotone";
    case Partition::kLayers:
      return "layers";
  }
  return "unknown";
}

void addSettings(const BuildSettings& s, JsonText& out) {
  out.add(R"({{"radius":{},"height":{},"climb":{},"slope":{},)", s.radius, s.height, s.climb,
          s.slope);
  out.add(R"("cell":{},"cell_height":{},"region_min":{},"region_merge":{},)", s.cell, s.cellHeight,
          s.regionMin, s.regionMerge);
  out.add(R"("edge_max":{},"edge_error":{},"detail_sample":{},"detail_error":{},)", s.edgeMax,
          s.edgeError, s.detailSample, s.detailError);
  out.add(R"("corners_max":{},"partition":"{}","tile":{}}})", s.cornersMax, nameOf(s.partition),
          s.tile);
}

void addPortals(const NavGraph& graph, std::uint32_t polygon, JsonText& out) {
  const std::uint32_t begin = graph.portalStart[polygon];
  for (std::uint32_t h = begin; h < graph.portalStart[polygon + 1]; ++h) {
    const Portal& portal = graph.portals[h];
    const PortalHeights& heights = graph.portalHeights[h];
    out.add(R"({}{{"to":{},"left":)", h == begin ? "" : ",", index(graph.portalTo[h]));
    out.add(toSpace(portal.left, heights.left));
    out.add(R"(,"right":)");
    out.add(toSpace(portal.right, heights.right));
    out.add("}}");
  }
}

void addPolygon(const PolygonMesh& mesh, const NavGraph& graph, std::uint32_t polygon,
                JsonText& out) {
  out.add(R"({{"id":{},"vertices":[)", polygon);
  const std::uint32_t begin = mesh.ringStart[polygon];
  for (std::uint32_t c = begin; c < mesh.ringStart[polygon + 1]; ++c) {
    if (c != begin) out.add(",");
    out.add(mesh.vertices[mesh.ring[c]]);
  }
  out.add(R"(],"centroid":)");
  out.add(toSpace(graph.centroid[polygon], graph.centroidHeight[polygon]));
  out.add(R"(,"component":{},"portals":[)", graph.component[polygon]);
  addPortals(graph, polygon, out);
  out.add("]}}");
}

void addLinks(const Links& links, JsonText& out) {
  if (links.empty()) return;
  out.add(",\n\"links\":[");
  for (const LinkWay& way : links.ways) {
    out.add(R"({}{{"id":{},"from":{},"to":{},"entry":)", &way == links.ways.data() ? "\n" : ",\n",
            index(way.link), index(way.from), index(way.to));
    out.add(toSpace(way.entry, way.entryHeight));
    out.add(R"(,"exit":)");
    out.add(toSpace(way.exit, way.exitHeight));
    out.add(R"(,"length":{},"back":{}}})", way.length, way.back);
  }
  out.add("\n]");
}

}  // namespace

std::string dumpNavMesh(const PolygonMesh& mesh, const NavGraph& graph,
                        const BuildSettings& settings, const Links& links) {
  assert(mesh.polygonCount() == graph.polygonCount());
  JsonText out;
  out.add(R"({{"format":"forewalk.navmesh/1",{})", "\n");
  out.add(R"("settings":)");
  addSettings(settings, out);
  out.add(",\n\"polygons\":[");
  // A polygon a line: such a file can be searched and compared without a JSON tool.
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    out.add("{}", p == 0 ? "\n" : ",\n");
    addPolygon(mesh, graph, p, out);
  }
  out.add("\n]");
  addLinks(links, out);
  out.add("}}\n");
  return out.take();
}

}  // namespace forewalk::navmesh
