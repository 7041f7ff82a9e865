// Follows the front of all points at one distance from the user, as it runs outward: where it
// splits, where two pieces meet, where one dies, and where pieces reach the horizon.
//
// This is the Reeb graph of the distance, cut at the horizon (Cole-McLaughlin, Edelsbrunner, Harer,
// Natarajan and Pascucci, "Loops in Reeb graphs of 2-manifolds", 2003; swept by level as Pascucci,
// Scorzelli, Bremer and Mascarenhas, "Robust on-line computation of Reeb graphs", SIGGRAPH 2007).
//
// We depart from them in that no triangles are swept. Distances are exact (distance_field.h), and a
// piece of the front ends on two walls, so all that can happen to it is known from the walls: where
// the distance along one is lowest, the front touches it and splits; where it is highest, the two
// pieces that ran toward each other along it meet, or one piece dies. Apart from that, fronts from
// two sides may meet in the open. Which piece it is that touches a wall is known from the roots
// that it is about and their order along it (front_order.h), or, where fronts are closed or roots
// are in doubt, found by following the front from there to the walls that it ends on
// (front_trace.h).
//
// Where the front comes to the entry of a link that shortest paths lead through, the ways part: one
// goes on over the floor, the other through the link, and when it comes out of the exit it is a
// closed front about that.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/key_queue.h"
#include "prediction/cell_mesh.h"
#include "prediction/distance_field.h"
#include "prediction/front_order.h"
#include "prediction/front_trace.h"
#include "prediction/views.h"
#include "prediction/wall_profile.h"

namespace forewalk::prediction {

/// What happens to pieces of the front at one place. How many arcs end and begin there says what:
/// none and one, the source; one and more, a branch; more and one, a join; one or more and none,
/// the end of a way.
struct FrontEvent {
  glm::vec2 plan;
  PolygonId polygon;  ///< one that holds it
  float distance;     ///< metres
};

/// A piece of the front between two events, or up to the horizon.
struct FrontArc {
  std::uint32_t from;    ///< event
  std::uint32_t to;      ///< event; kNone: it reaches the horizon
  std::uint32_t corner;  ///< last corner of a shortest path to where it ends, in this piece
  std::uint32_t front;   ///< index into HorizonFronts; kNone where it ends before
};

/// A piece of the front at the horizon.
struct HorizonFront {
  glm::vec2 from, to;          ///< its ends, on walls; equal where it is closed
  glm::vec2 crossing;          ///< its middle
  PolygonId polygon;           ///< holds the middle
  float length;                ///< metres
  std::uint32_t link = kNone;  ///< the passage (DistanceField) that the horizon falls into, where
                               ///< the way is cut on its straight line; kNone: it is on the floor
};

class FrontSweep {
 public:
  /// All three must outlive this; `cells` and `ends` were made from `graph`. Sized for fields of up
  /// to `windows` windows.
  FrontSweep(const navmesh::NavGraph& graph, const PortalEnds& ends, const CellMesh& cells,
             std::uint32_t windows);

  /// Follows the front of `field`, just run from `source`, out to `horizon` metres. O(n log n) in
  /// the walls of what was reached, and O(length of the front) an event. Allocates only while the
  /// buffers grow to the largest seen.
  void run(const DistanceField& field, const navmesh::Location& source, float horizon);

  /// The source first, then as they happen; where closed fronts shrink to a point comes last. These
  /// live until the next run.
  std::span<const FrontEvent> events() const { return events_; }
  std::span<const FrontArc> arcs() const { return arcs_; }
  std::span<const HorizonFront> fronts() const { return fronts_; }

  /// How far apart the walls are between which an arc passes, halfway between the distances where
  /// it begins and ends, metres. 0: there are none.
  float widthOf(std::uint32_t arc) const;

  /// Events at which it was not clear which piece of the front they happened to: rounding, or
  /// exact symmetry. The nearest was taken.
  std::uint32_t doubts() const { return doubts_; }

