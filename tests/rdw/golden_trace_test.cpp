// The same walk to the last bit, in Debug and Release. A change here changes what every user feels.
#include <gtest/gtest.h>

#include <memory>

#include "navmesh/world.h"
#include "rdw/simulation.h"
#include "tests/support/random_mesh.h"

namespace forewalk::rdw {
namespace {

/// Of a walk of 60 m through a random navmesh in a 5 m x 5 m room, resets included.
std::uint64_t hashOfWalk(const char* controller) {
  testing::RandomMeshOptions options;
  options.cell = 2.0f;
  const auto world = std::make_shared<const navmesh::World>(
      navmesh::makeWorld(*navmesh::makeNavGraph(testing::randomMesh(7, 12, 12, options))));
  SimulationConfig config;
  config.session.space = *TrackedSpace::rectangle(5.0, 5.0);
  config.session.limits = *gainLimitsByName("laboratory");
  config.session.controller = controller;
  config.user.walker.lookAmplitude = 0.3;
  config.user.walker.bob = 0.03;
  config.stop.virtualMetres = 60.0;
  config.seed = 11;
  config.keepFrames = false;
  const auto result = simulate(world, config);
  if (!result) throw std::runtime_error(result.error().message);
  EXPECT_GT(result->summary.resets, 3u);
  return result->summary.traceHash;
}

TEST(GoldenTrace, IsTheSameInEveryBuild) {
  EXPECT_EQ(hashOfWalk("none"), 11332546222905096536ull);
  EXPECT_EQ(hashOfWalk("s2c"), 5946164699690755565ull);
  EXPECT_EQ(hashOfWalk("s2o"), 1979946097277795632ull);
  EXPECT_EQ(hashOfWalk("s2c-predictive"), 10570968401607229467ull);
  EXPECT_EQ(hashOfWalk("s2o-predictive"), 9780174019212150488ull);
}

}  // namespace
}  // namespace forewalk::rdw
