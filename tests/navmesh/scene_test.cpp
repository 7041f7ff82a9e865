// The mesh file readers: the same room through every format, and files damaged in every way.
#include "navmesh/build/scene.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <locale>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace forewalk::navmesh {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Mesh {
  std::vector<glm::vec3> vertices;
  std::vector<std::vector<std::uint32_t>> faces;
};

/// A room of 4 m x 3 m: floor and ceiling as quads, walls as triangles, numbers that need rounding.
Mesh room() {
  Mesh mesh;
  for (const float y : {0.1f, 2.5f}) {
    mesh.vertices.insert(mesh.vertices.end(),
                         {{0.3f, y, -0.7f}, {4.3f, y, -0.7f}, {4.3f, y, -3.7f}, {0.3f, y, -3.7f}});
  }
  mesh.faces = {{0, 1, 2, 3}, {7, 6, 5, 4}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    mesh.faces.push_back({i, i + 4, j});
    mesh.faces.push_back({j, i + 4, j + 4});
  }
  return mesh;
}

/// Each triangle's corners, the smallest first, winding kept; sorted. Equal for equal surfaces.
std::vector<std::array<float, 9>> surface(const Scene& scene) {
  std::vector<std::array<float, 9>> result;
  for (const glm::uvec3& t : scene.triangles) {
    std::array<std::array<float, 3>, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 v = scene.vertices[t[i]];
      corners[static_cast<std::size_t>(i)] = {v.x, v.y, v.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<float, 9> flat;
    for (std::size_t i = 0; i < 9; ++i) flat[i] = corners[i / 3][i % 3];
    result.push_back(flat);
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// The mesh's surface without any reader: its faces are convex, so a fan from the first corner.
std::vector<std::array<float, 9>> surface(const Mesh& mesh) {
  std::vector<std::uint32_t> indices;
  for (const auto& face : mesh.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      indices.insert(indices.end(), {face[0], face[i], face[i + 1]});
    }
  }
  return surface(makeScene("room", mesh.vertices, indices).value());
}

/// Shortest decimal form that gives the same float.
std::string text(float value) {
  std::string result(32, '\0');
  result.resize(static_cast<std::size_t>(
      std::snprintf(result.data(), result.size(), "%.9g", static_cast<double>(value))));
  return result;
}

std::string text(glm::vec3 v) { return text(v.x) + " " + text(v.y) + " " + text(v.z); }

template <typename T>
void append(std::string& bytes, T value, bool big = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));  // tests run on little-endian machines
  if (big) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string obj(const Mesh& mesh) {
  std::string result = "# room\nmtllib no_such_file.mtl\no room\n";
  for (const glm::vec3& v : mesh.vertices) result += "v " + text(v) + "\n";
  result += "vt 0 0\nvn 0 1 0\nusemtl none\n";
  for (const auto& face : mesh.faces) {
    result += "f";
    for (const std::uint32_t corner : face) {
      result += ' ';
      result += std::to_string(corner + 1);
      result += "/1/1";
    }
    result += "\n";
  }
  return result;
}

std::string off(const Mesh& mesh) {
  std::string result = "OFF\n# room\n" + std::to_string(mesh.vertices.size()) + " " +
                       std::to_string(mesh.faces.size()) + " 0\n";
  for (const glm::vec3& v : mesh.vertices) result += text(v) + "\n";
  for (const auto& face : mesh.faces) {
    result += std::to_string(face.size());
    for (const std::uint32_t corner : face) {
      result += ' ';
      result += std::to_string(corner);
    }
    result += " 255 0 0\n";
  }
  return result;
}

enum class Ply { kText, kLittle, kBig };

/// With what real exporters add: normals, colours, lists of texture coordinates, elements of their
/// own.
std::string ply(const Mesh& mesh, Ply kind) {
  const bool big = kind == Ply::kBig;
  std::string result =
      std::string("ply\nformat ") +
      (kind == Ply::kText ? "ascii"
       : big              ? "binary_big_endian"
                          : "binary_little_endian") +
      " 1.0\ncomment room\nelement camera 1\nproperty list uchar float pose\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty uchar red\nproperty float x\nproperty float y\nproperty double z\n"
      "element face " +
      std::to_string(mesh.faces.size()) +
      "\nproperty list uchar float texcoord\nproperty list ushort int vertex_indices\n"
      "end_header\n";
  const auto put = [&](auto value) {
    if (kind != Ply::kText) return append(result, value, big);
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      result += text(static_cast<float>(value)) + " ";
    } else {
      result += std::to_string(value) + " ";
    }
  };
  put(std::uint8_t{2});
  put(0.5f);
  put(0.5f);
  for (const glm::vec3& v : mesh.vertices) {
    put(std::uint8_t{200});
    put(v.x);
    put(v.y);
    put(static_cast<double>(v.z));
  }
  for (const auto& face : mesh.faces) {
    put(std::uint8_t{1});
    put(0.25f);
    put(static_cast<std::uint16_t>(face.size()));
    for (const std::uint32_t corner : face) put(static_cast<std::int32_t>(corner));
  }
  return result;
}

