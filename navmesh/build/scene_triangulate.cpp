#include "navmesh/build/scene_triangulate.h"

#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

bool inTriangle(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

/// The ring seen along its normal (Newell's, which any planar or nearly planar ring has), counter-
/// clockwise. Empty where the ring has no area.
std::vector<glm::dvec2> flattened(std::span<const std::uint32_t> ring,
                                  const std::vector<glm::vec3>& vertices) {
  const glm::dvec3 origin(vertices[ring[0]]);
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    normal += glm::cross(glm::dvec3(vertices[ring[i]]) - origin,
                         glm::dvec3(vertices[ring[(i + 1) % ring.size()]]) - origin);
  }
  // Dropping the normal's largest coordinate keeps the ring's shape up to a stretch, and stays
  // finite.
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (!(size[drop] > 0.0) || !std::isfinite(size[drop])) return {};
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  std::vector<glm::dvec2> flat;
  flat.reserve(ring.size());
  for (const std::uint32_t corner : ring) {
    const glm::dvec3 p = glm::dvec3(vertices[corner]) - origin;
    flat.push_back(normal[drop] > 0.0 ? glm::dvec2(p[u], p[v]) : glm::dvec2(p[v], p[u]));
  }
  return flat;
}

/// A ring on its plane, and which of its corners no ear has taken yet.
class Ears {
 public:
  explicit Ears(std::span<const glm::dvec2> flat) : flat_(flat), left_(flat.size()) {
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = i;
  }

  const std::vector<std::size_t>& left() const { return left_; }
  std::size_t before(std::size_t at) const { return left_[(at + left_.size() - 1) % left_.size()]; }
  std::size_t after(std::size_t at) const { return left_[(at + 1) % left_.size()]; }
  void cut(std::size_t at) { left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at)); }

  bool isConvex() const {
    for (std::size_t at = 0; at < left_.size(); ++at) {
      if (turn(at) < 0.0) return false;
    }
    return true;
  }

  bool isEar(std::size_t at) const {
    if (turn(at) <= 0.0) return false;
    const glm::dvec2 a = flat_[before(at)];
    const glm::dvec2 b = flat_[left_[at]];
    const glm::dvec2 c = flat_[after(at)];
    for (std::size_t other = 2; other < left_.size() - 1; ++other) {
      const glm::dvec2 p = flat_[left_[(at + other) % left_.size()]];
      // Keyhole rings pass a corner twice: that one does not block its own ear.
      if (p != a && p != b && p != c && inTriangle(p, a, b, c)) return false;
    }
    return true;
  }

 private:
  double turn(std::size_t at) const {
    const glm::dvec2 here = flat_[left_[at]];
    return cross(here - flat_[before(at)], flat_[after(at)] - here);
  }

  std::span<const glm::dvec2> flat_;
  std::vector<std::size_t> left_;
};

void appendFan(std::span<const std::uint32_t> ring, std::vector<glm::uvec3>& triangles) {
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    triangles.emplace_back(ring[0], ring[i], ring[i + 1]);
  }
}

}  // namespace

void triangulate(std::span<const std::uint32_t> ring, const std::vector<glm::vec3>& vertices,
                 std::vector<glm::uvec3>& triangles) {
  if (ring.size() == 3) return appendFan(ring, triangles);
  const std::vector<glm::dvec2> flat = flattened(ring, vertices);
  Ears ears(flat);
  if (flat.empty() || ears.isConvex()) return appendFan(ring, triangles);
  std::size_t at = 0;
  std::size_t refused = 0;
  while (ears.left().size() > 3 && refused < ears.left().size()) {
    at %= ears.left().size();
    if (ears.isEar(at)) {
      triangles.emplace_back(ring[ears.before(at)], ring[ears.left()[at]], ring[ears.after(at)]);
      ears.cut(at);
      refused = 0;
    } else {
      ++at;
      ++refused;
    }
  }
  std::vector<std::uint32_t> rest;
  for (const std::size_t corner : ears.left()) rest.push_back(ring[corner]);
  appendFan(rest, triangles);
}

}  // namespace forewalk::navmesh
