// How like people do simulated walkers walk? Paths compared pairwise and in groups; as text, CSV,
// JSON and a plan.
//
// The statistics are those of agents/evaluation; here they are run on what a person named.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "agents/evaluation/one_way.h"
#include "agents/evaluation/post_hoc.h"
#include "agents/evaluation/separation.h"
#include "navmesh/error.h"
#include "navmesh/nav_graph.h"
#include "service/path_tables.h"

namespace forewalk::service {

/// A path as it was read.
struct ComparedPath {
  std::string name;    ///< "u3", or "people:u3" where several files are compared
  std::string file;    ///< as it was given; empty for a row of a table
  std::string label;   ///< the file without folder and ending, where that tells files apart
  std::string walker;  ///< its id in the file
  std::vector<glm::dvec2> points;  ///< plan, metres; empty for a row of a table
};

/// `paths` of one CSV file each in order, named so that no name is there twice. Files as parseWalks
/// reads them, a column `t` may be missing. Fails as parseWalks and readFile do, and (kTooLarge)
/// above kMostPaths.
[[nodiscard]] tl::expected<std::vector<ComparedPath>, Error> readPaths(
    const std::vector<std::string>& files);

/// What a person says about who belongs together. A mention is a path's name, a file (as given, or
/// its label), or a walker's id; the first kind that fits is taken.
struct GroupMentions {
  std::vector<std::string> model;  ///< makes a group "model"
  struct Group {
    std::string name;
    std::vector<std::string> members;
  };
  std::vector<Group> groups;
};

struct PathGroup {
  std::string name;
  std::vector<std::size_t> paths;  ///< ascending
};

/// Groups of paths; the first are the people, with two paths or more. Whoever is not mentioned is
/// one of them. Without any mention a path or walker called "model" (in any case) is the model;
/// without that each file is a group, and the first file holds the people.
///
/// Fails (kSettingOutOfRange) where a mention fits nothing or walkers of several files, where a
/// path is in two groups, a group is named twice, and where fewer than two people are left.
[[nodiscard]] tl::expected<std::vector<PathGroup>, Error> groupPaths(
    const std::vector<ComparedPath>& paths, const GroupMentions& mentions);

/// All tests of a set of samples. A sample's index is its place in `groups` or in the table's
/// columns.
struct OneWayTests {
  agents::Anova anova;
  agents::FTest levene, leveneMedian, welch, brownForsythe;
  std::vector<agents::PairDifference> tukey, gamesHowell;
};

/// One table, with everything that is said about it.
struct TableComparison {
  std::string name;
  std::string unit;  ///< "m", "m x samples", or empty where a file does not say
  agents::DistanceTable table;
  std::vector<double> meanToPeople;             ///< of every path, to the people other than itself
  std::vector<agents::Separation> separations;  ///< of every group but the people, in order
  OneWayTests columns;                          ///< a sample per path, as in Ono's thesis
  std::vector<std::size_t> tested;              ///< groups of two paths or more ...
  std::optional<OneWayTests>
      groups;  ///< ... where there are two: a sample per group, of meanToPeople
};

struct PathComparison {
  std::vector<ComparedPath> paths;
  std::vector<PathGroup> groups;  ///< the first are the people
  std::vector<TableComparison> tables;
  double spacing = 0.0;  ///< of the normalised table, metres; 0 where there is none
  double confidence = 0.95;
};

struct ComparisonSettings {
  bool raw = true, normalised = true;  ///< which tables to make of paths
  double spacing = 0.1;                ///< metres between samples of the normalised one
  double confidence = 0.95;            ///< of intervals
  agents::SeparationSettings separation;
  unsigned threads = 0;  ///< 0: all cores
};

/// Told how many cells of all warping tables are done, one call at a time, from any thread.
using ComparisonProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Tables of the distances between all paths: "raw" and "normalised", as settings say. Fails
/// (kSettingOutOfRange) where a path has more than a million points at `spacing`. The result does
/// not depend on the number of threads. Costs O(a * b) for paths of a and b samples, about 1.3 ns
/// each.
[[nodiscard]] tl::expected<std::vector<NamedTable>, Error> tablesOf(
    const std::vector<ComparedPath>& paths, const ComparisonSettings& settings,
    const ComparisonProgress& progress = {});

/// All tests of all tables.
PathComparison comparePaths(std::vector<ComparedPath> paths, std::vector<PathGroup> groups,
                            std::vector<NamedTable> tables, const ComparisonSettings& settings);

/// For the console.
std::string toText(const PathComparison& comparison);
/// One row per test, pair and group; statistics with all digits.
std::string toCsv(const PathComparison& comparison);
/// One row per pair of paths and table.
std::string toDistancesCsv(const PathComparison& comparison);
/// `forewalk.paths/1`; parsePathTables reads its tables back.
std::string toJson(const PathComparison& comparison);
/// What a plan of paths says and shows beside them.
struct PathPlanFrame {
  std::string title = "Paths";
  std::string subtitle;                             ///< empty: how many paths of whom
  const navmesh::NavGraph* floor = nullptr;         ///< drawn under all, if there is one
  std::vector<std::vector<glm::dvec2>> outlines{};  ///< closed, plan, metres: what stands about,
                                                    ///< places that have a meaning
};

/// SVG: all paths from above, people in greys, groups of models in colours. Needs paths with
/// points.
std::string pathPlan(const PathComparison& comparison, const PathPlanFrame& frame = {});

}  // namespace forewalk::service
