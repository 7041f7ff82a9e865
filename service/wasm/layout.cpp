// Where the C interface's structs have their fields in WebAssembly, for index.js: nothing is
// repeated by hand there.
#include <cstddef>

#include "service/capi/forewalk.h"

namespace {

// offsetof is no literal that the preprocessor could join, so the text is made when it is asked
// for.
class Text {
 public:
  void field(const char* type, const char* name, std::size_t offset) {
    add(length_ == 0 ? "{\"" : ",\"");
    add(type);
    add(".");
    add(name);
    add("\":");
    number(offset);
  }
  const char* end() {
    add("}");
    text_[length_] = '\0';
    return text_;
  }

 private:
  void add(const char* part) {
    while (*part != '\0' && length_ + 2 < sizeof text_) text_[length_++] = *part++;
  }
  void number(std::size_t value) {
    if (value >= 10) number(value / 10);
    const char digit[] = {static_cast<char>('0' + value % 10), '\0'};
    add(digit);
  }

  char text_[8192];
  std::size_t length_ = 0;
};

}  // namespace

#define FIELD(type, name) text.field(#type, #name, offsetof(forewalk_##type, name))
#define WHOLE(type) text.field(#type, "size", sizeof(forewalk_##type))

/// A JSON object: "struct.field" to bytes, "struct.size" to its size.
extern "C" const char* forewalk_wasm_layout() {
  static Text text;
  static const char* made = [] {
    WHOLE(session_settings);
    FIELD(session_settings, axes);
    FIELD(session_settings, controller);
    FIELD(session_settings, limits);
    FIELD(session_settings, horizon);
    FIELD(session_settings, border);
    FIELD(session_settings, border_count);
    FIELD(session_settings, width);
    FIELD(session_settings, depth);
    FIELD(session_settings, hole_points);
    FIELD(session_settings, hole_sizes);
    FIELD(session_settings, hole_count);
    FIELD(session_settings, has_start);
    FIELD(session_settings, start_floor);
    FIELD(session_settings, start_heading);
    FIELD(session_settings, translation_min);
    FIELD(session_settings, translation_max);
    FIELD(session_settings, rotation_min);
    FIELD(session_settings, rotation_max);
    FIELD(session_settings, curvature_max);
    FIELD(session_settings, bending_min);
    FIELD(session_settings, bending_max);
    FIELD(session_settings, polygon_limit);
    FIELD(session_settings, resets);
    FIELD(session_settings, always_predict);
    FIELD(session_settings, method);
    FIELD(session_settings, persistence);
    FIELD(session_settings, reset);
    FIELD(session_settings, likelihoods);
    FIELD(session_settings, heading_source);
    FIELD(session_settings, space);
    WHOLE(space_settings);
    FIELD(space_settings, axes);
    FIELD(space_settings, border);
    FIELD(space_settings, border_count);
    FIELD(space_settings, width);
    FIELD(space_settings, depth);
    FIELD(space_settings, hole_points);
    FIELD(space_settings, hole_sizes);
    FIELD(space_settings, hole_count);
    FIELD(space_settings, body_radius);
    FIELD(space_settings, user_limit);
    WHOLE(frame_out);
    FIELD(frame_out, flags);
    FIELD(frame_out, virtual_pose);
    FIELD(frame_out, translation);
    FIELD(frame_out, rotation);
    FIELD(frame_out, curvature);
    FIELD(frame_out, bending);
    FIELD(frame_out, injected_yaw);
    FIELD(frame_out, injected_translation);
    FIELD(frame_out, resetting);
    FIELD(frame_out, instruction);
    FIELD(frame_out, reset_remaining);
    FIELD(frame_out, reset_turned);
    FIELD(frame_out, reset_count);
    FIELD(frame_out, graph_nodes);
    FIELD(frame_out, reset_phase);
    FIELD(frame_out, reset_back);
    FIELD(frame_out, reset_direction);
    WHOLE(graph_view);
    FIELD(graph_view, node_count);
    FIELD(graph_view, nodes);
    FIELD(graph_view, edge_count);
    FIELD(graph_view, point_count);
    FIELD(graph_view, edges);
    FIELD(graph_view, points);
    FIELD(graph_view, horizon);
    FIELD(graph_view, complete_to);
    FIELD(graph_view, fronts);
    FIELD(graph_view, widths);
    FIELD(graph_view, front_count);
    FIELD(graph_view, ways);
    FIELD(graph_view, way_count);
    FIELD(graph_view, likelihood_none);
    WHOLE(navmesh_view);
    FIELD(navmesh_view, polygon_count);
    FIELD(navmesh_view, corner_start);
    FIELD(navmesh_view, corners);
    FIELD(navmesh_view, portal_start);
    FIELD(navmesh_view, portals);
    FIELD(navmesh_view, triangle_start);
    FIELD(navmesh_view, triangles);
    WHOLE(portal);
    FIELD(portal, to);
    FIELD(portal, edge);
    FIELD(portal, left);
    FIELD(portal, right);
    WHOLE(node);
    FIELD(node, position);
    FIELD(node, distance);
    FIELD(node, prev);
    FIELD(node, polygon);
    FIELD(node, kind);
    FIELD(node, reason);
    FIELD(node, branch);
    WHOLE(edge);
    FIELD(edge, from);
    FIELD(edge, to);
    FIELD(edge, length);
    FIELD(edge, path_start);
    FIELD(edge, path_count);
    FIELD(edge, loop);
    WHOLE(front);
    FIELD(front, node);
    FIELD(front, length);
    FIELD(front, from);
    FIELD(front, to);
    WHOLE(way);
    FIELD(way, id);
    FIELD(way, node);
    FIELD(way, likelihood);
    FIELD(way, born);
    WHOLE(link);
    FIELD(link, id);
    FIELD(link, entry);
    FIELD(link, exit);
    FIELD(link, length);
    FIELD(link, both_ways);
    FIELD(link, closed);
    WHOLE(standing);
    FIELD(standing, foot);
    FIELD(standing, radius);
    FIELD(standing, cost);
    return text.end();
  }();
  return made;
}
