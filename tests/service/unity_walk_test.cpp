// Walks told to the Unity package under Mono, frame by frame against C++, to the last bit.
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "navmesh/build/scene.h"
#include "rdw/session.h"
#include "rdw/walk_file.h"
#include "service/capi/axes.h"
#include "tests/service/capi_support.h"
#include "tests/support/program_test.h"

namespace forewalk {
namespace {

using testing::TimedHead;

struct UnityWalk : testing::ProgramTest {};

/// Who walks where, steered how.
struct Plan {
  navmesh::Scene scene;
  forewalk_controller controller;
  forewalk_method method;
  float room;  // side, metres
  float horizon;
  rdw::VirtualStart start;  // our axes
};

/// The library below the C interface, set up as `plan` says.
rdw::Session librarySession(const Plan& plan) {
  rdw::SessionSettings settings;
  settings.space = *rdw::TrackedSpace::rectangle(plan.room, plan.room);
  settings.limits = *rdw::gainLimitsByName("laboratory");
  settings.controller = rdw::controllerNames()[static_cast<std::size_t>(plan.controller)];
  settings.method = static_cast<prediction::Method>(plan.method);
  settings.horizon = plan.horizon;
  settings.start = plan.start;
  settings.alwaysLikely = true;
  return *rdw::Session::make(testing::makeWorld(plan.scene), settings);
}

/// The scene as Unity has it: z the other way, triangles clockwise.
testing::SceneArrays unityArrays(const navmesh::Scene& scene) {
  testing::SceneArrays arrays = testing::arraysOf(scene);
  for (std::size_t i = 2; i < arrays.vertices.size(); i += 3)
    arrays.vertices[i] = -arrays.vertices[i];
  for (std::size_t i = 0; i + 2 < arrays.indices.size(); i += 3)
    std::swap(arrays.indices[i + 1], arrays.indices[i + 2]);
  return arrays;
}

forewalk_session_settings unitySettings(const Plan& plan) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.axes = FOREWALK_AXES_UNITY;
  settings.controller = plan.controller;
  settings.limits = FOREWALK_LIMITS_LABORATORY;
  settings.method = plan.method;
  settings.horizon = plan.horizon;
  settings.likelihoods = 1;
  settings.width = settings.depth = plan.room;
  settings.has_start = 1;
  settings.start_floor = capi::positionToUnity(plan.start.floor);
  settings.start_heading = -plan.start.heading;
  return settings;
}

/// Somebody who walks on in a wavy line, does what resets ask, and nods.
std::vector<TimedHead> obedientWalk(const Plan& plan, int frames) {
  rdw::Session session = librarySession(plan);
  std::vector<TimedHead> heads;
  double heading = 0.0;
  glm::dvec2 place(0.0);
  constexpr double kDt = 1.0 / 90.0;
  for (int i = 0; i < frames; ++i) {
    switch (i == 0 ? rdw::ResetInstruction::kNone : session.result().reset.instruction) {
      case rdw::ResetInstruction::kNone:
        heading += 0.6 * std::cos(0.013 * i) * kDt;
        place += 1.1 * kDt * rdw::directionOf(heading);
        break;
      case rdw::ResetInstruction::kWalkBack:
        place -= 0.5 * kDt * place;
        break;
      default:
        heading += 1.5 * kDt;
    }
    const glm::dquat nod = glm::angleAxis(0.2 * std::sin(0.05 * i), glm::dvec3(1, 0, 0));
    heads.push_back({{navmesh::toSpace(glm::vec2(place), 1.7f),
                      glm::quat(glm::angleAxis(heading, glm::dvec3(0, 1, 0)) * nod)},
                     i * kDt});
    session.frame(heads.back().pose, heads.back().seconds);
  }
  return heads;
}

class Writer {
 public:
  explicit Writer(const std::filesystem::path& file) : out_(file, std::ios::binary) {}
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    out_.write(reinterpret_cast<const char*>(&value), sizeof value);
  }

 private:
  std::ofstream out_;
};

