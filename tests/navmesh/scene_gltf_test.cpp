// glTF through every way of saying the same triangles, and files that lie.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "navmesh/build/scene.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr int kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126;
constexpr int kTriangles = 4, kStrip = 5, kFan = 6;

/// A quad that is not symmetric, as a strip's corners: triangles 0 1 2 and 1 3 2.
const std::vector<glm::vec3> kCorners{{0.25f, 0, 0}, {2, 0, 0}, {0, 1, -3}, {2, 1, -4}};
const std::vector<std::uint32_t> kIndices{0, 1, 2, 1, 3, 2};

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

std::vector<std::array<float, 9>> quad() {
  return surface(makeScene("quad", kCorners, kIndices).value());
}

/// A file in the making: its JSON, and one buffer.
struct File {
  Json json;
  std::string bin;
};

/// Appends one accessor; `stride` 0 packs its elements tightly.
template <typename T>
int addAccessor(File& file, const std::vector<T>& values, int component, std::size_t stride = 0) {
  constexpr bool kPosition = std::is_same_v<T, glm::vec3>;
  const std::size_t size = kPosition ? 12 : component == kByte ? 1 : component == kShort ? 2 : 4;
  const std::size_t lead = stride == 0 ? 0 : 8;  // an offset inside the view
  const std::size_t step = stride == 0 ? size : stride;
  file.bin.append((4 - file.bin.size() % 4) % 4, '\x7f');
  const std::size_t start = file.bin.size();
  file.bin.append(lead + step * (values.size() - 1) + size, '\x7f');
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::memcpy(file.bin.data() + start + lead + i * step, &values[i], size);
  }
  Json view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", file.bin.size() - start}};
  if (stride != 0) view["byteStride"] = stride;
  file.json["bufferViews"].push_back(view);
  file.json["accessors"].push_back({{"bufferView", file.json["bufferViews"].size() - 1},
                                    {"byteOffset", lead},
                                    {"componentType", component},
                                    {"count", values.size()},
                                    {"type", kPosition ? "VEC3" : "SCALAR"}});
  return static_cast<int>(file.json["accessors"].size()) - 1;
}

/// One mesh under one node; `component` 0 means no indices.
File quadFile(int component, std::size_t stride = 0, int mode = kTriangles) {
  File file;
  file.json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::vector<glm::vec3> corners = kCorners;
  std::vector<std::uint32_t> indices = kIndices;
  if (mode == kStrip) indices = {0, 1, 2, 3};
  if (mode == kFan) indices = {1, 3, 2, 0};
  if (component == 0) {
    corners.clear();
    for (const std::uint32_t i : indices) corners.push_back(kCorners[i]);
  }
  Json primitive = {{"attributes", {{"POSITION", addAccessor(file, corners, kFloat, stride)}}},
                    {"mode", mode}};
  if (component != 0) primitive["indices"] = addAccessor(file, indices, component);
  file.json["meshes"] = {{{"primitives", Json::array({primitive})}}};
  file.json["nodes"] = {{{"mesh", 0}}};
  file.json["scenes"] = {{{"nodes", {0}}}};
  file.json["buffers"] = {{{"byteLength", file.bin.size()}}};
  return file;
}

std::string base64(const std::string& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += i + k > bytes.size() ? '=' : kLetters[group >> (18 - 6 * k) & 63u];
    }
  }
  return result;
}

std::string gltf(File file) {
  if (!file.json["buffers"][0].contains("uri")) {
    file.json["buffers"][0]["uri"] =
        std::string("data:application/octet-stream;base64,") + base64(file.bin);
  }
  return file.json.dump();
}

void append(std::string& bytes, std::size_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffu);
}

std::string glb(const File& file) {
  std::string json = file.json.dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string bin = file.bin;
  bin.append((4 - bin.size() % 4) % 4, '\0');
  std::string result = "glTF";
  append(result, 2);
  append(result, 28 + json.size() + bin.size());
  append(result, json.size());
  result += "JSON" + json;
  append(result, bin.size());
  result += std::string("BIN\0", 4) + bin;
  return result;
}