std::string stlText(const Mesh& mesh) {
  std::string result = "solid outer room\n";
  for (const auto& face : mesh.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      result += "facet normal 0 1 0\n  outer loop\n";
      for (const std::uint32_t corner : {face[0], face[i], face[i + 1]}) {
        result += "    vertex " + text(mesh.vertices[corner]) + "\n";
      }
      result += "  endloop\nendfacet\n";
    }
  }
  return result + "endsolid\n";
}

std::string stlBinary(const Mesh& mesh) {
  std::string triangles;
  std::uint32_t count = 0;
  for (const auto& face : mesh.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i, ++count) {
      triangles.append(12, '\0');
      for (const std::uint32_t corner : {face[0], face[i], face[i + 1]}) {
        for (int axis = 0; axis < 3; ++axis) append(triangles, mesh.vertices[corner][axis]);
      }
      triangles.append(2, '\0');
    }
  }
  std::string result = "solid, says the header of a binary file";
  result.resize(80, ' ');
  append(result, count);
  return result + triangles;
}

tl::expected<Scene, Error> read(const std::string& file, SceneFormat format,
                                const ImportSettings& settings = {}) {
  return importScene(std::as_bytes(std::span<const char>(file)), format, "room", settings);
}

struct Written {
  const char* name;
  SceneFormat format;
  std::function<std::string(const Mesh&)> write;
};

const Written kWritten[] = {
    {"OBJ", SceneFormat::kObj, obj},
    {"OFF", SceneFormat::kOff, off},
    {"text PLY", SceneFormat::kPly, [](const Mesh& m) { return ply(m, Ply::kText); }},
    {"little-endian PLY", SceneFormat::kPly, [](const Mesh& m) { return ply(m, Ply::kLittle); }},
    {"big-endian PLY", SceneFormat::kPly, [](const Mesh& m) { return ply(m, Ply::kBig); }},
    {"text STL", SceneFormat::kStl, stlText},
    {"binary STL", SceneFormat::kStl, stlBinary}};

/// The message of a refusal with this code; fails the test otherwise.
std::string refusal(const tl::expected<Scene, Error>& scene, ErrorCode code) {
  if (scene) {
    ADD_FAILURE() << "read " << scene->triangles.size() << " triangles";
    return {};
  }
  EXPECT_EQ(scene.error().code, code) << scene.error().message;
  EXPECT_THAT(scene.error().message, Not(HasSubstr("\n")));
  return scene.error().message;
}

class QuietTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
  }
  void TearDown() override {
    const std::string errors = ::testing::internal::GetCapturedStderr();
    const std::string output = ::testing::internal::GetCapturedStdout();
    if (IsSkipped()) return;  // GoogleTest says so on stdout
    EXPECT_EQ(errors, "");
    EXPECT_EQ(output, "");
  }
};

using SceneImport = QuietTest;
using MakeScene = QuietTest;

