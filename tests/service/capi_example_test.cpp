// service/examples/frame.c against the same walk told to the C++ library.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "rdw/session.h"

namespace forewalk {
namespace {

std::string outputOf(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  char chunk[4096];
  while (pipe != nullptr) {
    const std::size_t got = std::fread(chunk, 1, sizeof chunk, pipe);
    if (got == 0) break;
    output.append(chunk, got);
  }
  if (pipe == nullptr || pclose(pipe) != 0) output += "(failed)";
  return output;
}

navmesh::Scene hall() {
  const std::vector<glm::vec3> vertices = {{-8, 0, 8}, {8, 0, 8}, {8, 0, -8}, {-8, 0, -8},
                                           {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2},
                                           {-2, 3, 2}, {2, 3, 2}, {2, 3, -2}, {-2, 3, -2}};
  const std::vector<std::uint32_t> indices = {0, 1,  2, 0, 2, 3,  4, 5,  9,  4, 9, 8, 5, 6, 10,
                                              5, 10, 9, 6, 7, 11, 6, 11, 10, 7, 4, 8, 7, 8, 11};
  return *navmesh::makeScene("hall", vertices, indices);
}

void addBytes(std::uint64_t& hash, const void* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3ull;
  }
}

std::string walkedByTheLibrary(const navmesh::Scene& scene, const rdw::VirtualStart& start) {
  auto world = std::make_shared<const navmesh::World>(
      navmesh::makeWorld(*navmesh::makeNavGraph(navmesh::flatten(*navmesh::buildNavMesh(scene)))));
  rdw::SessionSettings settings;
  settings.space = *rdw::TrackedSpace::rectangle(5.0, 5.0);
  settings.limits = *rdw::gainLimitsByName("laboratory");
  settings.controller = "s2c-predictive";
  settings.start = start;
  auto session = rdw::Session::make(world, settings);
  if (!session) return session.error().message;

  std::string text;
  char line[512];
  std::uint64_t hash = 0xcbf29ce484222325ull;
  double x = 0.0, z = 0.0, heading = 0.0;
  const double dt = 1.0 / 90;
  for (int i = 0; i < 900; ++i) {
    if (i > 0 && session->result().reset.turning) {
      heading += 1.5 * dt;
    } else if (i > 0) {
      heading += 0.4 * std::cos(0.02 * i) * dt;
      x -= 1.1 * dt * std::sin(heading);
      z -= 1.1 * dt * std::cos(heading);
    }
    const rdw::HeadPose head{{static_cast<float>(x), 1.7f, static_cast<float>(z)},
                             glm::quat(static_cast<float>(std::cos(0.5 * heading)), 0.0f,
                                       static_cast<float>(std::sin(0.5 * heading)), 0.0f)};
    const rdw::FrameResult& result = session->frame(head, static_cast<double>(i) / 90);
    const auto& [p, q] = result.virtualPose;
    const float pose[] = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
    addBytes(hash, pose, sizeof pose);
    addBytes(hash, &result.flags, sizeof result.flags);
    if (i % 9 != 0) continue;
    const auto d = [](float value) { return static_cast<double>(value); };
    std::snprintf(line, sizeof line,
                  "%.9g %.9g %.9g  %.9g %.9g %.9g %.9g  curvature %.9g, %u nodes ahead%s\n", d(p.x),
                  d(p.y), d(p.z), d(q.x), d(q.y), d(q.z), d(q.w), d(result.gains.curvature),
                  static_cast<unsigned>(result.graph->nodes.size()),
                  result.reset.turning ? ", turning around" : "");
    text += line;
  }
  std::snprintf(line, sizeof line, "900 frames, %u resets, hash %016llx\n",
                static_cast<unsigned>(session->result().resetCount),
                static_cast<unsigned long long>(hash));
  return text + line;
}

TEST(FrameExample, GivesTheBytesOfTheLibrary) {
  const std::string expected = walkedByTheLibrary(hall(), {{-5.0f, 0.0f, 7.0f}, 0.0f});
  EXPECT_NE(expected.find("turning around"), std::string::npos);
  EXPECT_EQ(outputOf(FOREWALK_FRAME_EXAMPLE), expected);
}

TEST(FrameExample, GivesTheBytesOfTheLibraryInASceneFile) {
  const std::string scene = std::string(FOREWALK_ASSETS) + "/scenes/museum.obj";
  const auto imported = navmesh::importScene(scene);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(outputOf(std::string(FOREWALK_FRAME_EXAMPLE) + " '" + scene + "' 21.5 0 34 1"),
            walkedByTheLibrary(*imported, {{21.5f, 0.0f, 34.0f}, 1.0f}));
}

TEST(FrameExample, SaysWhatWasRefused) {
  const std::string output =
      outputOf(std::string(FOREWALK_FRAME_EXAMPLE) + " no-such-scene.obj 0 0 0 0 2>&1");
  EXPECT_NE(output.find("navmesh: no-such-scene.obj"), std::string::npos) << output;
  EXPECT_NE(output.find("(failed)"), std::string::npos);
}

}  // namespace
}  // namespace forewalk
