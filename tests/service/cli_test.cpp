// The forewalk program as a person or a script meets it: exit status, one line on stderr where it
// refuses, and outputs that keep their schemas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program_test.h"

namespace {

using forewalk::testing::expectRefusal;
using forewalk::testing::Outcome;
using forewalk::testing::writeTo;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class Cli : public forewalk::testing::ProgramTest {
 protected:
  Cli() {
    // Two rooms of 4 m x 4 m and a corridor of 6 m x 2 m between them, on one floor.
    writeTo(folder_ / "rooms.obj",
            "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nf 4 3 2 1\n"
            "v 4 0 1\nv 10 0 1\nv 10 0 3\nv 4 0 3\nf 8 7 6 5\n"
            "v 10 0 0\nv 14 0 0\nv 14 0 4\nv 10 0 4\nf 12 11 10 9\n");
  }
};

std::vector<std::vector<std::string>> csvOf(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST_F(Cli, CrowdWalksAFileAndRefusesAWrongOne) {
  writeTo(folder_ / "c.json",
          R"({"format": "forewalk.crowd/1", "scene": "rooms.obj", "seconds": 60, "groups": [
              {"count": 3, "start": {"area": [0.5, 0.5, 3, 3.5]}, "goal": {"points": [[12, 2]]}},
              {"start": {"points": [[12, 1]]}, "goal": {"points": [[2, 2]]}, "model": "hrvo"}]})");
  const Outcome walked =
      run("crowd c.json --metrics m.json --trajectories t.csv --sqlite t.sqlite --plan p.svg "
          "--animation a.svg");
  ASSERT_EQ(walked.status, 0) << walked.err;
  EXPECT_THAT(walked.out, HasSubstr("4 agents (0 human)"));
  const json metrics = json::parse(contents("m.json"));
  EXPECT_EQ(metrics.at("format"), "forewalk.crowd_metrics/1");
  EXPECT_EQ(metrics.at("with_goal"), 4);
  EXPECT_EQ(metrics.at("walls_entered"), 0);
  EXPECT_THAT(contents("t.csv"), StartsWith("walker_id,t,x,z"));
  EXPECT_THAT(contents("t.sqlite"), StartsWith("SQLite format 3"));
  EXPECT_THAT(contents("a.svg"), HasSubstr("<animateTransform"));
  // The same again, on two threads.
  EXPECT_EQ(run("crowd c.json --threads 2 --metrics -").out, contents("m.json"));

  writeTo(folder_ / "wrong.json",
          R"({"format": "forewalk.crowd/1", "scene": "rooms.obj", "groups": [
              {"name": "far", "start": {"points": [[50, 50]]}}]})");
  expectRefusal(run("crowd wrong.json"), 1, "groups[0] \"far\"");
  expectRefusal(run("crowd none.json"), 1, "none.json");
  expectRefusal(run("crowd c.json --model orka"), 2, "--model");
  expectRefusal(run("crowd c.json --diagram d.svg"), 1, "measure");
  expectRefusal(run("crowd c.json --sqlite -"), 2, "--sqlite");
}

TEST_F(Cli, NamesItsVerbsWhereNoneIsGiven) {
  expectRefusal(run(""), 2, "build, predict, sweep, simulate");
  expectRefusal(run("fly"), 2, "fly");
  expectRefusal(run("--no-such-flag"), 2, "--help");
}

TEST_F(Cli, TellsItsVersion) {
  const Outcome outcome = run("--version");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, StartsWith("forewalk "));
}

TEST_F(Cli, DrawsDistancesOnlyInPlans) {
  expectRefusal(run("predict rooms.obj --at 2,0,2 --distances"), 2, "--format svg");
  for (const char* method : {"polygon", "front"}) {
    const std::string predict = "predict rooms.obj --at 2,0,2 --format svg --method ";
    const Outcome with = run(predict + method + " --distances"), without = run(predict + method);
    EXPECT_EQ(with.status, 0) << with.err;
    EXPECT_THAT(with.out, HasSubstr("walking distance"));
    EXPECT_THAT(without.out, ::testing::Not(HasSubstr("walking distance")));
  }
}

