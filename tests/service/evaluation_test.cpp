#include "service/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "service/files.h"
#include "tests/support/random_mesh.h"
#include "tests/support/recorded_choices.h"

namespace forewalk::service {
namespace {

const GuessReport& reportOf(const Evaluation& evaluation, Guess guess) {
  for (const GuessReport& report : evaluation.guesses) {
    if (report.guess == guess) return report;
  }
  throw std::logic_error("no such guess");
}

EvaluationModels modelsFor(std::size_t walks, const prediction::LikelihoodParameters& parameters) {
  return {std::vector<prediction::LikelihoodParameters>(walks, parameters),
          std::vector<double>(walks, 1.5)};
}

std::vector<RecordedWalk> manyWalks(std::size_t samples) {
  std::vector<RecordedWalk> walks;
  for (std::uint64_t w = 0; w < 5; ++w) {
    walks.push_back(
        testing::recordedChoices("u" + std::to_string(w), samples, w + 1, unfittedParameters()));
  }
  return walks;
}

TEST(Evaluate, HasNothingToSayOfNothing) {
  const Evaluation nothing = evaluate({}, {}, 5.0f, 1);
  EXPECT_EQ(nothing.samples, 0u);
  for (const GuessReport& report : nothing.guesses) EXPECT_EQ(report.forward.samples, 0u);
  EXPECT_FALSE(toTable(nothing).empty());
  EXPECT_TRUE(nlohmann::json::accept(toJson(nothing)));
  EXPECT_THAT(scorePlot(nothing), ::testing::HasSubstr("</svg>"));
}

TEST(Evaluate, GivesTheUniformGuessTheLogarithmOfTheNumberOfWays) {
  const std::vector<RecordedWalk> walks = manyWalks(200);
  const Evaluation evaluation = evaluate(walks, modelsFor(5, unfittedParameters()), 5.0f, 1);
  double logs = 0.0, top1 = 0.0, brier = 0.0;
  for (const RecordedWalk& walk : walks) {
    for (const RecordedFrame& frame : walk.frames) {
      const auto ways = static_cast<double>(frame.wayCount);
      logs += std::log(ways);
      top1 += 1.0 / ways;
      brier += 1.0 - 1.0 / ways;
    }
  }
  const Scores& uniform = reportOf(evaluation, Guess::kUniform).all;
  EXPECT_EQ(uniform.samples, 1000u);
  EXPECT_NEAR(uniform.nll, logs / 1000.0, 1e-9);
  EXPECT_NEAR(uniform.top1, top1 / 1000.0, 1e-9);
  EXPECT_NEAR(uniform.brier, brier / 1000.0, 1e-9);
}

TEST(Evaluate, PrefersWhatMadeTheChoicesAndFindsItCalibrated) {
  const std::vector<RecordedWalk> walks = manyWalks(2000);
  const Evaluation evaluation = evaluate(walks, modelsFor(5, unfittedParameters()), 5.0f, 1);
  const GuessReport& truth = reportOf(evaluation, Guess::kLikelihood);
  for (const Guess guess : {Guess::kUniform, Guess::kCosine}) {
    const GuessReport& other = reportOf(evaluation, guess);
    EXPECT_LT(truth.all.nll, other.all.nll);
    EXPECT_LT(truth.all.brier, other.all.brier);
  }
  EXPECT_LT(truth.calibration, 0.015);
  prediction::LikelihoodParameters sure = unfittedParameters();
  sure.steady = 3.0;
  sure.turnsRound = 1e-4;
  const Evaluation overSure = evaluate(walks, modelsFor(5, sure), 5.0f, 1);
  EXPECT_GT(reportOf(overSure, Guess::kLikelihood).calibration, 0.1);
}

TEST(QualityOf, SaysOfAWalkWhatEvaluateSays) {
  const RecordedWalk walk = testing::recordedChoices("u", 400, 3, unfittedParameters());
  const PredictionQuality quality = qualityOf(walk, unfittedParameters());
  const Evaluation evaluation = evaluate({&walk, 1}, modelsFor(1, unfittedParameters()), 5.0f, 1);
  const Scores& scores = reportOf(evaluation, Guess::kLikelihood).all;
  EXPECT_EQ(quality.settled, evaluation.samples - evaluation.unsettled);
  EXPECT_EQ(quality.contained, evaluation.contained);
  EXPECT_EQ(quality.junctions, scores.samples);
  EXPECT_NEAR(quality.nll, scores.nll, 1e-12);
  EXPECT_NEAR(quality.first, scores.top1, 1e-12);
  // Of at most n ways the rank lies between those who are always right and always wrong.
  EXPECT_GE(quality.rank, 1.0);
  EXPECT_LE(quality.rank, 1.0 + (1.0 - quality.first) * 10.0);
  EXPECT_EQ(qualityOf(RecordedWalk{}, unfittedParameters()).settled, 0u);
}

TEST(Evaluate, FindsNoDifferenceToItselfAndIntervalsAroundOthers) {
  const std::vector<RecordedWalk> walks = manyWalks(200);
  const Evaluation evaluation = evaluate(walks, modelsFor(5, unfittedParameters()), 5.0f, 1);
  const Interval& own = reportOf(evaluation, Guess::kLikelihood).nllDifference;
  EXPECT_EQ(own.low, 0.0);
  EXPECT_EQ(own.high, 0.0);
  const GuessReport& uniform = reportOf(evaluation, Guess::kUniform);
  const Interval& interval = uniform.nllDifference;
  EXPECT_NEAR(interval.mean,
              reportOf(evaluation, Guess::kLikelihood).forward.nll - uniform.forward.nll, 1e-9);
  EXPECT_LT(interval.low, interval.mean);
  EXPECT_GT(interval.high, interval.mean);
  // One walker alone says nothing about others: nothing to draw but the same one.
  const Evaluation one =
      evaluate(std::span(walks).first(1), modelsFor(1, unfittedParameters()), 5.0f, 1);
  const Interval& alone = reportOf(one, Guess::kUniform).nllDifference;
  EXPECT_NEAR(alone.low, alone.high, 1e-12);
}

TEST(Evaluate, PutsConstantVelocityWhereAStraightWalkGoes) {
  std::vector<RecordedWalk> walks = manyWalks(50);
  for (RecordedWalk& walk : walks) {
    for (Sample& sample : walk.samples) {
      for (std::size_t t = 0; t < kSecondsAhead.size(); ++t) {
        sample.after[t] = {kSecondsAhead[t] + 0.25, 0.0};
      }
    }
  }
  const Evaluation evaluation = evaluate(walks, modelsFor(5, unfittedParameters()), 5.0f, 1);
  const GuessReport& straight = reportOf(evaluation, Guess::kConstantVelocity);
  for (const double off : straight.places.final) EXPECT_NEAR(off, 0.25, 1e-9);
  for (const double off : straight.places.average) EXPECT_NEAR(off, 0.25, 1e-9);
}

TEST(Evaluate, ReportsTheSameInEveryFormat) {
  const std::vector<RecordedWalk> walks = manyWalks(50);
  const Evaluation evaluation = evaluate(walks, modelsFor(5, unfittedParameters()), 5.0f, 1);
  const nlohmann::json json = nlohmann::json::parse(toJson(evaluation));
  EXPECT_EQ(json["format"], "forewalk.evaluation/1");
  EXPECT_EQ(json["guesses"].size(), kGuesses.size());
  EXPECT_NEAR(json["guesses"][0]["forward"]["nll"],
              reportOf(evaluation, Guess::kUniform).forward.nll, 1e-12);
  const std::string csv = toCsv(evaluation);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4 * 6);
  EXPECT_THAT(toTable(evaluation), ::testing::HasSubstr("constant velocity"));
  for (const std::string& svg :
       {reliabilityPlot(evaluation), displacementPlot(evaluation), scorePlot(evaluation)}) {
    EXPECT_THAT(svg, ::testing::HasSubstr("</svg>"));
  }
}

/// Five squares of 4 m in a row.
navmesh::World corridorWorld() {
  navmesh::PolygonMesh mesh = testing::gridMesh(5, 1, 4.0f);
  return navmesh::makeWorld(*navmesh::makeNavGraph(mesh));
}

TEST(Record, SettlesWhichEndOfACorridorWasTaken) {
  // A corridor of 20 m x 4 m along x: out to the right end from its middle.
  const navmesh::World world = corridorWorld();
  rdw::Walk walk{"ann", {}};
  const glm::vec2 middle = world.graph.ringOf(navmesh::PolygonId{2})[0] + glm::vec2(1.0f, 2.0f);
  for (int k = 0; k <= 80; ++k) {
    walk.samples.push_back({0.1 * k, glm::dvec2(middle) + glm::dvec2(0.1 * k, 0.0)});
  }
  for (const MethodFactory& method : {MethodFactory(polygonMethod), MethodFactory(frontMethod)}) {
    const RecordedWalk recorded = record(world, walk, method, {4.0f, 10.0, 1.0, 0.0});
    ASSERT_EQ(recorded.frames.size(), 81u);
    EXPECT_EQ(recorded.offMesh, 0u);
    EXPECT_NEAR(recorded.turnover.metres, 8.0, 0.5);
    ASSERT_EQ(recorded.samples.size(), 9u);
    std::size_t taken = 0;
    for (const Sample& sample : recorded.samples) {
      if (sample.outcome == Outcome::kUnsettled) continue;
      ASSERT_EQ(sample.outcome, Outcome::kTaken);
      EXPECT_GT(sample.toEnd[sample.taken].x, 0.5);
      EXPECT_NEAR(sample.settledAfter, 4.0, 1.0);
      EXPECT_NEAR(sample.after[1].x - recorded.frames[sample.frame].plan.x, 1.0, 1e-6);
      EXPECT_NEAR(sample.along[1].x - recorded.frames[sample.frame].plan.x, 2.0, 0.11);
      ++taken;
    }
    EXPECT_GE(taken, 4u);
  }
}

TEST(Record, AsksSomebodyWhoStandsButOnceWhereSamplesAreSpaced) {
  const navmesh::World world = corridorWorld();
  rdw::Walk walk{"cat", {}};
  const glm::dvec2 start =
      glm::dvec2(world.graph.ringOf(navmesh::PolygonId{1})[0] + glm::vec2(1.0f, 2.0f));
  for (int k = 0; k <= 200; ++k) {
    // 4 m at 1 m/s, 10 s of standing, 6 m more.
    const double metres = 0.1 * (k < 40 ? k : k < 140 ? 40 : k - 100);
    walk.samples.push_back({0.1 * k, start + glm::dvec2(metres, 0.0)});
  }
  RecordingSettings settings;
  settings.horizon = 4.0f;
  settings.rate = 10.0;
  const auto byTime = record(world, walk, frontMethod, settings);
  settings.spacing = 1.0;
  const auto spaced = record(world, walk, frontMethod, settings);
  EXPECT_EQ(byTime.samples.size(), 41u);
  EXPECT_EQ(spaced.samples.size(), 11u);
  for (std::size_t i = 1; i < spaced.samples.size(); ++i) {
    EXPECT_GE(spaced.frames[spaced.samples[i].frame].plan.x -
                  spaced.frames[spaced.samples[i - 1].frame].plan.x,
              1.0 - 1e-9);
  }
}

TEST(Record, CountsFramesOffTheNavmesh) {
  const navmesh::World world = corridorWorld();
  const rdw::Walk walk{"bob", {{0.0, {1000.0, 1000.0}}, {2.0, {1000.5, 1000.0}}}};
  const RecordedWalk recorded = record(world, walk, polygonMethod, {4.0f, 10.0, 0.5, 0.0});
  EXPECT_EQ(recorded.offMesh, recorded.frames.size());
  EXPECT_TRUE(recorded.samples.empty());
}

TEST(Record, SeesRecordedWalksOnTheirNavmeshWithTheirWaysInTheGraph) {
  const std::filesystem::path folder =
      std::filesystem::path(FOREWALK_SHARED_DATA) / "walks" / "searching-b";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const auto bytes = readFile(folder / "walks.csv");
  ASSERT_TRUE(bytes);
  auto walks = rdw::parseWalks(*bytes, "walks.csv");
  ASSERT_TRUE(walks);
  // One walker is enough here; the command reports them all.
  walks->resize(1);
  const auto navMesh = loadNavMesh(folder / "scene.obj");
  ASSERT_TRUE(navMesh) << navMesh.error().message;
  const auto world = makeWorld(*navMesh);
  ASSERT_TRUE(world);
  for (const MethodFactory& method : {MethodFactory(polygonMethod), MethodFactory(frontMethod)}) {
    const std::vector<RecordedWalk> recorded =
        recordAll(**world, *walks, method, {3.0f, 15.0, 0.5, 0.0});
    const Evaluation evaluation = evaluate(recorded, modelsFor(1, {}), 3.0f, 1);
    EXPECT_LT(static_cast<double>(evaluation.offMesh + evaluation.snapped),
              0.01 * static_cast<double>(evaluation.frames));
    EXPECT_GT(static_cast<double>(evaluation.contained),
              0.9 * static_cast<double>(evaluation.samples - evaluation.unsettled));
    EXPECT_LT(reportOf(evaluation, Guess::kLikelihood).forward.nll,
              reportOf(evaluation, Guess::kUniform).forward.nll);
  }
}

}  // namespace
}  // namespace forewalk::service