/// What tests/service/unity/Walks.cs reads.
void writeWalk(const std::filesystem::path& file, const Plan& plan,
               const std::vector<TimedHead>& heads) {
  Writer writer(file);
  const forewalk_session_settings settings = unitySettings(plan);
  for (const std::int32_t number :
       {settings.controller, settings.limits, settings.method, settings.reset}) {
    writer.put(number);
  }
  writer.put(settings.horizon);
  writer.put(settings.width);
  writer.put(settings.depth);
  writer.put(settings.start_floor);
  writer.put(settings.start_heading);
  const testing::SceneArrays arrays = unityArrays(plan.scene);
  writer.put(static_cast<std::int32_t>(arrays.vertices.size() / 3));
  for (const float coordinate : arrays.vertices) writer.put(coordinate);
  writer.put(static_cast<std::int32_t>(arrays.indices.size()));
  for (const std::uint32_t index : arrays.indices) writer.put(index);
  writer.put(static_cast<std::int32_t>(heads.size()));
  for (const TimedHead& head : heads) {
    writer.put(capi::poseToUnity(head.pose));
    writer.put(head.seconds);
  }
}

/// As Walks.cs hashes a graph: FNV-1a over words.
class Hash {
 public:
  void add(std::uint32_t word) { value_ = (value_ ^ word) * 0x100000001b3ull; }
  void add(float number) {
    std::uint32_t word;
    std::memcpy(&word, &number, sizeof word);
    add(word);
  }
  void add(const forewalk_vec3& point) {
    add(point.x);
    add(point.y);
    add(point.z);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

std::uint64_t hashOf(const forewalk_graph_view& view) {
  Hash hash;
  for (std::uint32_t i = 0; i < view.node_count; ++i) {
    const forewalk_node& node = view.nodes[i];
    hash.add(node.position);
    hash.add(node.distance);
    for (const std::uint32_t word : {node.prev, node.polygon, std::uint32_t{node.kind},
                                     std::uint32_t{node.reason}, std::uint32_t{node.branch}}) {
      hash.add(word);
    }
  }
  for (std::uint32_t i = 0; i < view.edge_count; ++i) {
    const forewalk_edge& edge = view.edges[i];
    hash.add(edge.from);
    hash.add(edge.to);
    hash.add(edge.length);
    hash.add(static_cast<std::uint32_t>(edge.loop));
    hash.add(view.widths[i]);
    for (std::uint32_t p = 0; p < edge.path_count; ++p) hash.add(view.points[edge.path_start + p]);
  }
  for (std::uint32_t i = 0; i < view.point_count; ++i) hash.add(view.points[i]);
  for (std::uint32_t i = 0; i < view.front_count; ++i) {
    hash.add(view.fronts[i].node);
    hash.add(view.fronts[i].length);
    hash.add(view.fronts[i].from);
    hash.add(view.fronts[i].to);
  }
  for (std::uint32_t i = 0; i < view.way_count; ++i) {
    hash.add(view.ways[i].id);
    hash.add(view.ways[i].node);
    hash.add(view.ways[i].likelihood);
    hash.add(std::uint32_t{view.ways[i].born});
  }
  for (std::uint32_t i = 0; i < view.way_event_count; ++i) {
    hash.add(view.way_events[i].way);
    hash.add(view.way_events[i].other);
    hash.add(std::uint32_t{view.way_events[i].change});
  }
  hash.add(view.horizon);
  hash.add(view.complete_to);
  hash.add(view.likelihood_none);
  hash.add(static_cast<std::uint32_t>(view.method));
  return hash.value();
}

template <typename T>
std::string bytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// One frame of the output file.
struct Answer {
  forewalk_frame_out out;
  std::uint64_t graph;
};

std::vector<Answer> answersIn(const std::string& bytes) {
  constexpr std::size_t kSize = sizeof(forewalk_frame_out) + sizeof(std::uint64_t);
  EXPECT_EQ(bytes.size() % kSize, 0u);
  std::vector<Answer> answers(bytes.size() / kSize);
  const char* at = bytes.data();
  for (Answer& answer : answers) {
    std::memcpy(&answer.out, at, sizeof answer.out);
    std::memcpy(&answer.graph, at + sizeof answer.out, sizeof answer.graph);
    at += kSize;
  }
  return answers;
}

/// What does not depend on the clock.
forewalk_frame_out timeless(forewalk_frame_out out) {
  out.predict_seconds = out.steer_seconds = 0.0f;
  return out;
}

/// Every answer against the C interface, all its bytes, and against the library below it.
void expectTheAnswersOfCpp(const Plan& plan, const std::vector<TimedHead>& heads,
                           const std::vector<Answer>& answers) {
  ASSERT_EQ(answers.size(), heads.size());
  const auto navmesh = testing::makeNavMesh(unityArrays(plan.scene), FOREWALK_AXES_UNITY);
  const auto session = testing::makeSession(navmesh, unitySettings(plan));
  rdw::Session library = librarySession(plan);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const auto& [out, graph] = answers[i];
    const forewalk_pose head = capi::poseToUnity(heads[i].pose);
    forewalk_frame_out same{};
    same.struct_size = sizeof same;
    ASSERT_EQ(
        forewalk_frame(session.get(), head.position, head.orientation, heads[i].seconds, &same),
        FOREWALK_OK);
    ASSERT_EQ(bytesOf(timeless(out)), bytesOf(timeless(same))) << "frame " << i;
    forewalk_graph_view view{};
    view.struct_size = sizeof view;
    ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
    ASSERT_EQ(graph, hashOf(view)) << "frame " << i;

    const rdw::FrameResult& result = library.frame(heads[i].pose, heads[i].seconds);
    ASSERT_EQ(bytesOf(out.virtual_pose), bytesOf(capi::poseToUnity(result.virtualPose))) << i;
    ASSERT_EQ(out.flags, result.flags);
    ASSERT_EQ(out.translation, result.gains.translation);
    ASSERT_EQ(out.rotation, result.gains.rotation);
    ASSERT_EQ(out.curvature, -result.gains.curvature);
    ASSERT_EQ(out.injected_yaw, -static_cast<float>(result.injectedYaw));
    ASSERT_EQ(out.resetting != 0, result.reset.turning);
    ASSERT_EQ(out.reset_remaining, static_cast<float>(result.reset.remaining));
    ASSERT_EQ(out.reset_count, result.resetCount);
    ASSERT_EQ(out.graph_nodes, result.graph->nodes.size());
  }
  std::printf("%zu frames, %u resets: every bit of C++'s\n", heads.size(),
              answers.back().out.reset_count);
}

TEST_F(UnityWalk, GivesEveryBitOfCpp) {
  auto museum = navmesh::importScene(FOREWALK_ASSETS "/scenes/museum.obj");
  ASSERT_TRUE(museum) << museum.error().message;
  Plan plan{*museum, FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_METHOD_POLYGON, 5.0f,
            15.0f,   {{21.5f, 0.0f, 34.0f}, 1.0f}};
  for (const forewalk_method method : {FOREWALK_METHOD_POLYGON, FOREWALK_METHOD_FRONT}) {
    plan.method = method;
    const std::vector<TimedHead> heads = obedientWalk(plan, 2500);
    writeWalk(folder_ / "walk", plan, heads);
    const testing::Outcome outcome = run("walk walk answers");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::vector<Answer> answers = answersIn(contents("answers"));
    expectTheAnswersOfCpp(plan, heads, answers);
    EXPECT_GT(answers.back().out.reset_count, 2u);
    EXPECT_THAT(outcome.out, ::testing::HasSubstr("2500 frames"));
  }
}

// A person's walk, told as it was recorded: they pay no heed to the resets they are told.
TEST_F(UnityWalk, GivesEveryBitOfCppOnARecordedWalk) {
  const std::string folder = std::string(FOREWALK_SHARED_DATA) + "/walks/searching-a/";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "the recorded walks are not here: " << folder;
  auto scene = navmesh::importScene(folder + "scene.obj");
  ASSERT_TRUE(scene) << scene.error().message;
  const std::string csv = testing::contentsOf(folder + "walks.csv");
  const auto walks = rdw::parseWalks(std::as_bytes(std::span(csv)), "walks.csv");
  ASSERT_TRUE(walks) << walks.error().message;
  std::vector<TimedHead> heads = testing::recordedHeads(walks->front(), 90.0);
  heads.resize(std::min<std::size_t>(heads.size(), 5000));
  const rdw::PlanarPose first = rdw::planarPose(heads.front().pose);
  const Plan plan{
      *scene,
      FOREWALK_CONTROLLER_S2O_PREDICTIVE,
      FOREWALK_METHOD_POLYGON,
      8.0f,
      10.0f,
      {navmesh::toSpace(glm::vec2(first.position), 0.0f), static_cast<float>(first.heading)}};
  writeWalk(folder_ / "walk", plan, heads);
  const testing::Outcome outcome = run("walk walk answers");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::vector<Answer> answers = answersIn(contents("answers"));
  expectTheAnswersOfCpp(plan, heads, answers);
  EXPECT_GT(heads.size(), 2000u);
  EXPECT_GT(answers.back().out.reset_count, 0u);
}

}  // namespace
}  // namespace forewalk
