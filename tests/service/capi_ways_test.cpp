// Ways with names and likelihoods, gaze and resets to draw, through the C interface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk {
namespace {

/// A corridor along -z that ends in a wide T: left is towards -x.
navmesh::Scene tee() {
  return testing::BlockScene("tee").floor({-1, -10, 1, 2}).floor({-12, -12, 12, -10}).scene();
}

forewalk_session_settings settingsOf(forewalk_method method) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.method = method;
  settings.controller = FOREWALK_CONTROLLER_NONE;
  settings.resets = 0;
  settings.horizon = 9.0f;
  settings.likelihoods = 1;
  return settings;
}

/// At (0, z), looking along `heading`.
testing::TimedHead at(double z, double heading, double seconds) {
  return {{{0.0f, 1.7f, static_cast<float>(z)},
           glm::quat(glm::dquat(std::cos(0.5 * heading), 0.0, std::sin(0.5 * heading), 0.0))},
          seconds};
}

forewalk_graph_view viewOf(const testing::SessionHandle& session) {
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  return view;
}

/// Of all ways that end on the side of that sign of x.
double likelihoodOf(const forewalk_graph_view& view, float side) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < view.way_count; ++i) {
    const float x = view.nodes[view.ways[i].node].position.x;
    if (x * side > 1.5f) sum += static_cast<double>(view.ways[i].likelihood);
  }
  return sum;
}

class CapiWays : public ::testing::TestWithParam<forewalk_method> {};

