// The part of the room that is tracked and free to walk: a polygon with holes.
//
// On the plan of the physical world (navmesh/plan.h), metres. Made once at load, then only read.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::rdw {

/// A simple polygon minus simple holes strictly inside it. Rings are stored without the closing
/// repeat, the border counter-clockwise, holes clockwise, so that the free floor always lies left
/// of an edge.
class TrackedSpace {
 public:
  /// Corners that circle() uses: the inscribed regular polygon, whose border lies up to 0.5 mm per
  /// metre of radius inside the true circle. Never outside: a wall is not walked into by
  /// approximation.
  static constexpr int kCircleCorners = 96;

  /// In all rings together; checking a polygon is quadratic in them.
  static constexpr std::size_t kMostCorners = 4096;

  /// 6 m x 6 m about the origin, so that a default is a usable room.
  TrackedSpace();

  /// Centred on the origin. Fails (kSettingOutOfRange) unless both sides lie in [0.1, 10000] m.
  static tl::expected<TrackedSpace, Error> rectangle(double width, double depth);

  /// Centred on the origin. Fails (kSettingOutOfRange) unless the radius lies in [0.1, 10000] m.
  static tl::expected<TrackedSpace, Error> circle(double radius);

  /// Rings in either direction, without or with the closing repeat; consecutive equal corners are
  /// merged.
  ///
  /// Fails (kDataDamaged, naming ring, corner and value) when a ring has fewer than 3 corners, a
  /// coordinate is not finite or beyond 10 km, a ring crosses or touches itself, rings cross or
  /// touch each other, a hole lies outside the border or inside another hole, or an area is under
  /// 0.01 m^2; kTooLarge beyond 4096 corners. Costs O(corners^2).
  static tl::expected<TrackedSpace, Error> polygon(
      std::span<const glm::dvec2> border, std::span<const std::vector<glm::dvec2>> holes = {});

  /// Reads `forewalk.space/1`: {"format": "forewalk.space/1", and one of "rectangle": [w, d],
  /// "circle": r, "polygon": [[x, z], ...] with optional "holes": [[[x, z], ...], ...], "shape":
  /// "L" with "area_m2": 50 (room_shapes.h)}.
  /// Coordinates are world x and z, metres. Fails as above, with the line for malformed JSON.
  static tl::expected<TrackedSpace, Error> fromJson(std::string_view text);

  /// Reads OpenRDW's tracking space text: a line `x,y` a corner, a blank line starts an obstacle.
  /// Its y points away from the user in a space seen from above, so the pairs are plan coordinates:
  /// world z = -y. OpenRDW 2's form, which begins with a number of users and describes a virtual
  /// space first, is read as well: its first room. Fails as above, naming the line.
  static tl::expected<TrackedSpace, Error> fromOpenRdw(std::string_view text);

  /// fromJson where the first visible character is `{`, fromOpenRdw otherwise.
  static tl::expected<TrackedSpace, Error> read(std::string_view text);

  /// Distance to the nearest border or hole, metres: positive inside, negative outside. O(corners).
  double signedDistance(glm::dvec2 point) const;

  /// Whether the point lies in the free floor, its border included.
  bool contains(glm::dvec2 point) const;

  /// How far one can walk from `point` along unit vector `direction` before leaving the free floor,
  /// metres. From outside, or on the border heading out: 0. From outside heading in: still 0; see
  /// `contains`. O(corners).
  double distanceAlong(glm::dvec2 point, glm::dvec2 direction) const;

  /// The nearest point of any border, and the unit normal there, pointing into the free floor (at a
  /// corner: away from the corner, into the floor). O(corners).
  struct BorderPoint {
    glm::dvec2 position;
    glm::dvec2 inward;
    double distance;  ///< metres, >= 0, inside or outside
  };
  BorderPoint nearestBorder(glm::dvec2 point) const;

  /// The pole of inaccessibility, to a millimetre: the point furthest from every border
  /// (Garcia-Castellanos and Lombardo 2007, in the quadtree form of Mapbox's polylabel). Inside an
  /// L or around a pillar, where a bounding box's centre need not be. Where several are equal, the
  /// one nearest the centroid of the border; of a rectangle it is therefore the centre.
  glm::dvec2 centre() const { return centre_; }

  /// Distance from centre() to the nearest border, metres.
  double clearance() const { return clearance_; }

  double area() const { return area_; }             ///< free floor, m^2
  glm::dvec2 lowerBound() const { return lower_; }  ///< corners of the bounding box, plan
  glm::dvec2 upperBound() const { return upper_; }

  /// The least width of the border, seen along any of its edges, metres: the shorter side of a
  /// rectangle, however it stands.
  double shorterSide() const { return shorterSide_; }

  /// Rings: 0 is the border, the rest are holes. Lives as long as the space.
  std::size_t ringCount() const { return ringStart_.size() - 1; }
  std::span<const glm::dvec2> ring(std::size_t i) const {
    return {corners_.data() + ringStart_[i], ringStart_[i + 1] - ringStart_[i]};
  }

 private:
  struct Unchecked {};
  explicit TrackedSpace(Unchecked) {}
  void measure();

  std::vector<glm::dvec2> corners_;
  std::vector<std::size_t> ringStart_;
  glm::dvec2 centre_{0.0};
  glm::dvec2 lower_{0.0};
  glm::dvec2 upper_{0.0};
  double clearance_ = 0.0;
  double area_ = 0.0;
  double shorterSide_ = 0.0;
};

}  // namespace forewalk::rdw
