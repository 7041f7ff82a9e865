// The scene readers on any bytes. The first byte picks the format, the rest is the file.
#include <cmath>
#include <string>
#include <string_view>

#include "navmesh/build/scene.h"
#include "tests/fuzz/fuzz.h"

using forewalk::navmesh::Scene;
using forewalk::navmesh::SceneFormat;
using forewalk::testing::require;
using forewalk::testing::requireSentence;

namespace {

constexpr SceneFormat kFormats[] = {SceneFormat::kObj, SceneFormat::kOff,  SceneFormat::kPly,
                                    SceneFormat::kStl, SceneFormat::kGltf, SceneFormat::kGlb};

void checkScene(const Scene& scene) {
  require(!scene.triangles.empty(), "a scene has triangles");
  for (const glm::vec3& v : scene.vertices) {
    require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), "vertices are finite");
  }
  for (const glm::uvec3& t : scene.triangles) {
    const std::size_t count = scene.vertices.size();
    require(t.x < count && t.y < count && t.z < count, "indices are in range");
  }
}

void append(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffu);
}

constexpr std::string_view kOneFloat("\0\0\x80\x3f", 4);
constexpr std::string_view kZeroFloat("\0\0\0\0", 4);

/// (0, 0, 0), (1, 0, 0), (0, 0, 1) as little-endian floats.
std::string corners() {
  std::string bytes;
  for (const std::string_view number : {kZeroFloat, kZeroFloat, kZeroFloat, kOneFloat, kZeroFloat,
                                        kZeroFloat, kZeroFloat, kZeroFloat, kOneFloat}) {
    bytes += number;
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const SceneFormat format = kFormats[data[0] % std::size(kFormats)];
  const auto scene = forewalk::navmesh::importScene(
      std::as_bytes(std::span<const std::uint8_t>(data + 1, size - 1)), format, "fuzz");
  if (scene) {
    checkScene(*scene);
  } else {
    requireSentence(scene.error().message, "fuzz");
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  std::vector<std::vector<std::uint8_t>> seeds;
  const auto add = [&](char format, std::string_view bytes) {
    std::vector<std::uint8_t> seed{static_cast<std::uint8_t>(format)};
    seed.insert(seed.end(), bytes.begin(), bytes.end());
    seeds.push_back(std::move(seed));
  };
  add(0,
      "# room\nmtllib none.mtl\nv 0 0 0\nv 1.5 0 0\nv +1 0 -1e0 0.5 0.5 0.5\nv 0 0 -1\nvt 0 0\n"
      "vn 0 1 0\nf 1/1/1 2//1 3 \\\n 4\nf -4 -3 -2\n");
  add(1,
      "OFF # room\n5 2 0\n0 0 0\n4 0 0\n4 0 -4\n1 0 -1\n0 0 -4 255 0 0\n5 0 1 2 3 4 1 0 0\n3 0 1 "
      "2\n");
  add(1, "NOFF\n3 1 0\n0 0 0 0 1 0\n1 0 0 0 1 0\n0 0 1 0 1 0\n3 0 2 1\n");
  add(2,
      "ply\nformat ascii 1.0\ncomment room\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property double z\nproperty uchar red\nelement face 2\nproperty list uchar int "
      "vertex_indices\n"
      "property list uchar float texcoord\nend_header\n0 0 0 1\n1 0 0 2\n1 0 -1 3\n0 0 -1 4\n"
      "3 0 1 2 2 0.5 0.5\n4 0 1 2 3 0\n");
  for (const bool big : {false, true}) {
    std::string ply =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar uchar vertex_index\nend_header\n";
    ply += corners();
    ply += std::string_view("\3\0\2\1", 4);
    add(2, ply);
  }
  add(3,
      "solid room\nfacet normal 0 1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 "
      "-1\nendloop\n"
      "endfacet\nendsolid room\n");
  std::string stl(80, ' ');
  append(stl, 1);
  stl += std::string(12, '\0') + corners() + std::string(2, '\0');
  add(3, stl);

  const std::string tail =
      R"("bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12},{"buffer":0,"byteOffset":36,"byteLength":6}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","max":[1,1,1]},)"
      R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1,"material":0},)"
      R"({"attributes":{"POSITION":0},"mode":5},{"attributes":{"POSITION":0},"mode":6}]}],)"
      R"("nodes":[{"children":[1],"translation":[1,2,3],"rotation":[0,0.7071,0,0.7071],"scale":[1,-1,1]},)"
      R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],)"
      R"("scenes":[{"nodes":[0]}],"scene":0,"extensionsRequired":["KHR_materials_unlit"],)"
      R"("images":[{"uri":"missing.png"}]})";
  add(4,
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":42,"uri":)"
      R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAAAAAIA/AAACAAEA"}],)" +
          tail);
  std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":42}],)" + tail;
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::string bin = corners() + std::string("\0\0\2\0\1\0\0\0", 8);
  std::string glb = "glTF";
  append(glb, 2);
  append(glb, static_cast<std::uint32_t>(28 + json.size() + bin.size()));
  append(glb, static_cast<std::uint32_t>(json.size()));
  glb += "JSON" + json;
  append(glb, static_cast<std::uint32_t>(bin.size()));
  glb += std::string_view("BIN\0", 4);
  glb += bin;
  add(5, glb);
  return seeds;
}
