#include "rdw/walker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/support/random_mesh.h"

namespace forewalk::rdw {
namespace {

using navmesh::World;
using ::testing::HasSubstr;

constexpr double kRate = 90.0;
const navmesh::SnapLimits kSnap{0.5f, 1.3f, 1.3f};

std::shared_ptr<const World> worldOf(const navmesh::PolygonMesh& mesh) {
  return std::make_shared<const World>(navmesh::makeWorld(navmesh::makeNavGraph(mesh).value()));
}

tl::expected<std::unique_ptr<Walker>, Error> make(const User& user, const WalkStart& start = {},
                                                  std::shared_ptr<const World> world = nullptr,
                                                  std::uint64_t seed = 1) {
  return makeWalker(std::move(world), user, start, kSnap, glm::dvec2(0.0), kRate, seed);
}

std::string refusal(const User& user, const WalkStart& start = {},
                    std::shared_ptr<const World> world = nullptr) {
  const auto walker = make(user, start, std::move(world));
  return walker ? "accepted" : walker.error().message;
}

User following(std::vector<glm::vec3> points) {
  User user;
  user.plan = Waypoints{std::move(points), false};
  user.walker.acceleration = 1e9;
  return user;
}

/// The map under which a walker begins where it is to begin.
Redirection beginning(const Walker& walker) {
  const VirtualStart& start = walker.start();
  return alignment(walker.body(),
                   {glm::dvec2(navmesh::toPlan(start.floor)), static_cast<double>(start.heading)});
}

/// Walks without any gain until finished or `seconds` are over; virtual body poses, frame by frame.
std::vector<PlanarPose> walked(Walker& walker, double seconds) {
  const Redirection map = beginning(walker);
  const FrameResult neutral;
  std::vector<PlanarPose> poses{map.toVirtual(walker.body())};
  while (!walker.finished() && static_cast<double>(poses.size()) <= seconds * kRate) {
    walker.advance(1.0 / kRate, neutral, map);
    poses.push_back(map.toVirtual(walker.body()));
  }
  return poses;
}

double secondsOf(const std::vector<PlanarPose>& poses) {
  return static_cast<double>(poses.size() - 1) / kRate;
}

TEST(MakeWalker, NamesTheSettingThatCannotWork) {
  User user = following({{0, 0, 0}, {0, 0, -1}});
  user.walker.speed = 0.0;
  EXPECT_THAT(refusal(user), HasSubstr("speed is 0 m/s"));
  user.walker.speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(user), HasSubstr("speed is nan m/s"));
  user.walker = {};
  user.walker.pauseMin = 2.0;
  EXPECT_THAT(refusal(user), HasSubstr("longest pause is 0 s"));
  user.walker = {};
  user.walker.turnRate = -1.0;
  EXPECT_THAT(refusal(user), HasSubstr("turn rate is -1 rad/s"));

