// Our reactive rules on the physical motion that OpenRDW recorded, frame by frame against what it
// injected.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "rdw/steer_to.h"

namespace forewalk::rdw {
namespace {

struct Row {
  double t;
  PlanarPose physical;
  double injected;  // radians, left positive
  bool inReset;
};

constexpr double kDegree = kPi / 180.0;

std::vector<Row> readTrace(const std::string& path) {
  std::ifstream file(path);
  std::vector<Row> rows;
  std::string line;
  std::map<std::string, std::size_t> column;
  while (std::getline(file, line)) {
    std::vector<std::string> fields;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) fields.push_back(word);
    if (column.empty()) {
      for (std::size_t i = 0; i < fields.size(); ++i) column[fields[i]] = i;
      continue;
    }
    const auto value = [&](const char* name) { return std::stod(fields.at(column.at(name))); };
    // Unity's x and z (left-handed, z forward) are our plan's x and y; its headings run clockwise.
    rows.push_back(
        {value("frame") / 60.0,
         {{value("phys_x"), value("phys_z")}, wrapAngle(-kDegree * value("phys_heading"))},
         -kDegree * (value("inj_rot_deg") + value("inj_curv_deg")),
         value("in_reset") != 0.0});
  }
  return rows;
}

class ReferenceTrace : public ::testing::TestWithParam<const char*> {};

TEST_P(ReferenceTrace, IsInjectedAsOpenRdwInjected) {
  const std::string name = GetParam();
  const std::vector<Row> rows =
      readTrace(std::string(FOREWALK_SHARED_DATA) + "/reference/square10_turns_" + name + ".csv");
  if (rows.empty()) GTEST_SKIP() << "no reference traces under " << FOREWALK_SHARED_DATA;
  ASSERT_EQ(rows.size(), 5400u);

  const GainLimits limits = *gainLimitsByName("toolkit");
  const TrackedSpace space = *TrackedSpace::rectangle(10, 10);
  SteerToCore core;
  CentreTarget centre;
  auto controller = makeReactive(name == "s2c" ? SteerRule::kCentre : SteerRule::kOrbit);
  int compared = 0, sameSign = 0, sameGains = 0;
  double worst = 0.0;
  PlanarPose last{{-3, -3}, -kPi / 4};
  for (const Row& row : rows) {
    Motion motion;
    motion.dt = 1.0 / 60.0;
    motion.step = row.physical.position - last.position;
    motion.distance = glm::length(motion.step);
    motion.turn = wrapAngle(row.physical.heading - last.heading);
    motion.turnRate = motion.turn / motion.dt;
    last = row.physical;
    if (row.inReset) continue;
    const glm::dvec2 heading = directionOf(row.physical.heading);
    const glm::dvec2 target = name == "s2c" ? centre.target(row.physical.position, heading, space)
                                            : orbitTarget(row.physical.position, heading, space);
    const Steering ours = core.steer(motion, row.physical.position, heading, target, limits);
    const Gains gains = controller->steer(
        {motion, row.physical, row.physical, space, limits, Redirection{}, nullptr});
    if (std::abs(row.injected) < 1e-3 * kDegree) continue;
    ++compared;
    sameSign += (ours.yaw > 0.0) == (row.injected > 0.0);
    const double off = std::abs(ours.yaw - row.injected) / kDegree;
    worst = std::max(worst, off);
    const double asApplied = (static_cast<double>(gains.rotation) - 1.0) * motion.turn -
                             static_cast<double>(gains.curvature) * motion.distance;
    sameGains += std::abs(asApplied - row.injected) / kDegree < 5e-3;
  }
  std::printf("%s: %d frames, same sign in %d, worst %.2g deg, as gains within 0.005 deg in %d\n",
              name.c_str(), compared, sameSign, worst, sameGains);
  EXPECT_GT(compared, 4000);
  EXPECT_EQ(sameSign, compared);
  EXPECT_LT(worst, 1e-6);
  // The gains are cut to the limits, which the toolkit's smoothing oversteps after fast turns.
  EXPECT_GT(sameGains, 0.93 * compared);
}

INSTANTIATE_TEST_SUITE_P(Both, ReferenceTrace, ::testing::Values("s2c", "s2o"));

}  // namespace
}  // namespace forewalk::rdw