TEST_F(Cli, AnimatesARecordedOrASimulatedWalk) {
  writeTo(folder_ / "walks.csv", "walker_id,t,x,z\nann,0,1,2\nann,9,9,2\nbob,0,12,2\nbob,8,4,2\n");
  const Outcome recorded = run("animate rooms.obj walks.csv --walker bob --seconds 4 --out -");
  EXPECT_EQ(recorded.status, 0) << recorded.err;
  EXPECT_THAT(recorded.out, HasSubstr("walker bob"));
  EXPECT_THAT(recorded.out, HasSubstr("<animateTransform"));
  const std::string simulated = "animate rooms.obj --seed 3 --seconds 3 --out -";
  EXPECT_THAT(run(simulated).out, HasSubstr("a simulated walk"));
  EXPECT_EQ(run(simulated).out, run(simulated).out);
  expectRefusal(run("animate rooms.obj walks.csv --walker eve --out -"), 1, "ann, bob");
  expectRefusal(run("animate rooms.obj walks.csv --from 60 --out -"), 1, "lasts 9.0 s");
  expectRefusal(run("animate rooms.obj --walker ann --out -"), 2, "WALKS");
  expectRefusal(run("animate rooms.obj"), 2, "--out");
}

TEST_F(Cli, ExplainsEveryVerbWithAnExample) {
  EXPECT_EQ(run("--help").status, 0);
  for (const std::string verb : {"build", "predict", "sweep", "simulate", "animate", "demo"}) {
    const Outcome outcome = run(verb + " --help");
    EXPECT_EQ(outcome.status, 0) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("Example")) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("forewalk " + verb)) << verb;
    EXPECT_EQ(outcome.err, "") << verb;
  }
}

TEST_F(Cli, RefusesWrongUsageOfEveryVerbInOneLine) {
  expectRefusal(run("build"), 2, "forewalk build --help");
  expectRefusal(run("build rooms.obj"), 2, "--out");
  expectRefusal(run("build rooms.obj --out a.fwmesh --radius wide"), 2, "wide");
  expectRefusal(run("build rooms.obj --out a.fwmesh --partition magic"), 2, "magic");
  expectRefusal(run("predict rooms.obj"), 2, "--at");
  expectRefusal(run("predict rooms.obj --at 1,2"), 2, "\"1,2\" is no position");
  expectRefusal(run("predict rooms.obj --at 1,nan,2"), 2, "is no position");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --horizon -3"), 2, "-3 m");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --format png"), 2, "png");
  expectRefusal(run("sweep rooms.obj --horizons 40:5:5"), 2, "40:5:5");
  expectRefusal(run("sweep rooms.obj --horizons 1:1e30:1"), 2, "1000 steps");
  expectRefusal(run("sweep rooms.obj --starts 0"), 2, "--starts");
  expectRefusal(run("simulate"), 2, "CONFIG");
  expectRefusal(run("demo --metres -5"), 2, "--metres");
}

TEST_F(Cli, SaysWhatWasTypedAndNotHowItIsParsed) {
  expectRefusal(run("fly"), 2, "there is no verb \"fly\"");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --speed 3"), 2, "there is no option --speed");
  expectRefusal(run("predict rooms.obj --at 2 0 2"), 2, "\"0\" is one word too many");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --horizon ten"), 2, "\"ten\" is no number");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --horizon"), 2, "--horizon needs a value");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --at 3,0,2"), 2, "--at is given 2 times");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --horizon nan"), 2, "nan m is out of range");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --heading-deg nan"), 2, "nan is no number");
  expectRefusal(run("predict '' --at 2,0,2"), 2, "SCENE: the name is empty");
  expectRefusal(run("sweep rooms.obj --seed -1"), 2, "\"-1\" is no whole number");
  expectRefusal(run("sweep rooms.obj --seed 99999999999999999999"), 2, "64 bits");
  expectRefusal(run("sweep rooms.obj --horizons 5,20000"), 2, "20000 m is out of range");
  expectRefusal(run("sweep rooms.obj --out sub/"), 2, "\"sub/\" ends in no name");
  expectRefusal(run("build rooms.obj --corners -1 --out a.fwmesh"), 2, "\"-1\" is no whole number");
  expectRefusal(run("demo --metres nan"), 2, "nan is out of range");
}

TEST_F(Cli, NamesTheOptionOfASettingThatCannotWork) {
  for (const std::string setting :
       {"--radius -1", "--height 0", "--climb -1", "--slope-deg 95", "--slope-deg nan", "--cell 0",
        "--cell 1e-9", "--cell-height nan", "--region-min -1", "--region-merge -1", "--edge-max -1",
        "--edge-error nan", "--detail-sample -1", "--detail-error -1", "--corners 9", "--tile -3",
        "--tile 0.01", "--unit 0"}) {
    SCOPED_TRACE(setting);
    const std::string option = setting.substr(0, setting.find(' '));
    expectRefusal(run("build rooms.obj --out a.fwmesh " + setting), 1, option + " is ");
  }
}