  user = {};
  user.plan = Legs{2.0, 1.0, 0.0, true};
  EXPECT_THAT(refusal(user), HasSubstr("longest leg is 1 m"));
  WalkStart start;
  start.heading = std::numeric_limits<double>::infinity();
  user.plan = Legs{};
  EXPECT_THAT(refusal(user, start), HasSubstr("not finite"));
}

TEST(MakeWalker, RefusesToWalkNowhere) {
  EXPECT_THAT(refusal(following({})), HasSubstr("0 waypoints"));
  EXPECT_THAT(refusal(following({{0, 0, 0}})), HasSubstr("the walk begins at the first"));
  EXPECT_THAT(refusal(User{}), HasSubstr("wandering needs a navmesh"));
  User recorded;
  recorded.plan = Recorded{};
  EXPECT_THAT(refusal(recorded), HasSubstr("recorded walk is empty"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal(following({{0, 0, 0}, {0, 0, nan}})), HasSubstr("waypoint 1"));
}

TEST(MakeWalker, NamesAPlaceThatCannotBeReached) {
  const auto islands = worldOf(
      testing::together(testing::gridMesh(4, 4), testing::gridMesh(4, 4), {10.0f, 0.0f, 0.0f}));
  EXPECT_THAT(refusal(following({{1, 0, -1}, {7, 0, -1}}), {}, islands),
              HasSubstr("waypoint 1 7,0,-1 has no walkable polygon"));
  EXPECT_THAT(refusal(following({{1, 0, -1}, {12, 0, -1}}), {}, islands),
              HasSubstr("cannot be reached: it lies in component 1"));
  WalkStart start;
  start.floor = glm::vec3(1, 50, -1);
  EXPECT_THAT(refusal(User{}, start, islands), HasSubstr("start 1,50,-1"));
}

TEST(Walker, TakesTheTimeThatSpeedAndTurnRateSay) {
  // 3 m, a right angle on the spot at 90 degrees a second, 2 m.
  User user = following({{0, 0, 0}, {0, 0, -3}, {2, 0, -3}});
  const auto straight = make(user);
  ASSERT_TRUE(straight) << straight.error().message;
  const auto poses = walked(**straight, 60.0);
  EXPECT_NEAR(secondsOf(poses), 3.0 + 1.0 + 2.0, 2.0 / kRate);
  EXPECT_NEAR(glm::distance(poses.back().position, {2.0, 3.0}), 0.0, 0.011);
  for (const PlanarPose& pose : poses) {  // the corner is not cut
    const double off = std::min(std::abs(pose.position.x), std::abs(pose.position.y - 3.0));
    EXPECT_LT(off, 0.011);
  }

  user.walker.speed = 0.5;
  user.walker.turnRate = kPi / 4.0;
  EXPECT_NEAR(secondsOf(walked(*make(user).value(), 60.0)), 6.0 + 2.0 + 4.0, 2.0 / kRate);
}

TEST(Walker, TurnsGentleCornersWhileWalking) {
  const double angle = 20.0 * kPi / 180.0;
  const auto user = following(
      {{0, 0, 0}, {0, 0, -3}, {-3.0f * std::sin(0.349f), 0, -3 - 3.0f * std::cos(0.349f)}});
  const auto walker = make(user).value();
  const auto poses = walked(*walker, 60.0);
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    EXPECT_NEAR(glm::distance(poses[i].position, poses[i - 1].position), 1.0 / kRate, 1e-9);
    EXPECT_LE(std::abs(wrapAngle(poses[i].heading - poses[i - 1].heading)),
              0.5 * kPi / kRate + 1e-9);
  }
  EXPECT_NEAR(poses.back().heading, angle, 0.03);
}

TEST(Walker, NeverCirclesAWaypointItCannotTurnTo) {
  // Points closer together than the walking turn is wide, at every angle.
  User user = following({{0, 0, 0}});
  auto& points = std::get<Waypoints>(user.plan).points;
  for (int i = 1; i < 200; ++i) {
    const float angle = 2.4f * static_cast<float>(i);
    points.push_back(points.back() + 0.3f * glm::vec3(std::sin(angle), 0.0f, std::cos(angle)));
  }
  for (const double stopAngle : {0.1, 0.5, 1.5, kPi}) {
    user.walker.stopAngle = stopAngle;
    user.walker.turnRate = stopAngle > 3.0 ? 4.0 * kPi : 0.5 * kPi;
    const auto walker = make(user).value();
    walked(*walker, 1000.0);
    EXPECT_TRUE(walker->finished()) << stopAngle;
  }
}

TEST(Walker, PausesAtGoalsForAsLongAsAsked) {
  User user = following({{0, 0, 0}, {0, 0, -1}, {0, 0, -2}, {0, 0, -3}});
  user.walker.pauseMin = user.walker.pauseMax = 1.5;
  const auto walker = make(user).value();
  EXPECT_NEAR(secondsOf(walked(*walker, 60.0)), 3.0 + 2 * 1.5, 3.0 / kRate);
}

TEST(Walker, LooksAroundWithinItsAmplitudeWhileTheBodyWalksOn) {
  User user = following({{0, 0, 0}, {0, 0, -60}});
  user.walker.lookAmplitude = 0.6;
  user.walker.bob = 0.03;
  user.walker.sway = 0.02;
  std::set<std::uint64_t> endings;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto walker = make(user, {}, nullptr, seed).value();
    const Redirection map = beginning(*walker);
    EXPECT_NEAR(planarPose(walker->head()).heading, walker->body().heading,
                1e-6);  // looks straight at first
    double widest = 0.0;
    double highest = 0.0;
    double farthest = 0.0;
    double before = planarPose(walker->head()).heading;
    while (!walker->finished()) {
      walker->advance(1.0 / kRate, FrameResult{}, map);
      const PlanarPose head = planarPose(walker->head());
      const double look = wrapAngle(head.heading - walker->body().heading);
      EXPECT_LT(std::abs(wrapAngle(head.heading - before)) * kRate, 3.0);  // rad/s: no jerk
      before = head.heading;
      widest = std::max(widest, std::abs(look));
      highest = std::max(highest, std::abs(static_cast<double>(walker->head().position.y) - 1.65));
      farthest = std::max(farthest, glm::distance(head.position, walker->body().position));
      EXPECT_NEAR(walker->body().position.x, 0.0, 1e-6);
    }
    EXPECT_LE(widest, 0.6 + 1e-6);
    EXPECT_GT(widest, 0.4);
    EXPECT_NEAR(highest, 0.03, 1e-3);
    EXPECT_NEAR(farthest, 0.02, 1e-3);
    endings.insert(static_cast<std::uint64_t>(std::abs(before) * 1e6));
  }
  EXPECT_EQ(endings.size(), 3u);  // every seed looks elsewhere
}

