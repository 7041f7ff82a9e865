// Follows the front of all points at one distance from the user, as it runs outward: where it
// splits, where two pieces meet, where one dies, and where pieces reach the horizon.
//
// This is the Reeb graph of the distance, cut at the horizon (Cole-McLaughlin, Edelsbrunner, Harer,
// Natarajan and Pascucci, "Loops in Reeb graphs of 2-manifolds", 2003; swept by level as Pascucci,
// Scorzelli, Bremer and Mascarenhas, "Robust on-line computation of Reeb graphs", SIGGRAPH 2007),
// over the walkable polygons within the horizon with distances interpolated between vertices.
//
// We depart from them in the cells. A polygon need not be cut into triangles: where the distances
// along its outline rise from one lowest vertex to one highest, every level crosses it in a single
// piece, from one side to the other. So outlines get vertices wherever the exact distance
// (distance_field.h) has a lowest or highest point along an edge, and polygons are cut only from
// where the front comes in to where it touches the next edges, and, where two fronts meet inside,
// through the point where they meet first.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/key_queue.h"
#include "prediction/cell_mesh.h"
#include "prediction/distance_field.h"

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
  float widthAtStart;    ///< length of the piece after the first event, metres
  float widthAtEnd;      ///< and before the last, or at the horizon
  std::uint32_t front;   ///< index into HorizonFronts; kNone where it ends before
};

/// A piece of the front at the horizon.
struct HorizonFront {
  glm::vec2 from, to;  ///< its ends, on walls; equal where it is closed
  glm::vec2 crossing;  ///< its middle
  PolygonId polygon;   ///< holds the middle
  float length;        ///< metres
};

class FrontSweep {
 public:
  /// All three must outlive this; `cells` and `ends` were made from `graph`. Sized for fields of up
  /// to `windows` windows.
  FrontSweep(const navmesh::NavGraph& graph, const PortalEnds& ends, const CellMesh& cells,
             std::uint32_t windows);

  /// Follows the front of `field`, just run from `source`, out to `horizon` metres. O(n log n) in
  /// the vertices of what was reached, and O(cells of a front) an event. Allocates only while the
  /// buffers grow to the largest seen.
  void run(const DistanceField& field, const navmesh::Location& source, float horizon);

  /// In order of distance, the source first. These live until the next run.
  std::span<const FrontEvent> events() const { return events_; }
  std::span<const FrontArc> arcs() const { return arcs_; }
  std::span<const HorizonFront> fronts() const { return fronts_; }

 private:
  /// A vertex of what was reached.
  struct Vertex {
    glm::vec2 plan;
    float value;        // exact distance up to the horizon, metres
    PolygonId polygon;  // one that holds it
    PolygonId from;  // the front touches an edge here first, coming through this polygon; or none
    std::uint32_t records;    // the last of its records; they go on by CornerRecord::next
    std::uint32_t lowerEdge;  // one of those that come up to it, or kNone
    std::uint8_t passes;      // how often the front passes from lower to upper edges about it
    bool meeting;             // two fronts meet here on an edge
    bool forced;              // its cells are no single fan: whatever happens here is an event
  };
  /// Distances rise or fall along it.
  struct Edge {
    std::uint32_t a, b;        // vertices
    std::uint32_t records[2];  // where its cells have it as `out`; kNone: a wall
    std::uint32_t piece;       // of the front that crossed it at the last event there; or kNone
    PolygonId polygon;
  };
  struct Cell {
    PolygonId polygon;
    std::uint32_t begin, end;  // its records, counter-clockwise
  };
  /// A vertex in one cell, between two edges.
  struct CornerRecord {
    std::uint32_t vertex, cell, out;
    std::uint32_t next;  // another of the vertex, or kNone
  };
  /// A window of a polygon, which does not see what lies beyond the edge that it comes in over.
  struct View {
    glm::dvec2 root;
    double distance;  // of the root
    const Window* window;
    std::uint32_t edge;  // of the mesh; kNone: it touches the root
    PolygonId polygon;
  };
  /// A view of an edge: where the root's foot is on its line, metres along it, and how far aside.
  struct Sight {
    double foot, asideSquared;
    const View* view;
  };
  /// Where the front touches an edge first, metres along it, its distance, and the polygon it comes
  /// through.
  struct Foot {
    double along;
    double distance;
    PolygonId front;
  };
  struct CycleCorner {
    std::uint32_t vertex, edge;
  };
  /// Vertices in order of distance, ties by number, as one number.
  using Key = navmesh::KeyQueue::Entry;

