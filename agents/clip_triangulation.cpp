#include "agents/clip_triangulation.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace forewalk::agents {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;

}  // namespace

tl::expected<LocomotionDatabase, Error> triangulateClips(std::vector<MotionClip> clips) {
  const bool sound =
      !clips.empty() && std::all_of(clips.begin(), clips.end(), [](const MotionClip& clip) {
        return std::isfinite(clip.motion.linear) && std::isfinite(clip.motion.angular);
      });
  // What is not sound is refused below, as are chains made.
  if (!sound || chainOf(clips)) return LocomotionDatabase::make(std::move(clips), {});
  Delaunay delaunay;
  for (std::uint32_t c = 0; c < clips.size(); ++c) {  // in turn: range insertion shuffles
    const std::size_t before = delaunay.number_of_vertices();
    const auto vertex = delaunay.insert({static_cast<double>(clips[c].motion.linear),
                                         static_cast<double>(clips[c].motion.angular)});
    if (delaunay.number_of_vertices() > before) vertex->info() = c;
  }
  std::vector<ClipTriangle> triangles;
  for (const auto& face : delaunay.finite_face_handles()) {
    ClipTriangle triangle{face->vertex(0)->info(), face->vertex(1)->info(),
                          face->vertex(2)->info()};
    // The order of faces is the library's affair; ours begins with the smallest corner.
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
    triangles.push_back(triangle);
  }
  std::sort(triangles.begin(), triangles.end());
  return LocomotionDatabase::make(std::move(clips), std::move(triangles));
}

}  // namespace forewalk::agents