tl::expected<Scene, Error> readText(const std::string& bytes) {
  return importScene(std::as_bytes(std::span<const char>(bytes)), SceneFormat::kGltf, "room");
}
tl::expected<Scene, Error> readBinary(const std::string& bytes) {
  return importScene(std::as_bytes(std::span<const char>(bytes)), SceneFormat::kGlb, "room");
}

std::string refusal(const tl::expected<Scene, Error>& scene,
                    ErrorCode code = ErrorCode::kDataDamaged) {
  if (scene) {
    ADD_FAILURE() << "read " << scene->triangles.size() << " triangles";
    return {};
  }
  EXPECT_EQ(scene.error().code, code) << scene.error().message;
  EXPECT_THAT(scene.error().message, Not(HasSubstr("\n")));
  return scene.error().message;
}

class GltfImport : public ::testing::Test {
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

TEST_F(GltfImport, RefusesWhatHoldsNoTriangle) {
  refusal(readText(R"({"asset":{"version":"2.0"}})"), ErrorCode::kSceneEmpty);
  for (const int mode : {0, 1, 2, 3}) {
    File file = quadFile(kShort);
    file.json["meshes"][0]["primitives"][0]["mode"] = mode;
    refusal(readBinary(glb(file)), ErrorCode::kSceneEmpty);
  }
  File file = quadFile(kShort);
  file.json["scenes"][0].erase("nodes");
  refusal(readBinary(glb(file)), ErrorCode::kSceneEmpty);
}

TEST_F(GltfImport, GivesTheSameTrianglesHoweverTheyAreStored) {
  for (const int component : {0, kByte, kShort, kInt}) {
    for (const std::size_t stride : {0, 12, 28}) {
      for (const int mode : {kTriangles, kStrip, kFan}) {
        const File file = quadFile(component, stride, mode);
        for (const auto& scene : {readText(gltf(file)), readBinary(glb(file))}) {
          ASSERT_TRUE(scene) << scene.error().message;
          if (mode != kFan) {
            EXPECT_EQ(surface(*scene), quad())
                << component << " stride " << stride << " mode " << mode;
          } else {
            // The fan 1 3 2 0 is (3 2 1) and (2 0 1): the same two triangles.
            EXPECT_EQ(surface(*scene), quad()) << component << " stride " << stride;
          }
        }
      }
    }
  }
}

TEST_F(GltfImport, AppliesTransformsDownTheTree) {
  // A quarter turn about +Y, then scale, then translation, written as TRS over a matrix.
  File file = quadFile(kShort);
  const double half = std::sqrt(0.5);
  file.json["nodes"] = {
      {{"children", {1}},
       {"translation", {10, 20, 30}},
       {"rotation", {0, 2 * half, 0, 2 * half}},  // exporters round; length is not 1
       {"scale", {2, 2, 2}}},
      {{"children", {2}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}},
      {{"mesh", 0}}};
  const auto scene = readBinary(glb(file));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->vertices.size(), kCorners.size());
  for (std::size_t i = 0; i < kCorners.size(); ++i) {
    // (x + 5, y, z) turned a quarter about +Y is (z, y, -(x + 5)).
    const glm::vec3 expected(10 + 2 * kCorners[i].z, 20 + 2 * kCorners[i].y,
                             30 - 2 * (kCorners[i].x + 5));
    EXPECT_NEAR(glm::distance(scene->vertices[i], expected), 0.0f, 1e-5f) << i;
  }
}