  void reset();
  std::uint32_t vertexAt(std::uint32_t meshVertex, PolygonId polygon);
  std::uint32_t addVertex(glm::vec2 plan, float value, PolygonId polygon);
  std::uint32_t addEdge(std::uint32_t a, std::uint32_t b, PolygonId polygon);
  void gatherViews(PolygonId polygon);
  std::span<const View> viewsOf(PolygonId polygon) const;
  void cutEdge(std::uint32_t meshEdge);
  bool findSights(std::uint32_t meshEdge, float valueFrom, float valueTo);
  void findFeet(const CellMesh::Line& line);
  static bool sees(const View& view, glm::dvec2 point);
  double lookAt(const CellMesh::Line& line, double place, const Sight*& nearest) const;
  static double equallyFar(const Sight& rising, const Sight& falling, double left, double right);
  double highestBetween(const CellMesh::Line& line, double low, double high) const;
  void addCells(PolygonId polygon);
  void addBasin(std::span<const CycleCorner> outline, std::size_t low, PolygonId polygon);
  void addSourceCells(PolygonId polygon);
  bool findMeeting(PolygonId polygon, glm::vec2& plan, float& value);
  void cellOf(std::span<const CycleCorner> outline, PolygonId polygon);
  bool below(std::uint32_t a, std::uint32_t b) const { return keys_[a] < keys_[b]; }

  void listEvents();
  bool onBorder(std::uint32_t vertex) const;
  void listRecords(std::uint32_t vertex);
  void happen(std::uint32_t vertex);
  std::uint32_t edgeInto(std::uint32_t record) const;
  bool isLower(std::uint32_t edge, std::uint32_t vertex) const;
  std::uint32_t pieceOf(std::uint32_t edge);
  std::uint32_t across(std::uint32_t record, Key level) const;
  template <typename Visit>
  bool follow(std::uint32_t edge, int side, Key level, const Visit& visit) const;
  template <typename Visit>
  float measure(std::uint32_t edge, Key level, float distance, const Visit& visit) const;
  glm::vec2 crossing(std::uint32_t edge, float level) const;
  glm::vec2 exactCrossing(std::uint32_t edge, float level) const;
  std::uint32_t cornerToward(std::uint32_t vertex, std::uint32_t edge) const;
  void endAtHorizon();
  void addFront(std::uint32_t edge, Key level);

  const navmesh::NavGraph* graph_;
  const PortalEnds* ends_;
  const CellMesh* mesh_;
  const DistanceField* field_ = nullptr;
  float horizon_ = 0.0f;

  // Per vertex and edge of the mesh: what they became in this run. Reset by walking the touched.
  std::vector<std::uint32_t> vertexOf_;
  std::vector<std::uint32_t> firstEdgeOf_, edgeCountOf_;
  std::vector<std::uint32_t> touchedVertices_, touchedEdges_;

  std::vector<std::uint32_t> viewStart_, viewCount_;  // per polygon; of those reached
  std::vector<View> views_;

  std::vector<Vertex> vertices_;
  std::vector<Key> keys_;  // per vertex
  std::vector<Edge> edges_;
  std::vector<Cell> cells_;
  std::vector<CornerRecord> records_;
  std::vector<Key> order_;            // vertices where something happens
  std::vector<std::uint32_t> arcOf_;  // per piece
  std::vector<std::uint8_t> ended_;   // per edge: its piece at the horizon is known

  std::vector<Sight> sights_;
  double firstFoot_ = 0.0, lastFoot_ = 0.0;  // among the sights
  std::vector<CycleCorner> cycle_, basin_, outline_, inner_;
  std::vector<std::size_t> lows_, highs_, others_;
  std::vector<Foot> feet_;
  std::vector<std::uint32_t> recordsHere_;
  std::vector<std::uint32_t> lowerArcs_, lowerEdges_;
  std::vector<glm::vec2> polyline_;
  std::vector<PolygonId> polylinePolygons_;

  std::vector<FrontEvent> events_;
  std::vector<FrontArc> arcs_;
  std::vector<HorizonFront> fronts_;
};

}  // namespace forewalk::prediction