TEST_F(SceneImport, RefusesNoBytesInEveryFormat) {
  for (const SceneFormat format : {SceneFormat::kObj, SceneFormat::kOff, SceneFormat::kPly,
                                   SceneFormat::kStl, SceneFormat::kGltf, SceneFormat::kGlb}) {
    refusal(read("", format), ErrorCode::kSceneEmpty);
  }
}

TEST_F(SceneImport, GivesTheSameRoomFromEveryFormat) {
  for (const Written& w : kWritten) {
    const auto scene = read(w.write(room()), w.format);
    ASSERT_TRUE(scene) << w.name << ": " << scene.error().message;
    EXPECT_EQ(surface(*scene), surface(room())) << w.name;
    EXPECT_EQ(scene->name, "room");
  }
}

TEST_F(SceneImport, KeepsEveryFaceWhereManyShareAnEdge) {
  Mesh fan;
  fan.vertices = {{0, 0, 0}, {0, 1, 0}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const float angle = static_cast<float>(i);
    fan.vertices.emplace_back(std::cos(angle), 0.0f, std::sin(angle));
    fan.faces.push_back({0, 1, i + 2});
    fan.faces.push_back({0, 1, i + 2});  // and one twice
  }
  for (const Written& w : kWritten) {
    const auto scene = read(w.write(fan), w.format);
    ASSERT_TRUE(scene) << w.name << ": " << scene.error().message;
    EXPECT_EQ(surface(*scene), surface(fan)) << w.name;
  }
}

TEST_F(SceneImport, AppliesUnitAndUpAxis) {
  for (const Written& w : kWritten) {
    const auto plain = read(w.write(room()), w.format);
    const auto scaled = read(w.write(room()), w.format, {0.25f, UpAxis::kZ});
    ASSERT_TRUE(plain && scaled) << w.name;
    ASSERT_EQ(plain->vertices.size(), scaled->vertices.size());
    EXPECT_EQ(plain->triangles, scaled->triangles);
    for (std::size_t i = 0; i < plain->vertices.size(); ++i) {
      const glm::vec3 v = plain->vertices[i];
      EXPECT_EQ(scaled->vertices[i], glm::vec3(v.x, v.z, -v.y) * 0.25f) << w.name;
    }
  }
}

TEST_F(SceneImport, RefusesUnitsThatCannotWork) {
  for (const float unit : {0.0f, -1.0f, std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THAT(refusal(read(obj(room()), SceneFormat::kObj, {unit, UpAxis::kY}),
                        ErrorCode::kSettingOutOfRange),
                HasSubstr("metresPerUnit"));
  }
  EXPECT_THAT(refusal(read("v 1e38 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n", SceneFormat::kObj,
                           {1000.0f, UpAxis::kY}),
                      ErrorCode::kDataDamaged),
              HasSubstr("vertex 0"));
}

TEST_F(SceneImport, CutsAConcaveFaceAlongItsInside) {
  // An L of 3 m^2; a fan from its first corner would cover 4 m^2 and more.
  Mesh ell;
  ell.vertices = {{1, 0, -2}, {0, 0, -2}, {0, 0, 0}, {2, 0, 0}, {2, 0, -1}, {1, 0, -1}};
  for (std::uint32_t first = 0; first < 6; ++first) {
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < 6; ++i) ring.push_back((first + i) % 6);
    for (const bool down : {false, true}) {
      if (down) std::reverse(ring.begin(), ring.end());
      ell.faces = {ring};
      const auto scene = read(off(ell), SceneFormat::kOff);
      ASSERT_TRUE(scene);
      float area = 0.0f;
      for (const glm::uvec3& t : scene->triangles) {
        const glm::vec3 a = scene->vertices[t.x];
        const glm::vec3 up = glm::cross(scene->vertices[t.y] - a, scene->vertices[t.z] - a);
        EXPECT_EQ(up.y > 0.0f, !down) << "every triangle is wound as the face";
        area += 0.5f * glm::length(up);
      }
      EXPECT_EQ(scene->triangles.size(), 4u);
      EXPECT_FLOAT_EQ(area, 3.0f) << "first corner " << first;
    }
  }
}