 private:
  using Key = navmesh::KeyQueue::Entry;

  /// Where fronts from two sides meet first in the open.
  struct Meeting {
    glm::dvec2 place;
    float value;
    PolygonId polygon;
    const View* sides[2];
  };
  /// The stretches of wall that an arc ends on, as one looks outward. kNone: it is closed.
  struct Ends {
    std::uint32_t left, right;
  };
  /// A place at a front, just before something happens there.
  struct Spot {
    PolygonId polygon;
    const View* view;  // null: none known
    glm::dvec2 at;
    double level;
  };
  /// A front that sets out to all sides: from the source, or from where a link leads.
  struct Seed {
    std::uint32_t corner;  // of the field, where it does
    std::uint32_t arc;     // the closed one all around it, or kNone: it ends on walls by now
    bool opened;           // it has ended on walls
  };
  void findMeetings(PolygonId polygon);
  void listEvents();
  Spot spotBefore(glm::dvec2 place, float value, PolygonId polygon, const View* view) const;
  Spot spotAt(const WallProfile::Sample& sample, bool after) const;
  std::uint32_t arcAt(const Spot& spot, Direction direction);
  std::uint32_t sectorTouching(const WallProfile::Sample& sample, const Spot& spot,
                               glm::dvec2& direction) const;
  std::uint32_t arcOfSector(std::uint32_t sector) const;
  void admitRoots(float upTo);
  void admitRoot(std::uint32_t corner);
  std::uint32_t arcOn(const FrontEnd& end, bool left) const;
  std::uint32_t closedArc(const Spot& spot);
  std::uint32_t seedOf(std::uint32_t corner) const;
  bool isSeedArc(std::uint32_t arc) const;
  bool hasPockets() const;
  void reseed(std::uint32_t arc, std::uint32_t now);

  void addArc(std::uint32_t from, Ends ends);
  void endArc(std::uint32_t arc, std::uint32_t corner);
  std::uint32_t addEvent(glm::dvec2 place, PolygonId polygon, float distance);
  void enterLink(std::uint32_t passage);
  void leaveLink(std::uint32_t passage);
  void cutLink(std::uint32_t passage);
  void touch(const WallProfile::Extreme& low);
  bool isHollow(const WallProfile::Sample& sample) const;
  bool closesAround(const Spot& spot);
  void close(const WallProfile::Extreme& high);
  void meet(const Meeting& meeting);

  void endAtHorizon();
  bool spotOnWall(std::uint32_t stretch, float level, Spot& spot) const;
  bool startInTheOpen(std::uint32_t arc, Spot& spot);
  void shrink(std::uint32_t arc);
  void addFront(std::uint32_t arc, const Spot& spot);

  const navmesh::NavGraph* graph_;
  const PortalEnds* ends_;
  const CellMesh* mesh_;
  const DistanceField* field_ = nullptr;
  float horizon_ = 0.0f;
  std::uint32_t doubts_ = 0;

  Views views_;
  WallProfile walls_;
  FrontTrace trace_;

  FrontOrder roots_;
  bool ordered_ = false;               // roots_ is right so far
  std::uint32_t admitted_ = 0;         // so many corners of the field are among them
  std::vector<std::uint32_t> wallAt_;  // per end of portals: the wall that begins there; kNone
                                       // where none does, or several

  std::vector<Meeting> meetings_;
  std::vector<Key> order_;            // of passages, extremes, then meetings, by number
  std::vector<std::uint32_t> arcOf_;  // per stretch: the arc that ends there now, or kNone
  std::vector<Ends> endsOf_;          // per arc
  std::vector<std::uint32_t> alive_;  // arcs, in no order
  std::vector<Seed> seeds_;
  std::vector<std::uint32_t> entered_;  // per passage: the event at its entry, or kNone
  std::vector<FrontPiece> pieces_;

  std::vector<FrontEvent> events_;
  std::vector<FrontArc> arcs_;
  std::vector<HorizonFront> fronts_;
};

}  // namespace forewalk::prediction