TEST_F(GltfImport, KeepsTheOutsideOutsideUnderAMirror) {
  File file = quadFile(kShort);
  file.json["nodes"][0]["scale"] = {-1, 1, 1};
  const auto scene = readBinary(glb(file));
  ASSERT_TRUE(scene);
  for (const glm::uvec3& t : scene->triangles) {
    const glm::vec3 a = scene->vertices[t.x];
    EXPECT_GT(glm::cross(scene->vertices[t.y] - a, scene->vertices[t.z] - a).y, 0.0f);
  }
  file.json["nodes"][0]["scale"] = {-1, 1, -1};  // two mirrors are a turn
  const auto turned = readBinary(glb(file));
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->triangles, readBinary(glb(quadFile(kShort)))->triangles);
}

TEST_F(GltfImport, ShowsTheDefaultSceneElseTheFirstElseTheRoots) {
  File file = quadFile(kShort);
  file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"children", {2}}}, {{"mesh", 0}}};
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 1}}}};
  const auto triangles = [&] { return readBinary(glb(file))->triangles.size(); };
  file.json["scene"] = 1;
  EXPECT_EQ(triangles(), 6u);
  file.json.erase("scene");
  EXPECT_EQ(triangles(), 2u);
  file.json.erase("scenes");
  EXPECT_EQ(triangles(), 6u);
}

TEST_F(GltfImport, SharesPositionsAmongPrimitives) {
  File file = quadFile(kShort);
  Json& primitives = file.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const auto scene = readBinary(glb(file));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->vertices.size(), kCorners.size());
  EXPECT_EQ(scene->triangles.size(), 4u);
}

TEST_F(GltfImport, RefusesNodesThatAreNoTree) {
  File file = quadFile(kShort);
  file.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
  EXPECT_THAT(refusal(readBinary(glb(file))), HasSubstr("node 0 is reached twice"));
  file.json.erase("scenes");
  file.json.erase("scene");
  EXPECT_THAT(refusal(readBinary(glb(file))), HasSubstr("none is the root"));
  file.json["nodes"] = {{{"children", {0}}}};
  refusal(readBinary(glb(file)));
}

TEST_F(GltfImport, RefusesRequiredExtensionsByName) {
  for (const char* name :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization",
        "EXT_mesh_gpu_instancing", "VENDOR_unheard_of"}) {
    File file = quadFile(kShort);
    file.json["extensionsUsed"] = {name};
    EXPECT_TRUE(readBinary(glb(file))) << name << " is only used";
    file.json["extensionsRequired"] = {"KHR_materials_unlit", name};
    EXPECT_THAT(refusal(readBinary(glb(file)), ErrorCode::kFormatUnsupported), HasSubstr(name));
  }
  File file = quadFile(kShort);
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = Json::object();
  EXPECT_THAT(refusal(readBinary(glb(file)), ErrorCode::kFormatUnsupported),
              HasSubstr("EXT_mesh_gpu_instancing"));
}

TEST_F(GltfImport, DoesNotNeedWhatIsOnlyForLooks) {
  File file = quadFile(kShort);
  file.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform",
                                     "KHR_lights_punctual", "KHR_texture_basisu"};
  file.json["images"] = {{{"uri", "missing.png"}}, {{"uri", "data:image/png;base64,AAAA"}}};
  file.json["textures"] = {{{"source", 7}}};
  file.json["materials"] = "nonsense";
  file.json["buffers"].push_back({{"byteLength", 99}, {"uri", "missing.bin"}});
  file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 99;
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 99}}};
  file.json["nodes"][0]["skin"] = 5;
  const auto scene = readBinary(glb(file));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(surface(*scene), quad());
}

TEST_F(GltfImport, NamesWhatItDoesNotRead) {
  const auto message = [](const std::function<void(Json&)>& change) {
    File file = quadFile(kShort);
    change(file.json);
    return refusal(readBinary(glb(file)), ErrorCode::kFormatUnsupported);
  };
  EXPECT_THAT(message([](Json& j) { j["asset"]["version"] = "1.0"; }), HasSubstr("1.0"));
  EXPECT_THAT(message([](Json& j) { j["asset"]["minVersion"] = "2.1"; }), HasSubstr("2.1"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["componentType"] = 5122; }),
              HasSubstr("KHR_mesh_quantization"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["sparse"] = Json::object(); }),
              HasSubstr("sparse"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0].erase("bufferView"); }),
              HasSubstr("accessor 0"));
  EXPECT_THAT(message([](Json& j) { j["buffers"][0]["uri"] = "room.bin"; }), HasSubstr("room.bin"));
}