TEST(Walker, WalksLegsOfTheLengthsAndTurnsAskedFor) {
  for (const bool eitherSide : {true, false}) {
    User user;
    user.plan = Legs{2.0, 4.0, 0.5 * kPi, eitherSide};
    user.walker.stopAngle = 0.01;  // so that every corner is sharp in the trace
    const auto walker = make(user).value();
    const auto poses = walked(*walker, 2000.0);
    std::vector<glm::dvec2> corners{poses.front().position};
    for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
      const bool stood = poses[i].position == poses[i + 1].position;
      if (stood && poses[i].position != poses[i - 1].position) corners.push_back(poses[i].position);
    }
    ASSERT_GT(corners.size(), 300u);
    int left = 0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const double length = glm::distance(corners[i], corners[i - 1]);
      EXPECT_GT(length, 2.0 - 0.03);
      EXPECT_LT(length,
                eitherSide ? 4.0 + 0.03 : 8.1);  // tiny turns are no corner: two legs in one
      const double turn =
          angleBetween(corners[i - 1] - corners[i - 2], corners[i] - corners[i - 1]);
      EXPECT_LT(std::abs(turn), 0.5 * kPi + 0.03);
      if (eitherSide) {
        EXPECT_NEAR(std::abs(turn), 0.5 * kPi, 0.03);
      }
      left += turn > 0.0;
    }
    const double share = static_cast<double>(left) / static_cast<double>(corners.size());
    EXPECT_NEAR(share, 0.5, 0.1);
  }
}

/// A wall with a door: a grid without some of its squares.
navmesh::PolygonMesh withoutPolygons(const navmesh::PolygonMesh& mesh,
                                     const std::set<std::uint32_t>& gone) {
  navmesh::PolygonMesh rest;
  rest.vertices = mesh.vertices;
  for (std::uint32_t i = 0; i < mesh.polygonCount(); ++i) {
    if (gone.count(i) != 0) continue;
    for (std::uint32_t k = mesh.ringStart[i]; k < mesh.ringStart[i + 1]; ++k)
      rest.ring.push_back(mesh.ring[k]);
    rest.ringStart.push_back(static_cast<std::uint32_t>(rest.ring.size()));
  }
  return rest;
}

