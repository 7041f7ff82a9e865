// Recorded walks, seen frame by frame as a runtime would have seen them, with what came of it.
//
// For fitting and judging predictions: the ways of every frame (prediction/likelihood.h), and at
// regular samples the way that was then taken and where the walker came to be.
#pragma once

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "navmesh/world.h"
#include "prediction/likelihood.h"
#include "prediction/predict.h"
#include "rdw/walk_file.h"

namespace forewalk::service {

/// Makes the graph of a frame: the method under test. One per thread; the graph lives until its
/// next call.
using GraphMaker =
    std::function<const prediction::PredictionGraph&(const navmesh::Location&, float horizon)>;
/// Makes a GraphMaker for a world, which outlives it.
using MethodFactory = std::function<GraphMaker(const navmesh::World&)>;

struct RecordingSettings {
  float horizon = 5.0f;      ///< metres, > 0
  double rate = 15.0;        ///< frames per second, > 0
  double sampleEvery = 0.5;  ///< seconds between samples, > 0
  double spacing = 0.0;  ///< metres between the places of samples, at least: somebody who stands
                         ///< and looks about is asked but once
  float height = 0.0f;   ///< of the floor where the walk begins, world y, metres
  prediction::WayTrackerSettings ways{};  ///< how they keep their names
};

/// When places are compared: seconds ahead, and metres of the walk ahead.
inline constexpr std::array<double, 6> kSecondsAhead{0.5, 1.0, 2.0, 3.2, 4.0, 5.0};
inline constexpr std::array<double, 4> kMetresAhead{1.0, 2.0, 3.0, 5.0};

/// What became of a sample.
enum class Outcome {
  kTaken,     ///< one of the graph's ways: Sample::taken
  kNoWay,     ///< the walker left the horizon, but by no way of the graph
  kUnsettled  ///< the recording ends before
};

/// One moment to be judged.
struct Sample {
  std::size_t frame;  ///< in RecordedWalk::frames
  Outcome outcome;
  std::size_t taken = 0;          ///< index of the way taken, where the outcome is kTaken
  double settledAfter = 0.0;      ///< seconds until then
  std::vector<glm::dvec2> toEnd;  ///< per way: unit direction to where it ends
  std::vector<std::vector<glm::dvec2>> paths;          ///< per way: a point every kPathStep
  std::array<glm::dvec2, kSecondsAhead.size()> after;  ///< where the walker was then
  std::array<glm::dvec2, kMetresAhead.size()> along;
  std::size_t afterKnown = 0;  ///< the first so many of `after` were recorded
  std::size_t alongKnown = 0;
};
inline constexpr double kPathStep = 0.25;  ///< metres

/// The point `s` metres along a way of a sample; its end beyond.
glm::dvec2 alongPath(const std::vector<glm::dvec2>& path, double s);

struct RecordedFrame {
  std::size_t firstWay, wayCount;  ///< range in RecordedWalk::facts
  prediction::Walked walked;
  glm::dvec2 plan, velocity;
};

/// How ways came and went.
struct WayTurnover {
  double metres = 0.0;               ///< walked
  std::size_t frames = 0, ways = 0;  ///< ways: summed over frames
  std::size_t births = 0, deaths = 0, splits = 0, merges = 0, returns = 0;

  WayTurnover& operator+=(const WayTurnover& other);
};

struct RecordedWalk {
  std::string walker;
  std::vector<RecordedFrame> frames;
  std::vector<prediction::WayFacts> facts;
  std::vector<Sample> samples;
  std::size_t offMesh = 0;  ///< frames beside the navmesh by more than may be mended; no ways there
  std::size_t snapped = 0;  ///< frames that were moved onto it
  double worstSnap = 0.0;   ///< metres
  WayTurnover turnover;

  std::span<const prediction::WayFacts> waysOf(const RecordedFrame& frame) const {
    return {facts.data() + frame.firstWay, frame.wayCount};
  }
};

/// Sees a walk. The way taken is settled when the walker's shortest path from the sample's place is
/// first as long as the horizon: the cut way that ends nearest to there is taken, if that is within
/// a metre and a half (of its front, where the method knows fronts); or before, when the walker
/// comes within half a metre of where a way ends that goes no farther, if that was farther off than
/// kArrived. Of ways that end in one place that is taken whose path is nearest to the walk. Costs a
/// prediction per frame and an exact distance field per sample.
RecordedWalk record(const navmesh::World& world, const rdw::Walk& walk, const MethodFactory& method,
                    const RecordingSettings& settings);

/// All walks of a recording, on `threads` threads (0: all cores); the result does not depend on how
/// many.
std::vector<RecordedWalk> recordAll(const navmesh::World& world, std::span<const rdw::Walk> walks,
                                    const MethodFactory& method, const RecordingSettings& settings,
                                    unsigned threads = 0);

/// The paper's method (prediction/predict.h).
GraphMaker polygonMethod(const navmesh::World& world);
/// Real junctions (prediction/front_graph.h).
GraphMaker frontMethod(const navmesh::World& world);
/// One of the two.
MethodFactory factoryOf(prediction::Method method);

}  // namespace forewalk::service
