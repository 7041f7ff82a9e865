#include "service/path_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "agents/evaluation/dtw.h"
#include "tests/support/xml_fault.h"

namespace forewalk::service {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A walk of `metres` to the east, bent to the side by `bend`.
ComparedPath walk(const std::string& file, const std::string& walker, double bend,
                  double metres = 4.0, int samples = 60) {
  ComparedPath path{file + ":" + walker, file + ".csv", file, walker, {}};
  for (int i = 0; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    path.points.push_back({metres * share, bend * std::sin(3.14159 * share)});
  }
  return path;
}

std::vector<ComparedPath> twoFiles() {
  return {walk("people", "ann", 0.1), walk("people", "bob", 0.2),  walk("people", "cyd", 0.35),
          walk("people", "dee", 0.4), walk("agents", "ann", -1.0), walk("agents", "eve", -1.3)};
}

std::string refusal(const std::vector<ComparedPath>& paths, const GroupMentions& mentions) {
  const auto groups = groupPaths(paths, mentions);
  return groups ? "accepted" : groups.error().message;
}

PathComparison compared(const std::vector<ComparedPath>& paths,
                        const ComparisonSettings& settings = {}) {
  return comparePaths(paths, *groupPaths(paths, {}), *tablesOf(paths, settings), settings);
}

TEST(GroupPaths, TakesFilesAsGroupsWhereNothingIsSaid) {
  const auto groups = groupPaths(twoFiles(), {});
  ASSERT_TRUE(groups);
  ASSERT_EQ(groups->size(), 2u);
  EXPECT_EQ((*groups)[0].name, "people");
  EXPECT_THAT((*groups)[0].paths, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ((*groups)[1].name, "agents");
  EXPECT_THAT((*groups)[1].paths, ElementsAre(4, 5));
}

TEST(GroupPaths, KnowsAModelByItsName) {
  std::vector<ComparedPath> rows;
  for (const char* name : {"H1", "H2", "MODEL"}) rows.push_back({name, {}, {}, {}, {}});
  const auto groups = groupPaths(rows, {});
  ASSERT_TRUE(groups);
  ASSERT_EQ(groups->size(), 2u);
  EXPECT_EQ((*groups)[1].name, "model");
  EXPECT_THAT((*groups)[1].paths, ElementsAre(2));
  rows.pop_back();
  EXPECT_EQ(groupPaths(rows, {})->size(), 1u);  // people alone
}

TEST(GroupPaths, FindsPathsFilesAndWalkers) {
  const auto groups = groupPaths(twoFiles(), {{"agents.csv"}, {{"odd", {"people:ann", "bob"}}}});
  ASSERT_TRUE(groups) << groups.error().message;
  ASSERT_EQ(groups->size(), 3u);
  EXPECT_THAT((*groups)[0].paths, ElementsAre(2, 3));
  EXPECT_THAT((*groups)[1].paths, ElementsAre(4, 5));
  EXPECT_EQ((*groups)[2].name, "odd");
  EXPECT_THAT((*groups)[2].paths, ElementsAre(0, 1));
  // A label will do for a file, and saying it twice does no harm.
  EXPECT_THAT((*groupPaths(twoFiles(), {{"agents", "eve"}, {}}))[1].paths, ElementsAre(4, 5));
}

TEST(GroupPaths, RefusesWhatItCannotMean) {
  EXPECT_THAT(refusal(twoFiles(), {{"zoe"}, {}}), HasSubstr("\"zoe\" is no path, file or walker"));
  EXPECT_THAT(refusal(twoFiles(), {{"ann"}, {}}),
              HasSubstr("\"ann\" walks in 2 files; say which, as in \"people:ann\""));
  EXPECT_THAT(refusal(twoFiles(), {{"eve"}, {{"odd", {"agents"}}}}),
              HasSubstr("\"agents:eve\" is put in two groups, \"model\" and \"odd\""));
  EXPECT_THAT(refusal(twoFiles(), {{"eve"}, {{"model", {"bob"}}}}),
              HasSubstr("two groups are named"));
  EXPECT_THAT(refusal(twoFiles(), {{"people", "agents:ann"}, {}}),
              HasSubstr("1 of 6 paths are left as people"));
}

TEST(TablesOf, HoldTheDistancesWhateverTheThreads) {
  const std::vector<ComparedPath> paths = twoFiles();
  ComparisonSettings settings;
  std::size_t last = 0, all = 0;
  settings.threads = 1;
  const auto tables = tablesOf(paths, settings, [&](std::size_t done, std::size_t total) {
    EXPECT_GT(done, last);
    last = done;
    all = total;
  });
  ASSERT_TRUE(tables);
  EXPECT_EQ(last, all);
  ASSERT_EQ(tables->size(), 2u);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t j = 0; j < paths.size(); ++j) {
      EXPECT_EQ((*tables)[0].table.at(i, j), agents::dtw(paths[i].points, paths[j].points));
      EXPECT_EQ((*tables)[1].table.at(i, j),
                agents::normalisedDtw(paths[i].points, paths[j].points, 0.1));
    }
  }
  settings.threads = 4;
  const auto threaded = tablesOf(paths, settings);
  for (std::size_t t = 0; t < 2; ++t) {
    EXPECT_EQ((*threaded)[t].table.distances, (*tables)[t].table.distances);
  }
  settings.raw = false;
  EXPECT_EQ(tablesOf(paths, settings)->size(), 1u);
}