// A hall of 9 x 9 m, a wall through its middle row, a door in its last column.
std::shared_ptr<const World> hallWithDoor() {
  std::set<std::uint32_t> wall;
  for (std::uint32_t column = 0; column < 8; ++column) wall.insert(4 * 9 + column);
  return worldOf(withoutPolygons(testing::gridMesh(9, 9), wall));
}

double distanceOff(const World& world, glm::dvec2 plan) {
  const auto place = navmesh::locate(world.graph, world.locations,
                                     navmesh::toSpace(glm::vec2(plan), 0.0f), {5.0f, 1.0f, 1.0f});
  return place ? static_cast<double>(glm::distance(place->plan, glm::vec2(plan))) : 5.0;
}

TEST(Walker, GoesRoundAWallToAPointThatIsNotInSight) {
  const auto hall = hallWithDoor();
  const auto walker = make(following({{1, 0, -1}, {1, 0, -8}}), {}, hall).value();
  double length = 0.0;
  const auto poses = walked(*walker, 100.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length += glm::distance(poses[i].position, poses[i - 1].position);
    EXPECT_LT(distanceOff(*hall, poses[i].position), 0.02);
  }
  EXPECT_TRUE(walker->finished());
  EXPECT_NEAR(glm::distance(poses.back().position, {1.0, 8.0}), 0.0, 0.011);
  const double shortest = 2.0 * std::hypot(7.0, 3.0) + 1.0;
  EXPECT_GT(length, shortest - 0.02);
  EXPECT_LT(length, shortest + 1.0);
}

TEST(Walker, PlansAnewWhenItFindsItselfElsewhere) {
  const auto hall = hallWithDoor();
  const auto walker = make(following({{1, 0, -1}, {8, 0, -1}}), {}, hall).value();
  Redirection map = beginning(*walker);
  for (int i = 0; i < 90; ++i) walker->advance(1.0 / kRate, FrameResult{}, map);
  map.offset.y += 6.5;  // beyond the wall, as after lost tracking
  FrameResult frame;
  for (int i = 0; i < 90 * 60 && !walker->finished(); ++i) {
    const glm::dvec2 at = map.toVirtual(walker->body()).position;
    EXPECT_LT(distanceOff(*hall, at), 0.02);
    frame.location = *navmesh::locate(hall->graph, hall->locations,
                                      navmesh::toSpace(glm::vec2(at), 0.0f), kSnap);
    walker->advance(1.0 / kRate, frame, map);
  }
  EXPECT_TRUE(walker->finished());
  EXPECT_NEAR(glm::distance(map.toVirtual(walker->body()).position, {8.0, 1.0}), 0.0, 0.011);
}

TEST(Walker, StopsWithinTheWayThatReactionAndBrakingTake) {
  User user = following({{0, 0, 0}, {0, 0, -50}});
  user.walker.speed = 1.4;
  user.walker.reactionTime = 0.3;
  user.walker.deceleration = 2.0;
  for (const double rate : {30.0, 90.0, 240.0}) {
    const auto walker = make(user).value();
    const Redirection map = beginning(*walker);
    FrameResult frame;
    for (int i = 0; i < 60; ++i) walker->advance(1.0 / rate, frame, map);
    const glm::dvec2 begin = walker->body().position;
    frame.reset.turning = true;
    frame.reset.remaining = kPi;
    double turned = 0.0;
    for (int i = 0; i < static_cast<int>(2.0 * rate); ++i) {
      const PlanarPose before = walker->body();
      walker->advance(1.0 / rate, frame, map);
      turned += wrapAngle(walker->body().heading - before.heading);
      if (turned != 0.0) {
        EXPECT_EQ(walker->body().position, before.position);
      }
    }
    EXPECT_NEAR(glm::distance(walker->body().position, begin), 1.4 * 0.3 + 1.4 * 1.4 / (2.0 * 2.0),
                1e-9);
    EXPECT_NEAR(std::abs(turned), (2.0 - 0.3 - 0.7) * 0.5 * kPi, 0.5 * kPi / rate + 1e-9);
  }
}