TEST_F(SceneImport, ReadsWhatObjAllows) {
  const std::string unusual =
      "v 0 0 0\r\nv +1e0 0. .0 1.0\r\nf -1 \\\r\n 3 -2 # later vertex\r\n\tv 0 0 1 0.5 0.5 0.5\r\n"
      "f 1//1 1//1 2\r\np 1\r\nl 1 2\r\ncurv 0 1 1 2";
  const auto scene = read(unusual, SceneFormat::kObj);
  ASSERT_TRUE(scene) << scene.error().message;
  const std::vector<glm::vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> indices{1, 2, 0};
  EXPECT_EQ(surface(*scene), surface(makeScene("", vertices, indices).value()));
}

TEST_F(SceneImport, NamesLineElementAndValue) {
  const auto message = [](const std::string& file, SceneFormat format) {
    return refusal(read(file, format), ErrorCode::kDataDamaged);
  };
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 0 1\n";
  EXPECT_THAT(message(three + "f 1 2 3\nf 1 2 4\n", SceneFormat::kObj),
              HasSubstr("room:5: face 2 names vertex 4, the file has 3"));
  EXPECT_THAT(message(three + "f 1 2 -4\n", SceneFormat::kObj),
              HasSubstr("room:4: face 1 names vertex \"-4\""));
  EXPECT_THAT(message(three + "f 0 1 2\n", SceneFormat::kObj), HasSubstr("\"0\""));
  EXPECT_THAT(message(three + "f 1 2 x\n", SceneFormat::kObj), HasSubstr("\"x\""));
  EXPECT_THAT(message(three + "f 1 2 99999999999999999999\n", SceneFormat::kObj),
              HasSubstr("room:4"));
  EXPECT_THAT(message(three + "f 1 2\n", SceneFormat::kObj),
              HasSubstr("room:4: face 1 has 2 corners"));
  EXPECT_THAT(message("v 0 0\n", SceneFormat::kObj), HasSubstr("room:1: vertex 1 has z missing"));
  for (const char* bad : {"nan", "NaN", "inf", "-inf", "1e39", "1e999", "0x10", "1,5", "1.5f",
                          "--1", "+-1", "++1", "+", "\x80"}) {
    EXPECT_THAT(message(three + "v 0 " + bad + " 0\nf 1 2 3\n", SceneFormat::kObj),
                HasSubstr("room:4: vertex 4 has y \""))
        << bad;
    EXPECT_THAT(message(std::string("OFF\n3 1 0\n0 0 0\n1 0 ") + bad + "\n0 0 1\n3 0 1 2\n",
                        SceneFormat::kOff),
                HasSubstr("room:4: vertex 1 has z \""))
        << bad;
    EXPECT_THAT(
        message(std::string("solid\nfacet normal 0 0 0\nouter loop\nvertex ") + bad + " 0 0\n",
                SceneFormat::kStl),
        HasSubstr("room:4: triangle 0: vertex 0 has x \""))
        << bad;
  }
  EXPECT_THAT(message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 0 1\n3 0 1 3\n", SceneFormat::kOff),
              HasSubstr("room:6: face 0 names vertex \"3\", the file has 3"));
  EXPECT_THAT(message("OFF\n-3 1 0\n", SceneFormat::kOff), HasSubstr("vertex count is \"-3\""));
  EXPECT_THAT(message("OFF\n3 99999999999 0\n", SceneFormat::kOff), HasSubstr("face count"));
  EXPECT_THAT(message("OFF\n2000000000 1 0\n0 0 0\n", SceneFormat::kOff),
              HasSubstr("ends early, after 1 of 2000000000 vertices"));
  EXPECT_THAT(message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 0 1\n4 0 1 2\n", SceneFormat::kOff),
              HasSubstr("face 0 has 4 corners, the line names 3"));
  EXPECT_THAT(message("solid\nfacet normal 0 0 0\nvertex 0 0 0\n", SceneFormat::kStl),
              HasSubstr("room:3: \"vertex 0 0 0\" does not belong here"));

  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  EXPECT_THAT(message(head + "0 0 0\n1 0 0\n0 0 1\n3 0 1 3\n", SceneFormat::kPly),
              HasSubstr("room:13: face 0 names vertex \"3\", the file has 3"));
  EXPECT_THAT(message(head + "0 0 0\n1 nan 0\n0 0 1\n3 0 1 2\n", SceneFormat::kPly),
              HasSubstr("room:11: vertex 1 has y \"nan\""));
  EXPECT_THAT(message(head + "0 0 0\n1 0 0\n0 0 1\n-3 0 1 2\n", SceneFormat::kPly),
              HasSubstr("\"-3\""));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex -3\n", SceneFormat::kPly),
              HasSubstr("room:3: element \"vertex\" has a count of -3"));
}