TEST_F(Cli, WritesNothingUnderANameThatSaysSomethingElse) {
  const std::string scene = contents("rooms.obj");
  expectRefusal(run("build rooms.obj --out rooms.obj"), 2, ".fwmesh");
  EXPECT_EQ(contents("rooms.obj"), scene);
  expectRefusal(run("predict rooms.obj --at 2,0,2 --out plan.png"), 2, "--format");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --format SVG"), 2, "svg");
  ASSERT_EQ(run("predict rooms.obj --at 2,0,2 --format svg --out plan.txt").status, 0);
  ASSERT_EQ(run("predict rooms.obj --at 2,0,2 --out plan.SVG").status, 0);
  EXPECT_THAT(contents("plan.SVG"), HasSubstr("</svg>"));
  EXPECT_EQ(contents("plan.SVG"), contents("plan.txt"));
  expectRefusal(run("build rooms.obj --out - --dump -"), 2, "both stdout");
  expectRefusal(run("simulate walk.json --trace - --summary -"), 2, "both stdout");
}

TEST_F(Cli, FindsOutBeforeTheWorkThatItCannotBeSaved) {
  writeTo(folder_ / "file", "");
  // The scenes are missing as well, but what cannot be written is said first.
  expectRefusal(run("build missing.obj --out file/a.fwmesh"), 1, "file/a.fwmesh");
  expectRefusal(run("build missing.obj --out a.fwmesh --dump file/a.json"), 1, "file/a.json");
  expectRefusal(run("predict missing.obj --at 2,0,2 --out file/a.svg"), 1, "file/a.svg");
  expectRefusal(run("sweep missing.obj --out file/a"), 1, "file/a.csv");
  expectRefusal(run("simulate missing.json --trace file/t.csv"), 1, "file/t.csv");
  expectRefusal(run("simulate missing.json --summary file/s.json"), 1, "file/s.json");
  expectRefusal(run("demo --scene missing.obj --out file/out"), 1, "file/out");
  EXPECT_FALSE(fs::exists(folder_ / "a.fwmesh"));
  // And finding out leaves what is there as it is.
  writeTo(folder_ / "kept.fwmesh", "kept");
  expectRefusal(run("build missing.obj --out kept.fwmesh"), 1, "missing.obj");
  EXPECT_EQ(contents("kept.fwmesh"), "kept");
}

TEST_F(Cli, RefusesScenesThatCannotBeRead) {
  writeTo(folder_ / "empty.obj", "");
  writeTo(folder_ / "broken.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 9\n");
  writeTo(folder_ / "picture.png", "not a scene");
  writeTo(folder_ / "damaged.fwmesh", "FWME");
  writeTo(folder_ / "damaged.bin", "TESM");
  for (const std::string verb : {"build %s --out a.fwmesh", "predict %s --at 2,0,2", "sweep %s"}) {
    for (const std::string scene : {"missing.obj", "empty.obj", "broken.obj", "picture.png",
                                    "damaged.fwmesh", "damaged.bin", "."}) {
      std::string arguments = verb;
      arguments.replace(arguments.find("%s"), 2, scene);
      SCOPED_TRACE(arguments);
      expectRefusal(run(arguments), 1, scene);
    }
  }
  EXPECT_FALSE(fs::exists(folder_ / "a.fwmesh"));
}

TEST_F(Cli, RefusesOutputsThatCannotBeWritten) {
  writeTo(folder_ / "file", "");
  expectRefusal(run("build rooms.obj --out file/a.fwmesh"), 1, "file/a.fwmesh");
  expectRefusal(run("predict rooms.obj --at 2,0,2 --out ."), 1, "cannot be written");
}

TEST_F(Cli, BuildsANavmeshThatOtherVerbsTake) {
  const Outcome built = run("build rooms.obj --out a.fwmesh --dump a.json");
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_EQ(built.err, "") << "no progress bar where stderr is no terminal";
  const json dump = json::parse(contents("a.json"));
  EXPECT_EQ(dump["format"], "forewalk.navmesh/1");
  EXPECT_FALSE(dump["polygons"].empty());
  const Outcome fromScene = run("predict rooms.obj --at 2,0,2 --out scene.json");
  const Outcome fromMesh = run("predict a.fwmesh --at 2,0,2 --out mesh.json");
  ASSERT_EQ(fromScene.status, 0) << fromScene.err;
  ASSERT_EQ(fromMesh.status, 0) << fromMesh.err;
  json scene = json::parse(contents("scene.json")), mesh = json::parse(contents("mesh.json"));
  scene.erase("stats");  // holds the time
  mesh.erase("stats");
  EXPECT_EQ(scene, mesh);
  expectRefusal(run("predict a.fwmesh --at 2,0,2 --radius 0.3"), 2, "built already");
}

