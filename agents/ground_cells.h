// The ground sampled uniformly into free, mixed and full cells, kept current as objects move.
//
// The global map of the virtual-agents paper (models/social_forces.h): a square grid over one
// storey, and in each cell a square of samples. A sample is blocked where its own little square may
// touch an object, a wall, or ground that is not walkable; so no thin wall slips between samples.
// A cell is free where none of its samples is blocked, full where all are, mixed between. Each
// sample knows the room around it, each cell its roomiest sample, its place, and the way from place
// to place its narrowest spot: so a mixed cell lets pass who fits through its free part, and nobody
// else, and two places with a wall between them are no neighbours.
//
// One storey: a building with several needs one grid each.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "agents/walls.h"
#include "navmesh/build/obstacle.h"
#include "navmesh/error.h"
#include "navmesh/world.h"

namespace forewalk::agents {

struct CellSettings {
  glm::vec2 low{-20.0f}, high{20.0f};  ///< the rectangle on the plan that is sampled, metres
  float cell = 0.5f;                   ///< side of a cell, metres, > 0
  std::uint32_t samples = 5;           ///< a cell's side has so many; odd, 1 to 15
  float height = 0.0f;  ///< of the storey's ground, world y, metres; within 1 m of it counts
  float reach = 0.75f;  ///< room is told apart up to so much, metres: the widest body's radius
};

enum class CellKind : std::uint8_t { free, mixed, full };

/// The map. What `update` leaves depends on the ground and the objects that are there, to the last
/// bit, and not on how they came there.
class GroundCells {
 public:
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  /// Fails when a setting is out of its range or there would be more than 4 million samples
  /// (kSettingOutOfRange, kTooLarge).
  [[nodiscard]] static tl::expected<GroundCells, Error> make(const CellSettings& settings);

  /// What does not move: the walkable ground of `world` (null: all of the rectangle), built for a
  /// walker of `walkerRadius`, and walls. O(samples * (locate + walls near)); everything is changed
  /// after it.
  void setGround(const navmesh::World* world, float walkerRadius, std::span<const Wall> walls);

  /// Adds an object, or moves the one of this number. It must be valid. O(samples near it).
  void setObject(navmesh::ObstacleId id, const navmesh::Obstacle& shape);
  bool removeObject(navmesh::ObstacleId id);  ///< false: not here

  /// Brings rooms, places and ways up to date. Returns the cells in which the room of some sample
  /// is another than at the last update, ascending; valid until the next one. O(cells within
  /// `reach` of what moved).
  std::span<const std::uint32_t> update();

  const CellSettings& settings() const { return settings_; }
  std::uint32_t columns() const { return columns_; }
  std::uint32_t rows() const { return rows_; }
  std::uint32_t size() const { return columns_ * rows_; }

  CellKind kind(std::uint32_t cell) const;
  std::uint32_t cellAt(glm::vec2 point) const;  ///< kOutside beyond the rectangle
  glm::vec2 placeOf(std::uint32_t cell) const;  ///< its roomiest sample, the nearest to its middle
  float roomOf(std::uint32_t cell) const { return room_[place_[cell]]; }  ///< of its place, metres
  float roomAt(glm::vec2 point) const;  ///< of the point's sample, 0 outside; metres

  /// Directions to neighbours, and the way to one: the least room from place to place, metres; 0
  /// where a corner would be cut (a diagonal beside a cell that is full) or there is no neighbour.
  static constexpr std::uint32_t kDirections = 8;  ///< E NE N NW W SW S SE; odd: diagonal
  std::uint32_t neighbour(std::uint32_t cell, std::uint32_t direction) const;  ///< or kOutside
  float wayRoom(std::uint32_t cell, std::uint32_t direction) const;

  /// The least room along the straight line, metres; 0 where it is blocked or leaves the rectangle.
  float lineRoom(glm::vec2 from, glm::vec2 to) const;

  /// Appends the cells that the straight line crosses, in order; those it only touches at a corner
  /// too.
  void appendCrossed(glm::vec2 from, glm::vec2 to, std::vector<std::uint32_t>& cells) const;

 private:
  struct Object {
    navmesh::ObstacleId id;
    navmesh::Obstacle shape;
  };
  struct Offset {
    int column, row;
    float distance;
  };

  explicit GroundCells(const CellSettings& settings);
  std::uint32_t sampleColumns() const { return columns_ * settings_.samples; }
  std::uint32_t sampleRows() const { return rows_ * settings_.samples; }
  glm::vec2 pointOf(std::uint32_t sample) const;
  glm::dvec2 inSamples(glm::vec2 point) const {
    return (glm::dvec2(point) - glm::dvec2(settings_.low)) / static_cast<double>(spacing_);
  }
  std::uint32_t cellOfSample(std::uint32_t sample) const;
  bool blocked(std::uint32_t sample) const { return ground_[sample] != 0 || covers_[sample] != 0; }
  void cover(const navmesh::Obstacle& shape, int by);
  float findRoom(std::uint32_t sample) const;
  void findPlace(std::uint32_t cell);
  void markDirty(std::uint32_t cell);
  template <typename Visit>
  void forSamplesIn(glm::dvec2 low, glm::dvec2 high, const Visit& visit) const;
  template <typename Visit>
  bool walkLine(glm::vec2 from, glm::vec2 to, const Visit& visit) const;

  CellSettings settings_;
  std::uint32_t columns_ = 0, rows_ = 0;
  float spacing_ = 0.1f;       // from sample to sample
  float groundMargin_ = 0.0f;  // the true wall lies so far behind the navmesh's border
  std::vector<Offset> offsets_;
  // Per sample.
  std::vector<std::uint8_t> ground_;   // 0 walkable, 1 not, 2 a wall
  std::vector<std::uint16_t> covers_;  // by so many objects
  std::vector<float> room_;
  // Per cell.
  std::vector<std::uint16_t> blockedIn_;
  std::vector<std::uint32_t> place_;       // a sample
  std::vector<std::array<float, 4>> way_;  // E NE N NW; the others are the neighbours'
  std::vector<std::uint8_t> dirty_, near_;
  std::vector<std::uint32_t> dirtyCells_, nearCells_, changed_;
  std::vector<Object> objects_;  // in the order of coming; looked up alone
};

}  // namespace forewalk::agents