TEST_F(SceneImport, NamesTheElementInBinaryFiles) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Mesh mesh = room();
  mesh.vertices[6].y = nan;
  for (const Ply kind : {Ply::kLittle, Ply::kBig}) {
    EXPECT_THAT(refusal(read(ply(mesh, kind), SceneFormat::kPly), ErrorCode::kDataDamaged),
                HasSubstr("room: vertex 6 has y nan"));
  }
  EXPECT_THAT(refusal(read(stlBinary(mesh), SceneFormat::kStl), ErrorCode::kDataDamaged),
              AllOf(HasSubstr("room: triangle 2"), HasSubstr("y nan")));
  mesh = room();
  mesh.faces[3][1] = 8;
  for (const Ply kind : {Ply::kLittle, Ply::kBig}) {
    EXPECT_THAT(refusal(read(ply(mesh, kind), SceneFormat::kPly), ErrorCode::kDataDamaged),
                HasSubstr("face 3 names vertex 8, the file has 8"));
  }
  mesh.faces[3][1] = 0xffffffffu;
  EXPECT_THAT(refusal(read(ply(mesh, Ply::kLittle), SceneFormat::kPly), ErrorCode::kDataDamaged),
              HasSubstr("vertex -1"));
}

TEST_F(SceneImport, RefusesEveryTruncation) {
  for (const Written& w : kWritten) {
    const std::string whole = w.write(room());
    const auto expected = surface(room());
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const auto scene = read(whole.substr(0, length), w.format);
      if (!scene) continue;
      // Text that ends within its last words may still be whole; OBJ never says how much it has.
      const bool text = whole.find('\0') == std::string::npos;
      EXPECT_TRUE(text && (w.format == SceneFormat::kObj || surface(*scene) == expected ||
                           length + 16 > whole.size()))
          << w.name << " cut to " << length << " of " << whole.size();
    }
  }
}

TEST_F(SceneImport, RefusesFilesWithoutFaces) {
  Mesh points = room();
  points.faces.clear();
  for (const Written& w : kWritten)
    refusal(read(w.write(points), w.format), ErrorCode::kSceneEmpty);
  refusal(read("hello, world\n", SceneFormat::kObj), ErrorCode::kSceneEmpty);
  refusal(read("v 0 0 0\nv 1 0 0\nf 1 2 1\n", SceneFormat::kObj), ErrorCode::kSceneEmpty);
}

TEST_F(SceneImport, NamesWhatItDoesNotRead) {
  const auto message = [](const std::string& file, SceneFormat format) {
    return refusal(read(file, format), ErrorCode::kFormatUnsupported);
  };
  EXPECT_THAT(message("OFF BINARY\n", SceneFormat::kOff), HasSubstr("OFF BINARY"));
  EXPECT_THAT(message("4OFF\n1 1 0\n", SceneFormat::kOff), HasSubstr("4OFF"));
  EXPECT_THAT(message("ply\nformat ascii 2.0\n", SceneFormat::kPly), HasSubstr("2.0"));
  refusal(read("solid", SceneFormat::kPly), ErrorCode::kFormatUnknown);
  refusal(read("solid", SceneFormat::kOff), ErrorCode::kFormatUnknown);
}

TEST_F(SceneImport, DoesNotFollowTheProgramsLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  for (const Written& w : kWritten) {
    const auto scene = read(w.write(room()), w.format);
    EXPECT_TRUE(scene && surface(*scene) == surface(room())) << w.name;
  }
  std::locale::global(before);
}

