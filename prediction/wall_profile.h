// How the distance from the user rises and falls along the walls within the horizon.
//
// Walls (cell_mesh.h) form closed borders. Along each, distances rise from every lowest place to a
// highest one and fall again. A piece of the front at some distance ends on two walls, and each
// stretch of border between a lowest and a highest place holds just one such end as the front runs
// along it. So what the front does at walls is known from these stretches alone.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prediction/cell_mesh.h"
#include "prediction/views.h"

namespace forewalk::prediction {

class WallProfile {
 public:
  /// A place on a wall: where it begins, or where the distance along it is lowest or highest.
  struct Sample {
    std::uint32_t wall;
    float value;             ///< exact distance, metres; beyond the horizon perhaps infinity
    double along;            ///< from the beginning of the wall, metres
    const View* before;      ///< the place is seen from here, coming along the wall, and
    const View* after;       ///< from here, going on; null at the beginning of a wall
    std::uint32_t previous;  ///< sample, or kNone: its wall was not reached
    std::uint32_t next;
    std::uint32_t stretch;  ///< that the wall from here to the next sample belongs to, or kNone
    bool rises;             ///< the distance does, from here to the next sample
  };
  /// From a lowest place, up the border on one side. Stretch 2k runs against the border's direction
  /// (coming along the border, the distance falls), 2k + 1 in it.
  struct Stretch {
    std::uint32_t low;  ///< sample
    float top;          ///< distance of the highest place that it leads to; infinity: beyond the
                        ///< horizon
  };
  /// A lowest or highest place within the horizon.
  struct Extreme {
    std::uint32_t sample;
    bool low;
    std::uint32_t stretch;  ///< of a low: the first of its two
  };

  WallProfile(const CellMesh& mesh, std::uint32_t ends);

  /// Measures all walls of what `field` reached, whose views are `views`, out to `horizon` metres.
  /// O(walls * views of their polygons); allocates only while buffers grow to the largest seen.
  void measure(const DistanceField& field, const Views& views, float horizon);

  // All of these live until the next measure.
  std::span<const Sample> samples() const { return samples_; }
  std::span<const Stretch> stretches() const { return stretches_; }
  std::span<const Extreme> extremes() const { return extremes_; }  ///< by sample

  glm::dvec2 placeOf(const Sample& sample) const {
    const CellMesh::Line& line = mesh_->lines[mesh_->walls[sample.wall].edge];
    return line.from + sample.along * line.along;
  }
  PolygonId polygonOf(const Sample& sample) const {
    return mesh_->edges[mesh_->walls[sample.wall].edge].left;
  }
  /// A part of one wall, between two samples; metres from its beginning.
  struct Reach {
    std::uint32_t wall;
    double from, to;
  };
  /// Where a stretch is `level` metres away, which lies between its low and its top; beyond the
  /// top, there. O(samples of the stretch).
  Reach reachOf(std::uint32_t stretch, float level) const;

  /// About where that is: interpolated between the samples around it. O(samples of the stretch).
  glm::dvec2 placeNear(std::uint32_t stretch, float level) const;

  /// The sample before a place on a wall that was measured, or kNone.
  std::uint32_t sampleBefore(std::uint32_t wall, double along) const;

 private:
  struct Between {
    std::uint32_t below, above;  // samples; above: kNone, beyond the horizon or the top
  };
  struct Sight {
    double foot, asideSquared;  // of the root on the wall's line, metres
    const View* view;
  };

  Between around(std::uint32_t stretch, float level) const;

  void reset();
  float valueAt(std::uint32_t vertex, PolygonId polygon);
  void addWall(const CellMesh::Corner& line, PolygonId polygon, float from, float to);
  void addSample(std::uint32_t wall, double along, float value, const View* before,
                 const View* after);
  bool findSights(const CellMesh::Corner& line, std::span<const View> views, float from, float to);
  void findFeet(const CellMesh::Corner& line);
  double lookAt(const CellMesh::Corner& line, double place, const Sight*& nearest) const;
  static double equallyFar(const Sight& rising, const Sight& falling, double left, double right);
  double highestBetween(const CellMesh::Corner& line, double low, double high, const Sight*& rising,
                        const Sight*& falling) const;
  void link();
  void findExtremes();
  void layStretches(std::uint32_t low);

  const CellMesh* mesh_;
  std::uint32_t ends_;  // vertices below are ends of portals
  const DistanceField* field_ = nullptr;
  const Views* views_ = nullptr;
  float horizon_ = 0.0f;

  std::vector<std::uint32_t> firstOf_;  // per wall: its first sample, or kNone
  std::vector<std::uint32_t> touched_;  // walls
  std::vector<Sample> samples_;
  std::vector<Stretch> stretches_;
  std::vector<Extreme> extremes_;

  std::vector<Sight> sights_;
  double firstFoot_ = 0.0, lastFoot_ = 0.0;  // among the sights
  struct Foot {
    double along, distance;
    const View* view;
  };
  std::vector<Foot> feet_;
};

}  // namespace forewalk::prediction