TEST_F(Cli, BuildsTheSameBytesOnAnyNumberOfThreads) {
  ASSERT_EQ(run("build rooms.obj --tile 3.2 --threads 1 --out one.fwmesh").status, 0);
  ASSERT_EQ(run("build rooms.obj --tile 3.2 --threads 5 --out five.fwmesh").status, 0);
  EXPECT_FALSE(contents("one.fwmesh").empty());
  EXPECT_EQ(contents("one.fwmesh"), contents("five.fwmesh"));
}

TEST_F(Cli, SaysWhichSettingClosedTheScene) {
  expectRefusal(run("build rooms.obj --radius 2.5 --out a.fwmesh"), 1, "radius");
  expectRefusal(run("build rooms.obj --radius -1 --out a.fwmesh"), 1, "radius");
}

TEST_F(Cli, ReadsScenesInOtherUnitsAndAxes) {
  writeTo(folder_ / "cm.obj", "v 0 0 0\nv 400 0 0\nv 400 400 0\nv 0 400 0\nf 1 2 3 4\n");  // z up
  const Outcome outcome = run("predict cm.obj --unit 0.01 --up z --at 2,0,-2 --horizon 5");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(json::parse(outcome.out)["source"]["position"][2].get<double>(), -2.0, 1e-6);
}

TEST_F(Cli, PredictsInEveryFormat) {
  const std::string place = "predict rooms.obj --at 2,0,2 --heading-deg -90 --horizon 8 ";
  const Outcome dump = run(place + "--format json");
  ASSERT_EQ(dump.status, 0) << dump.err;
  const json graph = json::parse(dump.out);
  EXPECT_EQ(graph["format"], "forewalk.prediction/1");
  EXPECT_EQ(graph["horizon"], 8.0);
  EXPECT_EQ(graph["nodes"][0]["kind"], "source");
  EXPECT_GT(graph["stats"]["microseconds"].get<double>(), 0.0);
  EXPECT_THAT(run(place + "--format graphml").out, HasSubstr("</graphml>"));
  EXPECT_THAT(run(place + "--format dot").out, StartsWith("graph"));
  ASSERT_EQ(run(place + "--out sub/plan.svg").status, 0) << "the ending names the format";
  EXPECT_THAT(contents("sub/plan.svg"), HasSubstr("</svg>"));
}

TEST_F(Cli, LeadsThroughLinksByBothMethods) {
  // Two floors of 4 x 4 m with 6 m between them.
  writeTo(folder_ / "islands.obj",
          "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nf 4 3 2 1\n"
          "v 10 0 0\nv 14 0 0\nv 14 0 4\nv 10 0 4\nf 8 7 6 5\n");
  writeTo(folder_ / "links.json",
          R"({"format": "forewalk.links/1", "links": [{"id": 7, "entry": [3, 0, 2],
              "exit": [12, 0, 2], "length": 2.5}]})");
  for (const std::string method : {"polygon", "front"}) {
    const Outcome outcome =
        run("predict islands.obj --at 1,0,1 --horizon 20 --links links.json --method " + method);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json graph = json::parse(outcome.out);
    std::size_t through = 0;
    for (const json& edge : graph["edges"]) {
      if (!edge.contains("links")) continue;
      ++through;
      EXPECT_EQ(edge["links"][0]["id"], 7);
      EXPECT_EQ(edge["links"][0]["length"], 2.5);
      EXPECT_NEAR(edge["links"][0]["to"][0].get<double>(), 3.0, 1e-3) << "edges run backwards";
      EXPECT_NEAR(edge["links"][0]["from"][0].get<double>(), 12.0, 1e-3);
    }
    EXPECT_GE(through, 1u) << method;
    bool beyond = false;
    for (const json& node : graph["nodes"]) {
      beyond = beyond || node["position"][0].get<double>() > 10.0;
    }
    EXPECT_TRUE(beyond) << method;
  }
}

TEST_F(Cli, TakesNegativePositions) {
  writeTo(folder_ / "left.obj", "v -9 0 -9\nv -1 0 -9\nv -1 0 -1\nv -9 0 -1\nf 4 3 2 1\n");
  const Outcome outcome = run("predict left.obj --at -5,0,-5 --heading-deg -45");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Cli, NamesTheNearestWalkablePointForAPlaceBesideTheNavmesh) {
  const Outcome outcome = run("predict rooms.obj --at -1.75,0,2");
  expectRefusal(outcome, 1, "nearest walkable point is 2.");
  // What the message proposes works.
  const std::size_t at = outcome.err.find("Try ") + 4;
  const std::string proposed = outcome.err.substr(at, outcome.err.find_last_of('.') - at);
  EXPECT_EQ(run("predict rooms.obj --at " + proposed).status, 0) << proposed;
}

