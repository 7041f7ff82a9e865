// forewalk fit and forewalk evaluate as a person meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program_test.h"

namespace {

using forewalk::testing::Outcome;
using nlohmann::json;
using ::testing::HasSubstr;

class LikelihoodCli : public forewalk::testing::ProgramTest {
 protected:
  LikelihoodCli() {
    // A plus: two corridors of 20 m x 2 m that cross at the origin.
    write("plus.obj",
          "v -10 0 -1\nv 10 0 -1\nv 10 0 1\nv -10 0 1\nf 4 3 2 1\n"
          "v -1 0 -10\nv 1 0 -10\nv 1 0 10\nv -1 0 10\nf 8 7 6 5\n");
    // Two walkers, each out of all four arms by the next one.
    std::string csv = "walker_id,t,x,z\n";
    for (const char* walker : {"ann", "bob"}) {
      int frame = 0;
      const auto step = [&](double x, double z) {
        csv += std::string(walker) + "," + std::to_string(0.1 * frame++) + "," + std::to_string(x) +
               "," + std::to_string(z) + "\n";
      };
      for (int arm = 0; arm < 4; ++arm) {
        const double in = 1.5708 * arm;
        const double out = 1.5708 * (arm + (walker[0] == 'a' || arm % 2 == 0 ? 1 : 3));
        const double turn = arm + 1 < 4 ? 1.5708 * (arm + 1) : out;
        for (int k = 80; k > 0; --k) step(0.1 * k * std::cos(in), 0.1 * k * std::sin(in));
        for (int k = 0; k < 80; ++k) step(0.1 * k * std::cos(out), 0.1 * k * std::sin(out));
        if (std::abs(std::cos(out - turn)) < 0.9 || std::cos(out - turn) < 0.0) {
          for (int k = 80; k > 0; --k) step(0.1 * k * std::cos(out), 0.1 * k * std::sin(out));
          for (int k = 0; k < 80; ++k) step(0.1 * k * std::cos(turn), 0.1 * k * std::sin(turn));
        }
      }
    }
    write("walks.csv", csv);
  }
};

TEST_F(LikelihoodCli, RefusesInOneLineWhatItCannotUse) {
  refuses("evaluate plus.obj", 2, "WALKS");
  refuses("evaluate plus.obj nowhere.csv", 1, "nowhere.csv");
  refuses("evaluate plus.obj plus.obj", 1, "plus.obj");
  refuses("evaluate plus.obj walks.csv --horizon 0", 2, "--horizon");
  refuses("evaluate plus.obj walks.csv --method tea-leaves", 2, "tea-leaves");
  refuses("evaluate plus.obj walks.csv --likelihood nowhere.json", 1, "nowhere.json");
  refuses("evaluate plus.obj walks.csv --train x.obj=y.csv", 2, "--folds");
  refuses("fit plus.obj --out l.json", 2, "SCENE=WALKS");
  refuses("fit plus.obj=walks.csv", 2, "--out");
  refuses("fit plus.obj=nowhere.csv --out l.json", 1, "nowhere.csv");
  write("far.csv", "walker_id,t,x,z\nu,0,500,500\nu,1,501,500\nu,2,502,500\n");
  refuses("fit plus.obj=far.csv --out l.json", 1, "off the navmesh");
}

TEST_F(LikelihoodCli, FitsWhatEvaluateReadsAndTheSameBytesEveryTime) {
  const Outcome fit = run("fit plus.obj=walks.csv --rate 5 --horizons 3 --out l.json");
  ASSERT_EQ(fit.status, 0) << fit.err;
  const json file = json::parse(contents("l.json"));
  EXPECT_EQ(file["format"], "forewalk.likelihood/1");
  EXPECT_EQ(file["trained_on"][0]["walkers"], (json{"ann", "bob"}));
  EXPECT_GT(file["samples"], 20);
  ASSERT_EQ(run("fit plus.obj=walks.csv --rate 5 --horizons 3 --out again.json").status, 0);
  EXPECT_EQ(contents("l.json"), contents("again.json"));

  const Outcome outcome =
      run("evaluate plus.obj walks.csv --horizon 3 --likelihood l.json --out out/plus");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("softmax of cosine"));
  const json report = json::parse(contents("out/plus.json"));
  EXPECT_EQ(report["format"], "forewalk.evaluation/1");
  EXPECT_EQ(report["walkers"], (json{"ann", "bob"}));
  EXPECT_GT(report["samples"]["junctions"], 20);
  for (const char* figure : {"reliability", "displacement", "scores"}) {
    EXPECT_THAT(contents("out/plus-" + std::string(figure) + ".svg"), HasSubstr("</svg>"));
  }
  EXPECT_THAT(contents("out/plus.csv"), HasSubstr("guess,walker,"));
}

TEST_F(LikelihoodCli, EvaluatesEachWalkerByTheOthers) {
  const Outcome one =
      run("evaluate plus.obj walks.csv --horizon 3 --folds --rate 5 --fit-horizons 3");
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("by a fit on the others"));
  const Outcome threads =
      run("evaluate plus.obj walks.csv --horizon 3 --folds --rate 5 --fit-horizons 3 --threads 1");
  EXPECT_EQ(one.out, threads.out);
}

}  // namespace