TEST(TablesOf, RefusesMorePointsThanAnyoneWaitsFor) {
  std::vector<ComparedPath> paths{walk("a", "u", 0.0), walk("a", "v", 0.0, 90'000.0)};
  ComparisonSettings settings;
  settings.spacing = 0.01;
  const auto tables = tablesOf(paths, settings);
  ASSERT_FALSE(tables);
  EXPECT_THAT(tables.error().message, HasSubstr("\"a:v\" is 90000 m long, more than 1e+06 points"));
}

TEST(ComparePaths, SeesWhoWalksLikeWhom) {
  const PathComparison apart = compared(twoFiles());
  for (const TableComparison& table : apart.tables) {
    EXPECT_EQ(table.separations[0].superiority, 1.0) << table.name;
    EXPECT_DOUBLE_EQ(table.separations[0].p, 1.0 / 15.0);  // two of six: 15 labellings
    ASSERT_TRUE(table.groups);
    EXPECT_LT(table.groups->anova.test.p, 0.01);
    EXPECT_LT(table.groups->tukey[0].difference, 0.0);  // people are nearer to people
  }
  // The normalised form does not see that one group was recorded at ten times the rate.
  std::vector<ComparedPath> dense = twoFiles();
  dense[4] = walk("agents", "ann", -1.0, 4.0, 600);
  dense[5] = walk("agents", "eve", -1.3, 4.0, 600);
  const PathComparison quick = compared(dense);
  EXPECT_NEAR(quick.tables[1].meanToPeople[4], apart.tables[1].meanToPeople[4], 0.01);
  EXPECT_GT(quick.tables[0].meanToPeople[4], 5.0 * apart.tables[0].meanToPeople[4]);
}

TEST(PathReport, GivesTextCsvAndJsonOfTheSameNumbers) {
  const PathComparison comparison = compared(twoFiles());
  const TableComparison& raw = comparison.tables.front();
  const std::string text = toText(comparison);
  EXPECT_THAT(text, HasSubstr("6 paths: 4 of people, 2 of agents"));
  EXPECT_THAT(text, HasSubstr("exceeds one within: 1.000"));
  EXPECT_THAT(text, HasSubstr("all 15 labellings"));

  const json report = json::parse(toJson(comparison));
  EXPECT_EQ(report["format"], "forewalk.paths/1");
  EXPECT_EQ(report["analyses"].size(), 2u);
  EXPECT_EQ(report["analyses"][0]["columns"]["welch"]["statistic"], raw.columns.welch.statistic);
  EXPECT_EQ(report["analyses"][0]["groups"]["tukey"][0]["first"], "people");
  EXPECT_EQ(report["walks"][4]["samples"], 61);

  const std::string csv = toCsv(comparison);
  std::size_t rows = 0;
  for (std::size_t begin = 0; begin < csv.size(); ++rows) {
    const std::size_t end = csv.find('\n', begin);
    EXPECT_EQ(std::count(csv.begin() + static_cast<long>(begin),
                         csv.begin() + static_cast<long>(end), ','),
              12)
        << csv.substr(begin, end - begin);
    begin = end + 1;
  }
  // A table: 2 of separation, 5 tests and 2 x 1 pairs of groups, 5 tests and 2 x 15 pairs of
  // columns.
  EXPECT_EQ(rows, 1 + 2 * (2 + 5 + 2 + 5 + 30));
  const std::string distances = toDistancesCsv(comparison);
  EXPECT_EQ(std::count(distances.begin(), distances.end(), '\n'), 1 + 2 * 15);
}

TEST(PathReport, IsATableThatIsReadBack) {
  const PathComparison comparison = compared(twoFiles());
  const std::string text = toJson(comparison);
  const auto tables = parsePathTables(std::as_bytes(std::span(text)), "back.json");
  ASSERT_TRUE(tables) << tables.error().message;
  ASSERT_EQ(tables->tables.size(), 2u);
  EXPECT_EQ(tables->tables[0].name, "normalised");
  EXPECT_EQ(tables->tables[1].table.distances, comparison.tables[0].table.distances);
  EXPECT_EQ(tables->paths[5], "agents:eve");
}

TEST(PathReport, SurvivesPathsThatAreAllTheSame) {
  std::vector<ComparedPath> paths{walk("a", "u", 0.2), walk("a", "v", 0.2), walk("b", "u", 0.2),
                                  walk("b", "v", 0.2)};
  const PathComparison comparison = compared(paths);
  EXPECT_EQ(comparison.tables[0].separations[0].p, 1.0);
  EXPECT_THAT(toText(comparison), HasSubstr("p = -"));
  EXPECT_TRUE(json::parse(toJson(comparison))["analyses"][0]["columns"]["welch"]["p"].is_null());
  EXPECT_THAT(toCsv(comparison), ::testing::Not(HasSubstr("nan")));
}

TEST(PathPlan, IsADrawingOfAllPathsWhateverTheirNames) {
  std::vector<ComparedPath> paths = twoFiles();
  paths[1].walker = "<bob> & \"co\"";
  for (glm::dvec2& point : paths[2].points) point = {1.0, 1.0};  // stands still
  const std::string svg = pathPlan(compared(paths));
  EXPECT_EQ(testing::faultOf(svg), "");
  EXPECT_THAT(svg, HasSubstr("&lt;bob&gt;"));
  EXPECT_THAT(svg, HasSubstr("4 of people, 2 of agents"));
  EXPECT_EQ(svg, pathPlan(compared(paths)));
}

}  // namespace
}  // namespace forewalk::service
