// A folder with a scene, and experiments carried out in it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "service/experiment/campaign.h"

namespace forewalk::service {

class ExperimentTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("experiment_test_" + std::to_string(getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    std::filesystem::copy_file(FOREWALK_ASSETS "/scenes/corridor.obj", folder_ / "corridor.obj",
                               std::filesystem::copy_options::overwrite_existing);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  tl::expected<Experiment, Error> loaded(const std::string& rest) {
    std::ofstream(folder_ / "plan.json")
        << R"({"format": "forewalk.experiment/1", )" << rest << "}";
    return Experiment::load(folder_ / "plan.json");
  }

  /// Two scenes, two rooms, two controllers, two seeds: 16 walks of 20 m. One room is too narrow
  /// for one variant's start.
  Experiment small() {
    auto experiment = loaded(kSmall);
    EXPECT_TRUE(experiment) << experiment.error().message;
    return std::move(*experiment);
  }

  CampaignEnd carriedOut(const Experiment& experiment, const std::string& name,
                         CampaignSettings settings = {}) {
    settings.out = folder_ / name;
    settings.version = "test";
    const auto end = experiment.carryOut(settings);
    EXPECT_TRUE(end) << end.error().message;
    return end ? *end : CampaignEnd{};
  }

  static CampaignSettings on(unsigned threads) {
    CampaignSettings settings;
    settings.threads = threads;
    return settings;
  }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  std::string text(const std::filesystem::path& file) {
    std::ifstream in(folder_ / file, std::ios::binary);
    EXPECT_TRUE(in) << file;
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
  }

  void expectSameResults(const std::string& one, const std::string& other) {
    for (const char* file : {"results.csv", "results.json", "openrdw.csv", "manifest.json"}) {
      EXPECT_EQ(text(std::filesystem::path(one) / file), text(std::filesystem::path(other) / file))
          << file;
    }
  }

  static constexpr const char* kSmall = R"(
    "name": "small", "walk": {"limits": "laboratory", "stop": {"virtual_m": 20}, "rate_hz": 30},
    "scenes": ["corridor.obj", "plane"],
    "rooms": [{"name": "4 m", "rectangle": [4, 4]}, {"name": "5 x 6 m", "rectangle": [5, 6]}],
    "users": [{"name": "straight", "kind": "waypoints", "waypoints": [[1, 0, 0], [30, 0, 0]]}],
    "controllers": ["none", "s2c"], "seeds": 2)";

  std::filesystem::path folder_;
};

}  // namespace forewalk::service