TEST_F(SceneImport, ReadsOnManyThreadsAtOnce) {
  std::vector<std::thread> threads;
  std::array<bool, 8> same{};
  for (std::size_t i = 0; i < same.size(); ++i) {
    threads.emplace_back([&same, i] {
      same[i] = true;
      for (int round = 0; round < 20; ++round) {
        const Written& w = kWritten[(i + static_cast<std::size_t>(round)) % std::size(kWritten)];
        const auto scene = read(w.write(room()), w.format);
        same[i] = same[i] && scene && surface(*scene) == surface(room());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(same, ::testing::Each(true));
}

TEST_F(SceneImport, TakesTheFormatFromTheEnding) {
  EXPECT_EQ(sceneFormatOf("a/b.c/ROOM.OBJ").value(), SceneFormat::kObj);
  EXPECT_EQ(sceneFormatOf("room.Off").value(), SceneFormat::kOff);
  EXPECT_EQ(sceneFormatOf("room.ply").value(), SceneFormat::kPly);
  EXPECT_EQ(sceneFormatOf("room.sTL").value(), SceneFormat::kStl);
  EXPECT_EQ(sceneFormatOf("room.gltf").value(), SceneFormat::kGltf);
  EXPECT_EQ(sceneFormatOf("room.tar.GLB").value(), SceneFormat::kGlb);
  for (const char* wrong : {"", "obj", "room", "room.fbx", "room.obj.gz", "room."}) {
    const auto format = sceneFormatOf(wrong);
    ASSERT_FALSE(format) << wrong;
    EXPECT_EQ(format.error().code, ErrorCode::kFormatUnknown);
  }
}

TEST_F(SceneImport, ReadsAFileAsItsBytes) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("forewalk-scene-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto file = folder / "room.obj";
  std::ofstream(file, std::ios::binary) << obj(room());
  const auto scene = importScene(file);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(surface(*scene), surface(room()));
  EXPECT_EQ(scene->name, file.string());
  refusal(importScene(folder / "none.obj"), ErrorCode::kFileUnreadable);
  std::filesystem::create_directories(folder / "folder.obj");
  refusal(importScene(folder / "folder.obj"), ErrorCode::kFileUnreadable);
  refusal(importScene(folder / "room.txt"), ErrorCode::kFormatUnknown);
  std::filesystem::remove_all(folder);
}

TEST_F(SceneImport, ReadsARealScene) {
  const std::filesystem::path file = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const auto scene = importScene(file);
  ASSERT_TRUE(scene) << scene.error().message;
  // Counted by a reader of its own: one vertex a line, and corners - 2 triangles a face.
  std::ifstream in(file);
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (std::string word, line; std::getline(in, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") ++vertices;
    if (word != "f") continue;
    std::size_t corners = 0;
    while (words >> word) ++corners;
    triangles += corners - 2;
  }
  EXPECT_EQ(scene->vertices.size(), vertices);
  EXPECT_EQ(scene->triangles.size(), triangles);
}

TEST_F(MakeScene, RefusesWhatIsNoScene) {
  const std::vector<glm::vec3> three{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const auto code = [&](std::vector<glm::vec3> vertices, std::vector<std::uint32_t> indices) {
    const auto scene = makeScene("engine", vertices, indices);
    return scene ? ErrorCode{} : scene.error().code;
  };
  EXPECT_EQ(code({}, {}), ErrorCode::kSceneEmpty);
  EXPECT_EQ(code(three, {}), ErrorCode::kSceneEmpty);
  EXPECT_EQ(code(three, {0, 1}), ErrorCode::kDataDamaged);
  EXPECT_EQ(code(three, {0, 1, 3}), ErrorCode::kDataDamaged);
  EXPECT_EQ(code(three, {0, 1, 0xffffffffu}), ErrorCode::kDataDamaged);
  EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 0, std::nanf("")}}, {0, 1, 2}),
            ErrorCode::kDataDamaged);
  EXPECT_EQ(code(three, {0, 1, 2}), ErrorCode{});
}

}  // namespace
}  // namespace forewalk::navmesh
