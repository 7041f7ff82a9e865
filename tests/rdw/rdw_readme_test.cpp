// The example of rdw/README.md, compiled and run; the last test sees that the two stay equal.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/random_mesh.h"
#include "tests/support/readme.h"

// clang-format off
#include "rdw/session.h"

using namespace forewalk;

// What your engine has: the tracked head, a picture from the virtual one, a way to say something.
struct Headset {
  virtual ~Headset() = default;
  virtual bool next(rdw::HeadPose& head, double& seconds) = 0;  // false: taken off
  virtual void render(const rdw::HeadPose& virtualHead) = 0;
  virtual void say(std::string_view sentence) = 0;
};

// Lets somebody walk through `world` in a room of 6 m x 6 m.
tl::expected<void, Error> walk(std::shared_ptr<const navmesh::World> world, Headset& headset) {
  rdw::SessionSettings settings;
  settings.space = *rdw::TrackedSpace::rectangle(6.0, 6.0);
  settings.limits = *rdw::gainLimitsByName("laboratory");
  settings.controller = "s2c-predictive";
  auto session = rdw::Session::make(std::move(world), std::move(settings));
  if (!session) return tl::unexpected(session.error());
  rdw::HeadPose head;
  double seconds = 0.0;
  while (headset.next(head, seconds)) {
    const rdw::FrameResult& frame = session->frame(head, seconds);
    headset.render(frame.virtualPose);
    if (frame.reset.turning) headset.say(rdw::sentenceOf(frame.reset.instruction));
  }
  return {};
}
// clang-format on

namespace {

/// Somebody who walks straight on through the room at 1 m/s until they are told something.
class Walker final : public Headset {
 public:
  explicit Walker(int framesMost) : framesMost_(framesMost) {}

  int frames = 0;
  std::vector<rdw::HeadPose> rendered;
  std::vector<std::string> told;
  glm::dvec2 body{0.0};

  bool next(rdw::HeadPose& head, double& seconds) override {
    if (frames == framesMost_ || !told.empty()) return false;
    seconds = frames / 72.0;
    body = {0.0, -2.0 + seconds};
    head.position = navmesh::toSpace(glm::vec2(body), 1.7f);
    ++frames;
    return true;
  }
  void render(const rdw::HeadPose& virtualHead) override { rendered.push_back(virtualHead); }
  void say(std::string_view sentence) override { told.emplace_back(sentence); }

 private:
  int framesMost_;
};

std::shared_ptr<const navmesh::World> hall() {
  navmesh::PolygonMesh floor = forewalk::testing::gridMesh(20, 20, 2.0f);
  for (glm::vec3& corner : floor.vertices) corner += glm::vec3(-20.0f, 0.0f, 20.0f);
  return std::make_shared<const navmesh::World>(navmesh::makeWorld(*navmesh::makeNavGraph(floor)));
}

TEST(RdwReadme, RendersNothingForSomebodyWhoDoesNotCome) {
  Walker nobody(0);
  EXPECT_TRUE(walk(hall(), nobody));
  EXPECT_TRUE(nobody.rendered.empty());
}

TEST(RdwReadme, StopsAWalkerBeforeTheWall) {
  Walker walker(72 * 60);
  const auto walked = walk(hall(), walker);
  ASSERT_TRUE(walked) << walked.error().message;
  EXPECT_EQ(walker.rendered.size(), static_cast<std::size_t>(walker.frames));
  ASSERT_EQ(walker.told.size(), 1u);
  EXPECT_EQ(walker.told[0], rdw::sentenceOf(rdw::ResetInstruction::kTurnAround));
  EXPECT_GT(walker.body.y, 0.0) << "not long before it";
  EXPECT_LT(walker.body.y, 3.0);
}

TEST(RdwReadme, ShowsTheExampleThatIsCompiledHere) {
  using forewalk::testing::contentsOf;
  EXPECT_THAT(
      contentsOf(FOREWALK_SOURCE "/tests/rdw/rdw_readme_test.cpp"),
      ::testing::HasSubstr(forewalk::testing::firstExampleIn(FOREWALK_SOURCE "/rdw/README.md")));
}

}  // namespace
