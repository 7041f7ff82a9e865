#include "navmesh/standing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

/// A part of a polygon's border; places are counted in edges from its first corner.
struct Stretch {
  float begin, end;
};

/// What the disc covers of a segment, as shares of it; empty (begin >= end) where it is apart.
Stretch covered(glm::vec2 from, glm::vec2 to, glm::vec2 centre, float radius) {
  const glm::vec2 edge = to - from, off = from - centre;
  const float a = glm::dot(edge, edge), b = glm::dot(off, edge);
  const float c = glm::dot(off, off) - radius * radius;
  if (!(a > 0.0f)) return {0.0f, c < 0.0f ? 1.0f : 0.0f};
  const float root = b * b - a * c;
  if (!(root > 0.0f)) return {0.0f, 0.0f};
  const float half = std::sqrt(root);
  return {std::max(0.0f, (-b - half) / a), std::min(1.0f, (-b + half) / a)};
}

/// The disc of one Standing against one polygon.
class Blocking {
 public:
  Blocking(const NavGraph& graph, PolygonId polygon, glm::vec2 centre, float radius)
      : graph_(graph),
        polygon_(polygon),
        ring_(graph.ringOf(polygon)),
        centre_(centre),
        radius_(radius) {}

  /// Whether no two portals are left on one piece of the border.
  bool blocks() const {
    const std::uint32_t begin = graph_.portalStart[index(polygon_)];
    const std::uint32_t end = graph_.portalStart[index(polygon_) + 1];
    if (end == begin || !touches()) return false;
    if (end - begin == 1) return isCovered(begin);  // a dead end: whether nobody comes in
    for (std::uint32_t one = begin; one < end; ++one) {
      for (std::uint32_t other = one + 1; other < end; ++other) {
        if (connects(one, other)) return false;
      }
    }
    return true;
  }

 private:
  bool touches() const {
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Stretch at = covered(ring_[i], ring_[(i + 1) % ring_.size()], centre_, radius_);
      if (at.begin < at.end) return true;
    }
    return false;
  }

  /// Whether some free end of one portal and of the other lie on one free piece of the border.
  bool connects(std::uint32_t one, std::uint32_t other) const {
    for (const glm::vec2 a : freeEnds(one)) {
      for (const glm::vec2 b : freeEnds(other)) {
        if (std::isnan(a.x) || std::isnan(b.x)) continue;
        if (isFree(one, a, other, b) || isFree(other, b, one, a)) return true;
      }
    }
    return false;
  }

  /// The portal's ends that the disc leaves free; not a number where it covers one.
  std::array<glm::vec2, 2> freeEnds(std::uint32_t portal) const {
    const auto unlessCovered = [&](glm::vec2 end) {
      constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
      return glm::distance(end, centre_) < radius_ ? glm::vec2(kNone) : end;
    };
    const Portal& ends = graph_.portals[portal];
    return {unlessCovered(ends.left), unlessCovered(ends.right)};
  }

  bool isCovered(std::uint32_t portal) const {
    const auto ends = freeEnds(portal);
    return std::isnan(ends[0].x) && std::isnan(ends[1].x);
  }

  bool isCovered(glm::vec2 from, glm::vec2 to) const {
    const Stretch at = covered(from, to, centre_, radius_);
    return at.begin < at.end;
  }

  /// Whether the border is free from point `a` on the edge of half-portal `one`, counter-clockwise,
  /// to point `b` on that of `other`.
  bool isFree(std::uint32_t one, glm::vec2 a, std::uint32_t other, glm::vec2 b) const {
    const auto corners = static_cast<std::uint32_t>(ring_.size());
    std::uint32_t edge = graph_.portalEdge[one];
    const std::uint32_t last = graph_.portalEdge[other];
    const glm::vec2 along = ring_[(edge + 1) % corners] - ring_[edge];
    if (edge == last && glm::dot(b - a, along) >= 0.0f) return !isCovered(a, b);
    glm::vec2 from = a;
    do {
      const glm::vec2 corner = ring_[(edge + 1) % corners];
      if (isCovered(from, corner)) return false;
      from = corner;
      edge = (edge + 1) % corners;
    } while (edge != last);
    return !isCovered(from, b);
  }

  const NavGraph& graph_;
  PolygonId polygon_;
  std::span<const glm::vec2> ring_;
  glm::vec2 centre_;
  float radius_;
};

}  // namespace

tl::expected<void, Error> validate(const Standing& standing) {
  const auto wrong = [](ErrorCode code, const std::string& what) {
    return tl::unexpected(Error{code, "standing: " + what});
  };
  const glm::vec3 foot = standing.foot;
  if (!std::isfinite(foot.x) || !std::isfinite(foot.y) || !std::isfinite(foot.z)) {
    return wrong(
        ErrorCode::kDataDamaged,
        fmt::format("its foot is ({:g}, {:g}, {:g}), give finite metres.", foot.x, foot.y, foot.z));
  }
  if (!(standing.radius > 0.0f && standing.radius <= kWidestStanding)) {
    return wrong(ErrorCode::kSettingOutOfRange,
                 fmt::format("a radius of {:g} m cannot work: give more than 0 and up to {:g} m.",
                             standing.radius, kWidestStanding));
  }
  return checkCost(standing.cost);
}

void blockedBy(const NavGraph& graph, const LocationIndex& locations, const Standing& standing,
               std::vector<PolygonCost>& blocked) {
  const glm::vec2 centre = toPlan(standing.foot);
  const std::size_t first = blocked.size();
  forPolygonsNear(locations, centre, standing.radius, [&](PolygonId polygon) {
    if (!Blocking(graph, polygon, centre, standing.radius).blocks()) return;
    const float height = heightAt(graph, polygon, centre);
    if (std::abs(height - standing.foot.y) > kStandingReach) return;
    blocked.push_back({polygon, standing.cost});
  });
  // A polygon lies in several cells.
  const auto begin = blocked.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, blocked.end(),
            [](const PolygonCost& a, const PolygonCost& b) { return a.polygon < b.polygon; });
  blocked.erase(std::unique(begin, blocked.end()), blocked.end());
}

}  // namespace forewalk::navmesh
