// How like people does each model walk? Models sent on the errands of recorded people.
//
// Recorded walks are cut into legs (walk_legs.h): several people from one place to another. Each
// walker (a model, or the shortest way as a floor) is sent from the very start to the very goal of
// every leg, alone, at that person's comfort speed, and the paths of a set are compared by dynamic
// time warping, raw and normalised: are people farther from the model than from each other?
//
// Two tests, and neither alone. In each set the permutation test of separation.h, with Holm's
// adjustment for as many sets; since a model's path has its ends in common with one person's, it is
// too mild there, never too strict. And over all sets at once the test within pairs of
// matched_separation.h, which is exact, and has the resolution that single sets of four to six
// people lack.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "agents/evaluation/matched_separation.h"
#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/walk_file.h"
#include "service/lone_walks.h"
#include "service/path_comparison.h"
#include "service/walk_legs.h"

namespace forewalk::service {

/// A building and who walked there.
struct RecordedBuilding {
  std::string name;
  std::vector<rdw::Walk> walks;
  std::shared_ptr<const navmesh::World> world;
  float walkerRadius = 0.3f;  ///< that the navmesh was built for, metres
};

/// Whoever is sent on people's errands.
struct SentWalker {
  std::string name;
  /// In the building, in the place of its walk's leg; called from several threads at once.
  std::function<LonePath(const RecordedBuilding&, const WalkLeg&, const Errand&)> walk;
};

/// The shortest way, walked at even speed ("taut path"), then all models with their defaults.
std::vector<SentWalker> sentWalkers();

/// A walker in one set, by one table.
struct SetLikeness {
  double toPeople = 0.0;          ///< mean distance to people, other than whose errand it is
  double superiority = 0.5;       ///< within this set, as MatchedSeparation has it
  agents::Separation separation;  ///< the set's paths, whatever their errands
  double holm = 1.0;              ///< separation.p, adjusted for all sets
};

/// One set with all its paths.
struct ComparedSet {
  std::size_t building;  ///< index into Likeness::buildings
  LegSet legs;
  double shortestWay;               ///< metres, mean of its legs
  std::vector<ComparedPath> paths;  ///< the people's, then each walker's, in the order of legs
  std::vector<NamedTable> tables;   ///< "raw", "normalised"
  std::vector<double> peopleApart;  ///< per table: mean distance from person to person
  std::vector<std::vector<SetLikeness>> walkers;  ///< per table and walker

  std::string name;  ///< "searching-a 3>5": the building, and regions from and to
};

/// A walker over all sets, by one table.
struct OverallLikeness {
  double ratio = 1.0;  ///< median over sets of toPeople over peopleApart
  agents::MatchedSeparation matched;
  double farther = 1.0, apart = 1.0;  ///< matched's, adjusted (Holm) for as many walkers
  std::size_t toldApart = 0;          ///< sets with holm below 0.05
};

struct WalkerSummary {
  std::string name;
  std::size_t legs = 0, arrived = 0;
  double detour = 1.0;                   ///< walked over shortest way, all legs' metres
  std::vector<OverallLikeness> overall;  ///< per table
};

struct BuildingSummary {
  std::string name;
  std::size_t people = 0;
  std::vector<glm::dvec2> regions;
  std::size_t rests = 0, sets = 0, legs = 0;
  std::vector<double> speeds;  ///< comfort speeds of its people, m/s
};

/// The models among each other in a scene of the thesis, of which there are no recorded people.
struct SceneLikeness {
  const agents::AvatarScene* scene;
  std::vector<std::string> walkers;
  std::vector<LonePath> walked;
  agents::DistanceTable normalised;
};

struct Likeness {
  LegRule rule;
  std::vector<BuildingSummary> buildings;
  std::vector<ComparedSet> sets;  ///< by building, then as cutLegs has them
  double peopleDetour = 1.0;
  std::vector<WalkerSummary> walkers;
  std::vector<SceneLikeness> scenes;
};

/// Walks and compares all. People of different buildings count as different people. Fails
/// (kSettingOutOfRange) where the rule finds no set in any building, and as tablesOf does. The same
/// for any number of threads. `progress` is told (done, of all) of walks, from any thread.
[[nodiscard]] tl::expected<Likeness, Error> compareWithPeople(
    const std::vector<RecordedBuilding>& buildings, const std::vector<SentWalker>& walkers,
    const LegRule& rule, const ComparisonSettings& settings,
    const ComparisonProgress& progress = {});

/// The three test scenes of the thesis, walked by every model and by the thesis's own navigation.
/// `spacing` of the normalised distances, metres.
std::vector<SceneLikeness> compareInScenes(double spacing, unsigned threads);

/// For the console; one row per set, walker and table and one per walker and table over all; and
/// `forewalk.likeness/1`.
std::string toText(const Likeness& likeness);
std::string toCsv(const Likeness& likeness);
std::string toJson(const Likeness& likeness);
/// All paths, to be drawn or compared elsewhere (as readPaths reads them): `walker_id,x,z`.
std::string toPathsCsv(const Likeness& likeness);
/// SVG of one building: all legs and what walked in their place, over its floor.
std::string likenessPlan(const Likeness& likeness, std::size_t building,
                         const navmesh::NavGraph& floor);
/// SVG of one scene: its boxes and everybody's path.
std::string scenePlan(const SceneLikeness& scene);

}  // namespace forewalk::service
