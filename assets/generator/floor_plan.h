// A storey as rooms that tile a rectangle, and the doors between them. Walls follow from the rooms.
//
// What a person could count on the plan is counted here, beside the geometry: rooms, doors, pieces
// of furniture that one can walk around, and from these the number of independent loops.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "obj_writer.h"

namespace forewalk::assets {

struct Room {
  std::string name;
  Rect area;    ///< to the middle of its walls, mm
  Point probe;  ///< a place where a person can stand, clear of furniture, mm
};

class FloorPlan {
 public:
  struct Style {
    int outerWall = 200;  ///< thickness, mm
    int innerWall = 120;  ///< thickness, mm
    int doorHead = 2100;  ///< height of door openings, mm
    bool windows = true;
  };

  /// `base` is the height of the floor and `wallHeight` that of the walls above it, mm.
  FloorPlan(int base, int wallHeight, Style style);

  /// Adds a room; returns its number. The probe is the middle until placed elsewhere.
  std::size_t room(const std::string& name, Rect area);
  void probe(std::size_t room, int x, int z);

  /// A door in the wall that two rooms share, centred at `at` along it, mm. Throws std::logic_error
  /// where the opening would not lie in that wall.
  void door(std::size_t a, std::size_t b, int at, int width);

  /// No wall between two rooms.
  void open(std::size_t a, std::size_t b);

  /// Something that stands free: one can walk around it. The next shapes drawn are up to the
  /// caller.
  void island() { ++islands_; }

  /// Floor walls: exterior ones with windows, interior ones with doors.
  void writeWalls(ObjWriter& out) const;

  /// The rectangle that the floor slab has to cover, walls included.
  Rect footprint() const;

  const std::vector<Room>& rooms() const { return rooms_; }
  std::size_t doorCount() const { return passages_.size(); }
  int base() const { return base_; }

  /// Independent loops a walker finds: doors - rooms + 1 around walls, one around each island.
  /// Holds where all rooms hang together.
  int loops() const;

 private:
  struct Passage {
    std::size_t a, b;
    bool alongX;   ///< direction of the wall it lies in
    int line;      ///< coordinate of that wall across its direction, mm
    int from, to;  ///< stretch along the wall, mm
    bool head;     ///< a lintel closes the wall above it
  };
  struct Shared {
    bool alongX;
    int line, from, to;
  };
  Shared sharedWall(std::size_t a, std::size_t b) const;

  int base_;
  int wallHeight_;
  Style style_;
  std::vector<Room> rooms_;
  std::vector<Passage> passages_;
  int islands_ = 0;
};

}  // namespace forewalk::assets