TEST(Walker, SetsOffNoFasterThanItAccelerates) {
  User user = following({{0, 0, 0}, {0, 0, -20}});
  user.walker.acceleration = 0.5;  // 2 s and 1 m to the full speed of 1 m/s
  const auto poses = walked(*make(user).value(), 60.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double speed = kRate * glm::distance(poses[i].position, poses[i - 1].position);
    EXPECT_LE(speed, std::min(1.0, 0.5 * static_cast<double>(i) / kRate) + 1e-9);
  }
  EXPECT_NEAR(secondsOf(poses), 2.0 + 19.0, 2.0 / kRate);
}

// A reset that begins just before a waypoint stops the walker beyond it. Going back for it would be
// walking the way that the reset has just turned them away from.
TEST(Walker, DoesNotGoBackForAPointItPassedWhileStopping) {
  User user = following({{0, 0, 0}, {0, 0, -5}, {3, 0, -5}});
  const auto walker = make(user).value();
  const Redirection map = beginning(*walker);
  FrameResult frame;
  while (walker->body().position.y < 4.9) walker->advance(1.0 / kRate, frame, map);
  frame.reset.turning = true;
  frame.reset.remaining = 0.0;
  for (int i = 0; i < 90; ++i) walker->advance(1.0 / kRate, frame, map);
  EXPECT_GT(walker->body().position.y, 5.2);
  frame.reset.turning = false;
  double lowest = 10.0;
  double sharpest = 0.0;
  while (!walker->finished()) {
    walker->advance(1.0 / kRate, frame, map);
    lowest = std::min(lowest, walker->body().position.y);
    sharpest = std::max(sharpest, std::abs(walker->body().heading));
  }
  EXPECT_GT(lowest, 4.98);
  EXPECT_LT(sharpest, 0.6 * kPi);  // a right turn, and no about-face
}

TEST(Walker, WandersOverAllOfItsComponentAndNowhereElse) {
  const auto world = worldOf(
      testing::together(testing::gridMesh(3, 3), testing::gridMesh(9, 9), {5.0f, 0.0f, 0.0f}));
  User user;
  user.walker.speed = 5.0;
  user.walker.turnRate = 4.0 * kPi;
  const auto walker = make(user, {}, world, 3).value();
  std::set<std::pair<int, int>> seen;
  for (const PlanarPose& pose : walked(*walker, 600.0)) {
    EXPECT_LT(distanceOff(*world, pose.position), 0.02);
    EXPECT_GT(pose.position.x, 5.0 - 0.02);  // the larger component
    seen.emplace(static_cast<int>(pose.position.x), static_cast<int>(pose.position.y));
  }
  EXPECT_GT(seen.size(), 75u);  // of 81 squares
  EXPECT_FALSE(walker->finished());
}

TEST(Walker, KeepsToARecordingWhereverItsBodyIs) {
  Walk walk{"w", {}};
  for (int i = 0; i < 200; ++i) {
    const double s = 0.05 * i;
    walk.samples.push_back({s, {std::sin(s), 2.0 * std::sin(0.5 * s)}});
  }
  User user;
  user.plan = Recorded{walk};
  WalkStart start;
  start.physical = PlanarPose{{3.0, -2.0}, 1.0};
  const auto walker = make(user, start).value();
  const auto poses = walked(*walker, 100.0);
  const auto frames = resample(walk, kRate);
  ASSERT_EQ(poses.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(glm::distance(poses[i].position, frames[i].plan), 0.0, 1e-6) << i;
    EXPECT_NEAR(wrapAngle(poses[i].heading - frames[i].heading), 0.0, 1e-6) << i;
  }
  EXPECT_EQ(walker->progress(), 1.0);
}

}  // namespace
}  // namespace forewalk::rdw
