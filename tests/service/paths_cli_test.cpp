// forewalk paths as a person meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program_test.h"

namespace {

using forewalk::testing::Outcome;
using nlohmann::json;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class PathsCli : public forewalk::testing::ProgramTest {
 protected:
  PathsCli() {
    fs::create_directories(folder_ / "other");
    std::string people = "walker_id,t,x,z\n", agents = "walker_id,x,z\n", one = "z,x\n";
    for (int i = 0; i <= 50; ++i) {
      const double x = 0.1 * i;
      const auto at = [&](double z) { return std::to_string(x) + "," + std::to_string(z) + "\n"; };
      for (int who = 0; who < 4; ++who) {
        people += "u" + std::to_string(who) + "," + std::to_string(0.1 * i) + "," +
                  at(0.05 * who + 0.01 * who * i);
      }
      agents += "a," + at(0.03 * i * i / 10.0) + "b," + at(0.04 * i * i / 10.0);
      one += std::to_string(0.5) + "," + std::to_string(x) + "\n";
    }
    write("people.csv", people);
    write("agents.csv", agents);
    write("one.csv", one);
    write("other/people.csv", people);
  }
};

TEST_F(PathsCli, ComparesFilesAndWritesWhatItSays) {
  const Outcome outcome = run("paths people.csv agents.csv one.csv --out out/p");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("7 paths: 4 of people, 2 of agents, 1 of one"));
  EXPECT_THAT(outcome.out,
              HasSubstr("Wrote out/p.csv, out/p-distances.csv, out/p.json and out/p.svg"));
  const json report = json::parse(contents("out/p.json"));
  EXPECT_EQ(report["paths"], (json{"people:u0", "people:u1", "people:u2", "people:u3", "agents:a",
                                   "agents:b", "one"}));
  EXPECT_EQ(report["raw"].size(), 7u);
  EXPECT_THAT(contents("out/p.svg"), HasSubstr("</svg>"));
  EXPECT_THAT(contents("out/p.csv"),
              HasSubstr("\"normalised\",groups,tukey,\"people\",\"agents\""));

  // The same bytes on any number of threads, and the distances are a table for the next call.
  ASSERT_EQ(run("paths people.csv agents.csv one.csv --threads 3 --out again").status, 0);
  EXPECT_EQ(contents("again.json"), contents("out/p.json"));
  const Outcome table = run("paths --table out/p.json --model agents:a --out back");
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("7 paths: 6 of people, 1 of model"));
  EXPECT_EQ(json::parse(contents("back.json"))["raw"], report["raw"]);
  EXPECT_FALSE(fs::exists(folder_ / "back.svg"));
}

TEST_F(PathsCli, TellsFilesOfOneNameApart) {
  const Outcome outcome = run("paths people.csv other/people.csv --form normalised");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 of people, 4 of other/people"));
  EXPECT_THAT(outcome.out, HasSubstr("other/people:u3"));
}

TEST_F(PathsCli, TakesAModelAndGroups) {
  const Outcome outcome =
      run("paths people.csv agents.csv --model agents.csv --group odd=people:u3 --group more=u2,u1 "
          "--form raw --confidence 0.9");
  EXPECT_EQ(outcome.status, 1);  // one person is left
  EXPECT_THAT(outcome.err, HasSubstr("1 of 6 paths are left as people"));
  const Outcome fewer = run("paths people.csv agents.csv --model agents --group odd=u3 --form raw");
  ASSERT_EQ(fewer.status, 0) << fewer.err;
  EXPECT_THAT(fewer.out, HasSubstr("3 of people, 2 of model, 1 of odd"));
}

