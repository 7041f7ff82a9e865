#include "service/fitting.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "service/likelihood_file.h"
#include "tests/support/recorded_choices.h"

namespace forewalk::service {
namespace {

TEST(Minimise, FindsTheLowestPointOfABowlAndOfABananaValley) {
  const Minimum bowl = minimise(
      [](std::span<const double> at) {
        double sum = 0.0;
        for (std::size_t i = 0; i < at.size(); ++i) {
          const double off = at[i] - static_cast<double>(i);
          sum += static_cast<double>(i + 1) * off * off;
        }
        return sum;
      },
      {5.0, 5.0, 5.0, 5.0}, 0.5, 4000);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(bowl.at[i], static_cast<double>(i), 0.02);
  const Minimum banana = minimise(
      [](std::span<const double> at) {
        const double a = 1.0 - at[0], b = at[1] - at[0] * at[0];
        return a * a + 100.0 * b * b;
      },
      {-1.2, 1.0}, 0.5, 4000);
  EXPECT_NEAR(banana.at[0], 1.0, 0.05);
  EXPECT_LT(banana.value, 1e-3);
}

TEST(Minimise, WalksAroundPlacesWithoutAValue) {
  const Minimum minimum =
      minimise([](std::span<const double> at) { return at[0] < 0.5 ? std::nan("") : at[0]; }, {3.0},
               0.5, 500);
  EXPECT_NEAR(minimum.at[0], 0.5, 0.05);
}

TEST(FitLikelihood, StaysWhereItStartsWithoutWalks) {
  const Fit fit = fitLikelihood({});
  EXPECT_EQ(fit.samples, 0u);
  EXPECT_NEAR(fit.parameters.concentration, unfittedParameters().concentration, 0.05);
}

TEST(FitLikelihood, IsAtLeastAsLikelyAsWhatMadeTheWalks) {
  prediction::LikelihoodParameters truth = unfittedParameters();
  truth.concentration = 5.0;
  truth.steady = 0.9;
  const RecordedWalk walk = testing::recordedChoices("ann", 1500, 3, truth);
  const RecordedWalk* walks[] = {&walk};
  FitSettings free;
  free.pull = 0.0;
  const Fit fit = fitLikelihood(walks, free);
  EXPECT_EQ(fit.samples, 1500u);
  const auto nll = [&](const prediction::LikelihoodParameters& parameters) {
    double sum = 0.0;
    replay(walk, parameters, [&](const Sample& sample, std::span<const double> p, double) {
      sum -= std::log(p[sample.taken]);
    });
    return sum / 1500.0;
  };
  EXPECT_NEAR(fit.nll, nll(fit.parameters), 1e-9);
  EXPECT_LT(fit.nll, nll(truth) + 1e-3);
  EXPECT_LT(fit.nll, nll(unfittedParameters()) - 0.02);
}

TEST(FitLikelihood, IsPulledTowardItsStartTheMoreTheFewerWalksThereAre) {
  prediction::LikelihoodParameters truth = unfittedParameters();
  truth.concentration = 8.0;
  const auto fitted = [&](std::size_t samples) {
    const RecordedWalk walk = testing::recordedChoices("ann", samples, 3, truth);
    const RecordedWalk* walks[] = {&walk};
    const prediction::LikelihoodParameters p = fitLikelihood(walks).parameters;
    return std::log(p.concentration / unfittedParameters().concentration) +
           std::log(p.steady / unfittedParameters().steady);
  };
  EXPECT_LT(std::abs(fitted(10)), std::abs(fitted(1000)));
}

TEST(FitLikelihood, IsTheSameEveryTime) {
  const RecordedWalk walk = testing::recordedChoices("ann", 200, 5, unfittedParameters());
  const RecordedWalk* walks[] = {&walk};
  const Fit one = fitLikelihood(walks), other = fitLikelihood(walks);
  for (const ParameterInfo& info : parameterInfos()) {
    EXPECT_EQ(one.parameters.*info.member, other.parameters.*info.member) << info.name;
  }
}

class LikelihoodFile : public ::testing::Test {
 protected:
  LikelihoodFile()
      : file_(std::filesystem::temp_directory_path() /
              ("forewalk_likelihood_" + std::to_string(getpid()) + ".json")) {}
  ~LikelihoodFile() override { std::filesystem::remove(file_); }

  auto read(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return readLikelihood(file_);
  }
  std::string refusal(const std::string& text) {
    const auto result = read(text);
    return result ? "" : result.error().message;
  }
  std::filesystem::path file_;
};

TEST_F(LikelihoodFile, ReadsWhatItWrote) {
  LikelihoodRecord record;
  double value = 0.125;
  for (const ParameterInfo& info : parameterInfos()) {
    record.parameters.*info.member = std::clamp(value, info.low, info.high);
    value += 0.03125;
  }
  const auto result = read(toJson(record));
  ASSERT_TRUE(result) << result.error().message;
  for (const ParameterInfo& info : parameterInfos()) {
    EXPECT_NEAR(*result.*info.member / (record.parameters.*info.member), 1.0, 1e-3) << info.name;
  }
}

TEST_F(LikelihoodFile, KeepsDefaultsForWhatIsNotNamed) {
  const auto result = read(R"({"format": "forewalk.likelihood/1", "parameters": {"cruise": 1}})");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->cruise, 1.0);
  EXPECT_EQ(result->concentration, prediction::LikelihoodParameters{}.concentration);
}

TEST_F(LikelihoodFile, RefusesWhatItCannotUseAndNamesIt) {
  const auto with = [](const std::string& parameters) {
    return R"({"format": "forewalk.likelihood/1", "parameters": )" + parameters + "}";
  };
  EXPECT_NE(refusal("").find("forewalk.likelihood/1"), std::string::npos);
  EXPECT_NE(refusal("[1, 2").find("forewalk.likelihood/1"), std::string::npos);
  EXPECT_NE(refusal(R"({"format": "forewalk.prediction/1"})").find("forewalk.likelihood/1"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"format": "forewalk.likelihood/1"})").find("parameters"),
            std::string::npos);
  EXPECT_NE(refusal(with(R"({"speed": 1})")).find("\"speed\""), std::string::npos);
  EXPECT_NE(refusal(with(R"({"cruise": "fast"})")).find("\"fast\""), std::string::npos);
  EXPECT_NE(refusal(with(R"({"turns_round": 0})")).find("turns_round"), std::string::npos);
  EXPECT_NE(refusal(with(R"({"concentration": -1})")).find("-1"), std::string::npos);
}

TEST(DefaultLikelihood, IsTheOneInTheAssets) {
  const auto file = std::filesystem::path(FOREWALK_ASSETS) / "likelihood" / "default.json";
  const auto result = readLikelihood(file);
  ASSERT_TRUE(result) << result.error().message;
  const prediction::LikelihoodParameters builtIn;
  for (const ParameterInfo& info : parameterInfos()) {
    EXPECT_EQ(*result.*info.member, builtIn.*info.member) << info.name;
  }
}

}  // namespace
}  // namespace forewalk::service