TEST_P(CapiWays, AreOneATerminalAndSumToOne) {
  const auto navmesh = testing::makeNavMesh(tee());
  const auto session = testing::makeSession(navmesh, settingsOf(GetParam()));
  std::map<std::uint32_t, int> frames;  // that each name was seen in
  std::set<std::uint32_t> born;
  for (int frame = 0; frame < 600; ++frame) {
    testing::frame(session, at(-0.012 * frame, 0.0, frame / 90.0));
    const forewalk_graph_view view = viewOf(session);
    std::uint32_t terminals = 0;
    for (std::uint32_t i = 0; i < view.node_count; ++i)
      terminals += view.nodes[i].kind == FOREWALK_NODE_TERMINAL ? 1 : 0;
    ASSERT_EQ(view.way_count, terminals);
    double sum = static_cast<double>(view.likelihood_none);
    for (std::uint32_t i = 0; i < view.way_count; ++i) {
      const forewalk_way& way = view.ways[i];
      sum += static_cast<double>(way.likelihood);
      EXPECT_EQ(view.nodes[way.node].kind, FOREWALK_NODE_TERMINAL);
      ++frames[way.id];
      EXPECT_EQ(way.born != 0, born.insert(way.id).second) << "way " << way.id;
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
  }
  // 7 m walked towards the T: the way back and the ways ahead keep their names for long.
  const auto longest = std::max_element(frames.begin(), frames.end(),
                                        [](auto& a, auto& b) { return a.second < b.second; });
  EXPECT_GT(longest->second, 300);
  EXPECT_GT(likelihoodOf(viewOf(session), 1.0f) + likelihoodOf(viewOf(session), -1.0f), 0.5);
}

TEST_P(CapiWays, FollowTheGazeOfSomebodyWhoStands) {
  const auto navmesh = testing::makeNavMesh(tee());
  const auto lookingTo = [&](float x, bool told) {
    const auto session = testing::makeSession(navmesh, settingsOf(GetParam()));
    const forewalk_vec3 gaze{x, -0.4f, -0.5f};
    EXPECT_EQ(forewalk_session_set_gaze(session.get(), told ? &gaze : nullptr), FOREWALK_OK);
    for (int frame = 0; frame < 270; ++frame) {
      testing::frame(session, at(-9.0, 0.0, frame / 90.0));
    }
    const forewalk_graph_view view = viewOf(session);
    return likelihoodOf(view, -1.0f) / likelihoodOf(view, 1.0f);
  };
  const double left = lookingTo(-1.0f, true), right = lookingTo(1.0f, true);
  const double nowhere = lookingTo(1.0f, false);
  EXPECT_GT(left, 1.3 * nowhere);
  EXPECT_LT(right, nowhere / 1.3);
  EXPECT_NEAR(left * right, nowhere * nowhere, 0.05 * nowhere * nowhere);  // in the mirror
}

INSTANTIATE_TEST_SUITE_P(Methods, CapiWays,
                         ::testing::Values(FOREWALK_METHOD_POLYGON, FOREWALK_METHOD_FRONT));

TEST(CapiWaysSettings, AreThereWhereSomebodyWantsThem) {
  const auto navmesh = testing::makeNavMesh(tee());
  forewalk_session_settings settings = settingsOf(FOREWALK_METHOD_POLYGON);
  settings.likelihoods = 0;
  const auto none = testing::makeSession(navmesh, settings);
  testing::frame(none, at(0.0, 0.0, 0.0));
  EXPECT_EQ(viewOf(none).way_count, 0u);
  EXPECT_GT(viewOf(none).node_count, 1u);
  EXPECT_EQ(viewOf(none).likelihood_none, 1.0f);
  settings.controller = FOREWALK_CONTROLLER_FORESIGHT;
  const auto asked = testing::makeSession(navmesh, settings);
  testing::frame(asked, at(0.0, 0.0, 0.0));
  EXPECT_GT(viewOf(asked).way_count, 0u);
  EXPECT_EQ(forewalk_session_set_gaze(nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_set_chest(nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
}

TEST(CapiWaysEvents, TellBirthsOnce) {
  const auto navmesh = testing::makeNavMesh(tee());
  const auto session = testing::makeSession(navmesh, settingsOf(FOREWALK_METHOD_FRONT));
  testing::frame(session, at(0.0, 0.0, 0.0));
  const forewalk_graph_view first = viewOf(session);
  EXPECT_EQ(first.way_event_count, first.way_count);
  for (std::uint32_t i = 0; i < first.way_event_count; ++i) {
    EXPECT_EQ(first.way_events[i].change, FOREWALK_WAY_BIRTH);
    EXPECT_EQ(first.way_events[i].other, UINT32_MAX);
  }
  testing::frame(session, at(0.0, 0.0, 0.01));
  EXPECT_EQ(viewOf(session).way_event_count, 0u);
}

/// Walks ahead and does what resets say; what each phase was seen with.
struct Phases {
  std::vector<forewalk_reset_phase> order;  // without repeats
  double worstDirection = 0.0;              // radians between where it pointed and where it ended
};

Phases phasesOf(forewalk_reset reset, forewalk_axes axes) {
  const auto navmesh =
      testing::makeNavMesh(testing::BlockScene("plain").floor({-30, -30, 30, 30}).scene());
  forewalk_session_settings settings = testing::defaultSettings();
  settings.axes = axes;
  settings.controller = FOREWALK_CONTROLLER_NONE;
  settings.reset = reset;
  const auto session = testing::makeSession(navmesh, settings);
  Phases phases;
  glm::dvec2 position(0.0);
  double heading = 0.3;
  forewalk_frame_out out{};
  const bool unity = axes == FOREWALK_AXES_UNITY;
  for (int frame = 0; frame < 1500; ++frame) {
    constexpr double kDt = 1.0 / 90.0;
    const forewalk_frame_out last = out;
    if (last.resetting == 0) {
      if (frame > 0) position += kDt * rdw::directionOf(heading);
    } else if (last.reset_phase == FOREWALK_RESET_PHASE_BACKWARD) {
      position -= 0.8 * kDt * rdw::directionOf(heading);
    } else {
      heading += (last.instruction == FOREWALK_INSTRUCTION_TURN_RIGHT ||
                          last.reset_turned * (unity ? -1 : 1) < 0
                      ? -1.0
                      : 1.0) *
                 1.2 * kDt;
    }
    const testing::TimedHead head{
        {navmesh::toSpace(glm::vec2(position), 1.7f),
         glm::quat(glm::dquat(std::cos(0.5 * heading), 0.0, std::sin(0.5 * heading), 0.0))},
        frame * kDt};
    if (unity) {
      out = {};
      out.struct_size = sizeof out;
      const auto& [p, q] = head.pose;
      EXPECT_EQ(forewalk_frame(session.get(), {p.x, p.y, -p.z}, {-q.x, -q.y, q.z, q.w},
                               head.seconds, &out),
                FOREWALK_OK);
    } else {
      out = testing::frame(session, head);
    }
    if (phases.order.empty() || phases.order.back() != out.reset_phase)
      phases.order.push_back(out.reset_phase);
    EXPECT_EQ(out.resetting != 0, out.reset_phase >= FOREWALK_RESET_PHASE_BACKWARD);
    const forewalk_vec3 d = out.reset_direction;
    if (out.resetting == 0) {
      EXPECT_EQ(d.x * d.x + d.y * d.y + d.z * d.z, 0.0f);
    } else {
      EXPECT_NEAR(d.x * d.x + d.z * d.z, 1.0f, 1e-5f);
    }
    // The frame that ends it: the user faces where the arrow was.
    if (last.resetting != 0 && out.resetting == 0) {
      const forewalk_vec3 arrow = last.reset_direction;
      const glm::dvec2 shown(arrow.x, unity ? arrow.z : -arrow.z);
      const double off = std::abs(rdw::wrapAngle(rdw::headingOf(shown) - heading));
      phases.worstDirection = std::max(phases.worstDirection, off);
    }
  }
  return phases;
}

TEST(CapiResets, SayWhatToDraw) {
  for (const forewalk_axes axes : {FOREWALK_AXES_OPENXR, FOREWALK_AXES_UNITY}) {
    for (const forewalk_reset reset :
         {FOREWALK_RESET_TWO_ONE_TURN, FOREWALK_RESET_R2C, FOREWALK_RESET_R2G}) {
      const Phases phases = phasesOf(reset, axes);
      const std::vector<forewalk_reset_phase> once = {
          FOREWALK_RESET_PHASE_NONE, FOREWALK_RESET_PHASE_NEAR, FOREWALK_RESET_PHASE_TURN,
          FOREWALK_RESET_PHASE_TURNING, FOREWALK_RESET_PHASE_NONE};
      ASSERT_GE(phases.order.size(), once.size());
      EXPECT_TRUE(std::equal(once.begin(), once.end(), phases.order.begin())) << reset;
      EXPECT_LT(phases.worstDirection, 0.03) << reset;  // two frames of turning
    }
    const Phases back = phasesOf(FOREWALK_RESET_FREEZE_BACKUP, axes);
    EXPECT_EQ(std::count(back.order.begin(), back.order.end(), FOREWALK_RESET_PHASE_TURN), 0);
    EXPECT_GT(std::count(back.order.begin(), back.order.end(), FOREWALK_RESET_PHASE_BACKWARD), 0);
  }
}

}  // namespace
}  // namespace forewalk