TEST_F(Cli, SweepsTheSameGraphsOnEveryRun) {
  const std::string sweep =
      "sweep rooms.obj --horizons 2:6:2 --starts 5 --repeats 2 --seed 3 --out ";
  const Outcome first = run(sweep + "a/first"), second = run(sweep + "second");
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(second.status, 0) << second.err;
  const auto one = csvOf(contents("a/first.csv")), other = csvOf(contents("second.csv"));
  ASSERT_EQ(one.size(), 4u) << "a header and three horizons";
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(one[0].begin(), one[0].end(), name) - one[0].begin());
  };
  for (const char* name :
       {"horizon_m", "mean_us", "median_us", "p99_us", "settled", "nodes", "hash"}) {
    ASSERT_LT(column(name), one[0].size()) << name;
  }
  for (std::size_t row = 1; row < one.size(); ++row) {
    EXPECT_EQ(one[row][column("hash")], other[row][column("hash")]);
    EXPECT_EQ(std::stod(one[row][column("horizon_m")]), 2.0 * static_cast<double>(row));
    EXPECT_LE(std::stod(one[row][column("median_us")]), std::stod(one[row][column("p99_us")]));
  }
  EXPECT_NE(one[1][column("hash")], one[2][column("hash")]);
  EXPECT_THAT(contents("second.svg"), HasSubstr("7.5 ms"));
}

TEST_F(Cli, SimulatesAndRecordsTheWalk) {
  writeTo(
      folder_ / "walk.json",
      R"({"format": "forewalk.simulation/1", "scene": "rooms.obj", "space": {"rectangle": [4, 4]},
              "limits": "laboratory", "controller": "s2c-predictive", "seed": 3,
              "stop": {"virtual_m": 12}, "user": {"kind": "wander"}})");
  const std::string simulate = "simulate walk.json --untimed --trace t.csv --summary s.json";
  const Outcome outcome = run(simulate);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string trace = contents("t.csv"), summary = contents("s.json");
  EXPECT_THAT(trace,
              StartsWith("t,virtual_x,virtual_z,virtual_heading,physical_x,physical_z,"
                         "physical_heading,translation,rotation,curvature,injected_yaw,reset,"
                         "graph_nodes,predict_us,steer_us"));
  const auto rows = csvOf(trace);
  ASSERT_GT(rows.size(), 100u);
  for (const auto& row : rows) ASSERT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(json::parse(summary)["format"], "forewalk.summary/1");
  ASSERT_EQ(run(simulate).status, 0);
  EXPECT_EQ(contents("t.csv"), trace) << "the same walk gives the same bytes";
  EXPECT_EQ(contents("s.json"), summary);
}

TEST_F(Cli, RefusesSimulationsThatCannotBe) {
  expectRefusal(run("simulate missing.json --trace t.csv"), 1, "missing.json");
  writeTo(folder_ / "bad.json", "{\"format\": ");
  expectRefusal(run("simulate bad.json --trace t.csv"), 1, "bad.json");
  writeTo(
      folder_ / "scene.json",
      R"({"format": "forewalk.simulation/1", "scene": "missing.obj", "user": {"kind": "wander"}})");
  expectRefusal(run("simulate scene.json --trace t.csv"), 1, "missing.obj");
  writeTo(
      folder_ / "endless.json",
      R"({"format": "forewalk.simulation/1", "scene": "rooms.obj", "user": {"kind": "wander"}})");
  expectRefusal(run("simulate endless.json"), 1, "endless.json: stop");
}

TEST_F(Cli, DemonstratesOnAnyScene) {
  const Outcome outcome = run("demo --scene rooms.obj --metres 5 --walks 1 --out out");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* name :
       {"no steering", "S2C reactive", "S2C predictive", "S2O reactive", "S2O predictive"}) {
    EXPECT_THAT(outcome.out, HasSubstr(name));
  }
  for (const char* file : {"prediction.json", "prediction.graphml", "prediction.dot",
                           "prediction.svg", "virtual_s2c.svg", "room_s2o_predictive.svg",
                           "trace_none.csv", "summary_none.json", "resets.svg", "sweep.svg"}) {
    EXPECT_GT(contents("out/rooms/" + std::string(file)).size(), 100u) << file;
  }
  expectRefusal(run("demo --scene castle"), 1, "castle");
}

}  // namespace