TEST_F(PathsCli, RefusesInOneLineWhatItCannotUse) {
  refuses("paths", 2, "give files of paths, --table with their distances, or --building");
  refuses("paths people.csv --building house.obj=people.csv", 2, "leave out paths");
  refuses("paths --building people.csv", 2, "is not SCENE=WALKS");
  refuses("paths --people 5 people.csv", 2, "--people requires --building");
  refuses("paths people.csv --table t.json", 2, "exclude each other");
  refuses("paths --table t.json --form raw", 2, "have no effect");
  refuses("paths people.csv --scene s.obj", 2, "--out");
  refuses("paths people.csv --form cooked", 2, "cooked");
  refuses("paths people.csv --spacing 0", 2, "--spacing");
  refuses("paths people.csv --group odd", 2, "NAME=WHO");
  refuses("paths people.csv --group odd=u1,,u2", 2, "NAME=WHO");
  refuses("paths people.csv --group =u1", 2, "NAME=WHO");
  refuses("paths people.csv --threads -1", 2, "--threads");
  refuses("paths nowhere.csv", 1, "nowhere.csv");
  refuses("paths --table nowhere.json", 1, "nowhere.json");
  refuses("paths people.csv people.csv", 1, "people.csv is given twice");
  refuses("paths one.csv", 1, "1 of 1 paths are left as people");
  refuses("paths people.csv --model zoe", 1, "\"zoe\" is no path, file or walker here");
  refuses("paths people.csv other/people.csv --model u1", 1, "walks in 2 files");
  refuses("paths people.csv --scene nowhere.obj --out o", 1, "nowhere.obj");
  write("bad.csv", "x,z\n0,0\n1,fence\n");
  refuses("paths bad.csv people.csv", 1, "bad.csv:3: z is \"fence\"");
  write("columns.csv", "a,b\n0,0\n");
  refuses("paths columns.csv", 1, "walker_id,t,x,z or x,z");
  write("bad.json", R"({"paths": ["a", "b"], "t": [[0, 1], [2, 0]]})");
  refuses("paths --table bad.json", 1, "bad.json: table \"t\": row 2, column 1 is 2");
}

TEST_F(PathsCli, GivesThePublishedValuesFromThePublishedTables) {
  const fs::path file = fs::path(FOREWALK_SHARED_DATA) / ".." / "reference" / "thesis_dtw.json";
  if (!fs::exists(file)) GTEST_SKIP() << "the thesis' tables are not here: " << file;
  const Outcome outcome = run("paths --table '" + file.string() + "' --out thesis");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* printed :
       {"11 paths: 10 of people, 1 of model",
        "between groups: sum of squares 14071475.08, within: 24912178.16",
        "ANOVA            F(10, 110.000) = 6.213", "Welch            F(10, 43.962) = 4.403",
        "Brown-Forsythe   F(10, 104.415) = 6.213", "Levene, means    F(10, 110.000) = 0.101",
        "+-667.11", "+-975.57", "+-1161.39", "p = 0.023 (Mann-Whitney)", "p = 0.045 (Mann-Whitney)",
        "p = 0.28"}) {
    EXPECT_THAT(outcome.out, HasSubstr(printed));
  }
  EXPECT_EQ(json::parse(contents("thesis.json"))["analyses"].size(), 3u);
}

TEST_F(PathsCli, ReadsRecordedWalks) {
  const fs::path walks = fs::path(FOREWALK_SHARED_DATA) / "walks" / "searching-a";
  if (!fs::exists(walks)) GTEST_SKIP() << "the recorded walks are not here: " << walks;
  const Outcome outcome =
      run("paths '" + (walks / "walks.csv").string() + "' --model u5 --scene '" +
          (walks / "scene.obj").string() + "' --form normalised --out a");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("6 paths: 5 of people, 1 of model"));
  const json report = json::parse(contents("a.json"));
  EXPECT_GT(report["walks"][0]["length"], 50.0);
  EXPECT_EQ(report["analyses"][0]["separation"][0]["labellings"], 6);
}

// Sends the models on the errands of the recorded people of both buildings.
TEST_F(PathsCli, WalksInRecordedPeoplesPlace) {
  const fs::path walks = fs::path(FOREWALK_SHARED_DATA) / "walks";
  if (!fs::exists(walks)) GTEST_SKIP() << "the recorded walks are not here: " << walks;
  std::string buildings;
  for (const char* name : {"searching-a", "searching-b"}) {
    buildings += " --building '" + (walks / name / "scene.obj").string() + "=" +
                 (walks / name / "walks.csv").string() + "'";
  }
  const Outcome outcome = run("paths" + buildings + " --out like");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("searching-b: 6 walks"));
  EXPECT_THAT(outcome.out, HasSubstr("test 3, 20 objects"));
  const json report = json::parse(contents("like.json"));
  EXPECT_GT(report["sets"].size(), 8u);
  ASSERT_EQ(report["walkers"].size(), 6u);
  EXPECT_EQ(report["walkers"][0]["name"], "taut path");
  EXPECT_EQ(report["walkers"][0]["arrived"], report["walkers"][0]["legs"]);
  EXPECT_NEAR(report["walkers"][0]["detour"], 1.0, 1e-3);
  EXPECT_EQ(report["walkers"][1]["normalised"]["labellings"], 4096);
  for (const char* plan : {"like-searching-a.svg", "like-searching-b.svg",
                           "like-test-1-8-objects.svg", "like-test-3-20-objects.svg"}) {
    EXPECT_THAT(contents(plan), HasSubstr("</svg>"));
  }
}

}  // namespace