TEST_F(GltfImport, RefusesNumbersThatLeadOutside) {
  const auto message = [](const std::function<void(Json&)>& change) {
    File file = quadFile(kShort, 16);
    change(file.json);
    return refusal(readBinary(glb(file)));
  };
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["count"] = 5; }), HasSubstr("POSITION"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["count"] = 4294967300; }),
              HasSubstr("4294967300"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["count"] = 0; }), HasSubstr("count"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["count"] = -4; }), HasSubstr("-4"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["count"] = 1.5; }), HasSubstr("1.5"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["byteOffset"] = 12; }), HasSubstr("byte 12"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["byteOffset"] = 1e300; }),
              HasSubstr("byteOffset"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][1]["count"] = 9; }), HasSubstr("indices"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][1]["count"] = 5; }), HasSubstr("5 corners"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][1]["componentType"] = kFloat; }),
              HasSubstr("5126"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["type"] = "VEC2"; }), HasSubstr("VEC2"));
  EXPECT_THAT(message([](Json& j) { j["accessors"][0]["bufferView"] = 2; }),
              HasSubstr("bufferView"));
  EXPECT_THAT(message([](Json& j) { j["bufferViews"][0]["byteStride"] = 8; }),
              HasSubstr("8 apart"));
  EXPECT_THAT(message([](Json& j) { j["bufferViews"][0]["byteStride"] = 13; }), HasSubstr("13"));
  EXPECT_THAT(message([](Json& j) { j["bufferViews"][1]["byteLength"] = 4000; }),
              HasSubstr("its buffer at"));
  EXPECT_THAT(message([](Json& j) { j["bufferViews"][1]["buffer"] = 1; }), HasSubstr("buffer"));
  EXPECT_THAT(message([](Json& j) { j["buffers"][0]["byteLength"] = 4000; }), HasSubstr("4000"));
  EXPECT_THAT(
      message([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2; }),
      HasSubstr("POSITION"));
  EXPECT_THAT(message([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 2; }),
              HasSubstr("indices"));
  EXPECT_THAT(message([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }),
              HasSubstr("accessor 0 (indices of mesh 0, primitive 0) has type \"VEC3\""));
  EXPECT_THAT(message([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }),
              HasSubstr("mode"));
  EXPECT_THAT(message([](Json& j) { j["nodes"][0]["mesh"] = 1; }), HasSubstr("node 0"));
  EXPECT_THAT(message([](Json& j) { j["nodes"][0]["children"] = {1}; }), HasSubstr("children"));
  EXPECT_THAT(message([](Json& j) { j["nodes"][0]["matrix"] = {1, 2}; }), HasSubstr("16 numbers"));
  EXPECT_THAT(message([](Json& j) { j["scenes"][0]["nodes"] = {-1}; }), HasSubstr("scene 0"));
  EXPECT_THAT(message([](Json& j) { j["scene"] = 1; }), HasSubstr("scene"));
  EXPECT_THAT(message([](Json& j) { j["nodes"] = 3; }), HasSubstr("nodes"));
}

TEST_F(GltfImport, RefusesIndicesAndPositionsThatAreWrong) {
  for (const int component : {kByte, kShort, kInt}) {
    File file = quadFile(component);
    const std::size_t last = file.json["bufferViews"][1]["byteOffset"];
    file.bin[last] = 4;
    EXPECT_THAT(refusal(readBinary(glb(file))), HasSubstr("index 0 names vertex 4, there are 4"));
  }
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    File file = quadFile(kShort);
    std::memcpy(file.bin.data() + 16, &bad, 4);
    EXPECT_THAT(refusal(readBinary(glb(file))), HasSubstr("POSITION 1 is (2, "));
  }
  File file = quadFile(kShort);
  file.json["nodes"][0]["scale"] = {1e39, 1, 1};
  EXPECT_THAT(refusal(readBinary(glb(file))),
              HasSubstr("POSITION 1 is (2, 0, 0), in the scene (2e+39"));
}

