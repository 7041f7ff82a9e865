// Small scenes put together from floors, boxes, ramps and stairs.
#pragma once

#include <cstdint>
#include <string>

#include "navmesh/build/scene.h"

namespace forewalk::testing {

/// An area on the ground, world x and z, metres.
struct Footprint {
  float x0, z0, x1, z1;
};

class BlockScene {
 public:
  explicit BlockScene(std::string name = "blocks") { scene_.name = std::move(name); }

  /// Level ground at `y`.
  BlockScene& floor(Footprint f, float y = 0.0f) {
    return quad({f.x0, y, f.z0}, {f.x0, y, f.z1}, {f.x1, y, f.z1}, {f.x1, y, f.z0});
  }

  /// A solid from `y0` to `y1`, its faces outward.
  BlockScene& box(Footprint f, float y0, float y1) {
    floor(f, y1);
    quad({f.x0, y0, f.z0}, {f.x1, y0, f.z0}, {f.x1, y0, f.z1}, {f.x0, y0, f.z1});
    quad({f.x0, y0, f.z1}, {f.x1, y0, f.z1}, {f.x1, y1, f.z1}, {f.x0, y1, f.z1});
    quad({f.x1, y0, f.z0}, {f.x0, y0, f.z0}, {f.x0, y1, f.z0}, {f.x1, y1, f.z0});
    quad({f.x1, y0, f.z1}, {f.x1, y0, f.z0}, {f.x1, y1, f.z0}, {f.x1, y1, f.z1});
    return quad({f.x0, y0, f.z0}, {f.x0, y0, f.z1}, {f.x0, y1, f.z1}, {f.x0, y1, f.z0});
  }

  /// Ground that rises along x from `y0` at x0 to `y1` at x1.
  BlockScene& ramp(Footprint f, float y0, float y1) {
    return quad({f.x0, y0, f.z0}, {f.x0, y0, f.z1}, {f.x1, y1, f.z1}, {f.x1, y1, f.z0});
  }

  /// Solid steps that rise along x from `y0` to `y1`, the last one level with `y1`.
  BlockScene& stairs(Footprint f, float y0, float y1, int steps) {
    const float tread = (f.x1 - f.x0) / static_cast<float>(steps);
    const float rise = (y1 - y0) / static_cast<float>(steps);
    for (int i = 0; i < steps; ++i) {
      const float x = f.x0 + static_cast<float>(i) * tread;
      box({x, f.z0, x + tread, f.z1}, y0, y0 + static_cast<float>(i + 1) * rise);
    }
    return *this;
  }

  navmesh::Scene scene() const { return scene_; }

 private:
  BlockScene& quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (const glm::vec3 corner : {a, b, c, d}) scene_.vertices.push_back(corner);
    scene_.triangles.push_back({first, first + 1, first + 2});
    scene_.triangles.push_back({first, first + 2, first + 3});
    return *this;
  }

  navmesh::Scene scene_;
};

/// Two rooms of 6 m x 4 m beside each other along x, a wall of 0.2 m between them with a door
/// `door` metres wide in its middle; walls 2.5 m high.
inline navmesh::Scene twoRooms(float door) {
  return BlockScene("two rooms")
      .floor({0.0f, 0.0f, 12.2f, 4.0f})
      .box({6.0f, 0.0f, 6.2f, 2.0f - 0.5f * door}, 0.0f, 2.5f)
      .box({6.0f, 2.0f + 0.5f * door, 6.2f, 4.0f}, 0.0f, 2.5f)
      .scene();
}

/// A ground floor of 14 m x 10 m, over its far half (x >= 7) an upper floor at 3 m, and stairs of
/// 12 steps up to it along z 4 to 6, from x = 1 to x = 7.
inline navmesh::Scene twoStoreys() {
  return BlockScene("two storeys")
      .floor({0.0f, 0.0f, 14.0f, 10.0f})
      .box({7.0f, 0.0f, 14.0f, 10.0f}, 2.8f, 3.0f)
      .stairs({1.0f, 4.0f, 7.0f, 6.0f}, 0.0f, 3.0f, 12)
      .scene();
}

/// Three floors of 6 m x 6 m that touch nowhere, 2 m apart, the third one 1 m higher, and a
/// platform of 1.2 m x 1.2 m that is too small to count.
inline navmesh::Scene islands() {
  return BlockScene("islands")
      .floor({0.0f, 0.0f, 6.0f, 6.0f})
      .floor({8.0f, 0.0f, 14.0f, 6.0f})
      .floor({16.0f, 0.0f, 22.0f, 6.0f}, 1.0f)
      .floor({0.0f, 8.0f, 1.2f, 9.2f})
      .scene();
}

}  // namespace forewalk::testing