TEST_F(GltfImport, RefusesEveryTruncation) {
  const std::string binary = glb(quadFile(kShort, 12));
  for (std::size_t length = 0; length < binary.size(); ++length) {
    EXPECT_FALSE(readBinary(binary.substr(0, length))) << length;
    // The same, where the header is made to agree with the shorter file.
    std::string honest = binary.substr(0, length);
    for (std::size_t i = 8; i < 12 && length >= 12; ++i) {
      honest[i] = static_cast<char>(length >> (8 * (i - 8)) & 0xffu);
    }
    EXPECT_FALSE(readBinary(honest)) << length;
  }
  const std::string text = gltf(quadFile(kShort, 12));
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(readText(text.substr(0, length))) << length;
  }
}

TEST_F(GltfImport, ReadsBuffersBesideTheFileAndNowhereElse) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("forewalk-gltf-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "inner" / "my data");
  File file = quadFile(kShort);
  const auto importAs = [&](const std::string& uri) {
    file.json["buffers"][0]["uri"] = uri;
    std::ofstream(folder / "inner" / "room.gltf", std::ios::binary) << file.json.dump();
    return importScene(folder / "inner" / "room.gltf");
  };
  std::ofstream(folder / "inner" / "my data" / "a.bin", std::ios::binary) << file.bin << "tail";
  std::ofstream(folder / "outside.bin", std::ios::binary) << file.bin;
  for (const char* uri : {"my%20data/a.bin", "my data/a.bin", "./my data/../my%20data/a.bin"}) {
    const auto scene = importAs(uri);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(surface(*scene), quad());
  }
  const std::string absolute = (folder / "outside.bin").string();
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("%2e%2e/outside.bin"),
        std::string("my data/../../outside.bin"), absolute, "file://" + absolute,
        std::string("http://example.org/a.bin"), std::string("..\\outside.bin")}) {
    EXPECT_THAT(refusal(importAs(uri), ErrorCode::kFormatUnsupported), HasSubstr("buffer 0"))
        << uri;
  }
  EXPECT_THAT(refusal(importAs("none.bin"), ErrorCode::kFileUnreadable), HasSubstr("none.bin"));
  std::ofstream(folder / "inner" / "short.bin", std::ios::binary) << "short";
  EXPECT_THAT(refusal(importAs("short.bin")), HasSubstr("ends after 5 bytes"));
  std::filesystem::remove_all(folder);
}

TEST_F(GltfImport, RefusesDamagedText) {
  EXPECT_THAT(refusal(readText("{\"asset\": }")), HasSubstr("line 1, column 11"));
  refusal(readText("[]"));
  refusal(readText("null"));
  refusal(readText("{}"));
  refusal(readText(std::string(100000, '[')));
  // Whole and well-formed, in a place where the message would show it.
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_THAT(refusal(readText(R"({"asset":{"version":"2.0"},"nodes":[{"scale":)" + deep + "}]}")),
              HasSubstr("deep"));
  File file = quadFile(kShort);
  file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA";
  refusal(readText(gltf(file)));
  file.json["buffers"][0]["uri"] = "data:,hello";
  refusal(readText(gltf(file)));
  refusal(readBinary(std::string("glTX") + glb(file).substr(4)), ErrorCode::kFormatUnknown);
  std::string old = glb(file);
  old[4] = 1;
  EXPECT_THAT(refusal(readBinary(old), ErrorCode::kFormatUnsupported), HasSubstr("version 1"));
}

}  // namespace
}  // namespace forewalk::navmesh
