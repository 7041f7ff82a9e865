// glTF 2.0 through tinygltf, once its JSON has passed the sieve. What tinygltf returns is checked
// against the buffers' real sizes before it is read.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "navmesh/build/little_endian.h"
#include "navmesh/build/scene_glb.h"
#include "navmesh/build/scene_gltf_sieve.h"
#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kCornersMost = std::uint64_t{1} << 30;  // 4 GiB of indices
constexpr int kDeepest = 256;  // nlohmann recurses where a message shows a value
struct TooDeep {};

tl::expected<Json, Error> parseJson(std::string_view text, const std::string& name) {
  const auto notTooDeep = [](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDeepest) throw TooDeep();
    return true;
  };
  try {
    return Json::parse(text, notTooDeep);
  } catch (const TooDeep&) {
    return damaged(
        fmt::format("{}: the JSON nests more than {} deep. Export it again.", name, kDeepest));
  } catch (const Json::exception& wrong) {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: ..." says where.
    const std::string_view what = wrong.what();
    const std::size_t start = what.find("] ");
    std::string said(what.substr(start == what.npos ? 0 : start + 2).substr(0, 160));
    for (char& c : said) c = c >= ' ' && c <= '~' ? c : '?';
    return damaged(fmt::format("{}: {}. Export it again.", name, said));
  }
}

// ---- tinygltf, on a file system that holds the buffers that the sieve has read.

bool outsideExists(const std::string& file, void*) { return file.starts_with("outside"); }

std::string expandOutside(const std::string& file, void*) { return file; }

bool readOutside(std::vector<unsigned char>* bytes, std::string*, const std::string& file,
                 void* user) {
  auto& outside = *static_cast<std::vector<std::vector<std::byte>>*>(user);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    if (file != outsideUri(i)) continue;
    bytes->resize(outside[i].size());
    std::memcpy(bytes->data(), outside[i].data(), outside[i].size());
    return true;
  }
  return false;
}

tl::expected<tinygltf::Model, Error> readWithTinygltf(PlainGltf& plain, const std::string& name) {
  const auto glb = joinGlb(plain.json.dump(), plain.bin, name);
  if (!glb) return tl::unexpected(glb.error());
  tinygltf::TinyGLTF reader;
  tinygltf::FsCallbacks files{};
  files.FileExists = outsideExists;
  files.ExpandFilePath = expandOutside;
  files.ReadWholeFile = readOutside;
  files.user_data = &plain.outside;
  reader.SetFsCallbacks(files);
  tinygltf::Model model;
  std::string wrong;
  std::string warnings;
  bool read = false;
  try {
    read = reader.LoadBinaryFromMemory(
        &model, &wrong, &warnings, reinterpret_cast<const unsigned char*>(glb->data()),
        static_cast<unsigned int>(glb->size()), "", tinygltf::NO_REQUIRE);
  } catch (const std::exception& thrown) {
    wrong = thrown.what();
  }
  if (!read) {
    return damaged(fmt::format("{}: tinygltf says {}. Export it again.", name, inQuotes(wrong)));
  }
  return model;
}

// ---- From nodes to triangles.

std::size_t sizeOfComponent(int type) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type)));
}

/// The bytes of an accessor, known to lie in their buffer.
struct Elements {
  std::string_view bytes;  ///< from its first element on
  std::size_t stride = 0;
  std::size_t count = 0;
  int component = 0;

  std::uint32_t index(std::size_t i) const {
    const std::string_view element = bytes.substr(i * stride, sizeOfComponent(component));
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < element.size(); ++b) {
      value |= std::uint32_t{static_cast<unsigned char>(element[b])} << (8 * b);
    }
    return value;
  }
  glm::vec3 position(std::size_t i) const {
    const auto coordinate = [&](std::size_t axis) {
      return std::bit_cast<float>(loadLittle(bytes, i * stride + sizeof(float) * axis));
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
  }
};

tl::expected<Elements, Error> elementsOf(const tinygltf::Model& model, int index,
                                         std::size_t elementSize, const std::string& where) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const tinygltf::BufferView& view =
      model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const tinygltf::Buffer& buffer = model.buffers[static_cast<std::size_t>(view.buffer)];
  const std::size_t stride = view.byteStride == 0 ? elementSize : view.byteStride;
  const std::uint64_t viewEnd = std::uint64_t{view.byteOffset} + view.byteLength;
  if (viewEnd > buffer.data.size()) {
    return damaged(
        fmt::format("{}: its bufferView ends at byte {}, its buffer at {}. Export it again.", where,
                    viewEnd, buffer.data.size()));
  }
  const std::uint64_t end = std::uint64_t{accessor.byteOffset} +
                            std::uint64_t{stride} * (accessor.count - 1) + elementSize;
  if (stride < elementSize || end > view.byteLength) {
    return damaged(fmt::format(
        "{}: {} elements of {} bytes, {} apart from byte {}, need {} bytes, their "
        "bufferView has {}. Export it again.",
        where, accessor.count, elementSize, stride, accessor.byteOffset, end, view.byteLength));
  }
  const std::string_view all(reinterpret_cast<const char*>(buffer.data.data()), buffer.data.size());
  return Elements{all.substr(view.byteOffset + accessor.byteOffset), stride, accessor.count,
                  accessor.componentType};
}

glm::dmat4 localTransform(const tinygltf::Node& node) {
  glm::dmat4 result(1.0);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return result;
  }
  if (node.rotation.size() == 4) {
    const glm::dquat turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = glm::length(turn);
    if (length > 0.0) result = glm::mat4_cast(turn / length);
  }
  if (node.scale.size() == 3) {
    for (int i = 0; i < 3; ++i) result[i] *= node.scale[static_cast<std::size_t>(i)];
  }
  if (node.translation.size() == 3) {
    result[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
  }
  return result;
}

/// The roots of the scene that is shown: the default, else the first, else every node without
/// parent.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  if (!model.scenes.empty()) {
    return model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))].nodes;
  }
  std::vector<bool> isChild(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) isChild[static_cast<std::size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (!isChild[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

/// One primitive's positions and the order of its corners, both in their buffers.
struct Corners {
  Elements positions;
  std::optional<Elements> order;  ///< none: as the positions come
  int mode = TINYGLTF_MODE_TRIANGLES;

  std::size_t count() const { return order ? order->count : positions.count; }
  std::uint32_t vertex(std::size_t corner) const {
    return order ? order->index(corner) : static_cast<std::uint32_t>(corner);
  }
  std::size_t triangles() const {
    return mode == TINYGLTF_MODE_TRIANGLES ? count() / 3 : count() - 2;
  }
  glm::uvec3 triangle(std::size_t i) const {
    const std::size_t odd = i % 2;
    switch (mode) {
      case TINYGLTF_MODE_TRIANGLE_STRIP:
        return {vertex(i), vertex(i + 1 + odd), vertex(i + 2 - odd)};
      case TINYGLTF_MODE_TRIANGLE_FAN:
        return {vertex(i + 1), vertex(i + 2), vertex(0)};
      default:
        return {vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)};
    }
  }
};

tl::expected<Corners, Error> cornersOf(const tinygltf::Model& model,
                                       const tinygltf::Primitive& primitive,
                                       const std::string& where) {
  Corners corners;
  corners.mode = primitive.mode;
  const auto positions = elementsOf(model, primitive.attributes.at("POSITION"), 3 * sizeof(float),
                                    where + ", POSITION");
  if (!positions) return tl::unexpected(positions.error());
  corners.positions = *positions;
  if (primitive.indices >= 0) {
    const int component =
        model.accessors[static_cast<std::size_t>(primitive.indices)].componentType;
    const auto order =
        elementsOf(model, primitive.indices, sizeOfComponent(component), where + ", indices");
    if (!order) return tl::unexpected(order.error());
    corners.order = *order;
  }
  const bool list = corners.mode == TINYGLTF_MODE_TRIANGLES;
  if (corners.count() < 3 || (list && corners.count() % 3 != 0)) {
    return damaged(fmt::format("{} has {} corners, {} is needed. Export it again.", where,
                               corners.count(), list ? "a multiple of 3" : "3 or more"));
  }
  for (std::size_t i = 0; i < corners.count(); ++i) {
    if (corners.vertex(i) >= positions->count) {
      return damaged(fmt::format("{}: index {} names vertex {}, there are {}. Export it again.",
                                 where, i, corners.vertex(i), positions->count));
    }
  }
  return corners;
}

/// Appends the triangles of one mesh after the other, seen from their nodes.
class Collector {
 public:
  Collector(const tinygltf::Model& model, const std::string& name) : model_(model) {
    scene_.name = name;
  }

  tl::expected<void, Error> appendMesh(std::size_t meshIndex, std::size_t nodeIndex,
                                       const glm::dmat4& toScene) {
    const bool mirrored = glm::determinant(glm::dmat3(toScene)) < 0.0;
    std::map<int, std::uint32_t> firstVertex;  // primitives often share their positions
    const tinygltf::Mesh& mesh = model_.meshes[meshIndex];
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      // The sieve leaves out primitives, so the number is that among the triangles.
      const std::string where = fmt::format("{}: mesh {} of node {}, triangle primitive {}",
                                            scene_.name, meshIndex, nodeIndex, p);
      const auto corners = cornersOf(model_, primitive, where);
      if (!corners) return tl::unexpected(corners.error());
      if (auto fits = checkRoom(*corners, where); !fits) return fits;
      const auto [first, isNew] = firstVertex.emplace(
          primitive.attributes.at("POSITION"), static_cast<std::uint32_t>(scene_.vertices.size()));
      if (isNew) {
        auto appended = appendVertices(corners->positions, toScene, where);
        if (!appended) return appended;
      }
      for (std::size_t i = 0; i < corners->triangles(); ++i) {
        glm::uvec3 triangle = corners->triangle(i);
        if (mirrored) std::swap(triangle.y, triangle.z);
        scene_.triangles.push_back(triangle + first->second);
      }
    }
    return {};
  }

  Scene take() { return std::move(scene_); }

 private:
  tl::expected<void, Error> checkRoom(const Corners& corners, const std::string& where) const {
    if ((scene_.triangles.size() + corners.triangles()) * 3 > kCornersMost ||
        scene_.vertices.size() + corners.positions.count > kCornersMost) {
      return refuse(ErrorCode::kTooLarge,
                    fmt::format("{}: the scene exceeds {} triangle corners or vertices. Split it.",
                                where, kCornersMost));
    }
    return {};
  }

  tl::expected<void, Error> appendVertices(const Elements& positions, const glm::dmat4& toScene,
                                           const std::string& where) {
    for (std::size_t i = 0; i < positions.count; ++i) {
      const glm::vec3 read = positions.position(i);
      const glm::dvec3 placed(toScene * glm::dvec4(glm::dvec3(read), 1.0));
      const glm::dvec3 size = glm::abs(placed);
      constexpr double kMost = std::numeric_limits<float>::max();
      if (!(size.x <= kMost && size.y <= kMost && size.z <= kMost)) {
        return damaged(
            fmt::format("{}, POSITION {} is ({}, {}, {}), in the scene ({}, {}, {}): finite "
                        "numbers are needed. Export it again.",
                        where, i, read.x, read.y, read.z, placed.x, placed.y, placed.z));
      }
      scene_.vertices.emplace_back(placed);
    }
    return {};
  }

  const tinygltf::Model& model_;
  Scene scene_;
};

tl::expected<Scene, Error> collect(const tinygltf::Model& model, const std::string& name) {
  Collector collector(model, name);
  struct Visit {
    int node;
    glm::dmat4 parentToScene;
  };
  std::vector<Visit> open;
  std::vector<int> roots = rootsOf(model);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root)
    open.push_back({*root, glm::dmat4(1.0)});
  if (roots.empty() && !model.nodes.empty() && model.scenes.empty()) {
    return damaged(
        fmt::format("{}: every node is a child of another, so none is the root. Export it "
                    "again.",
                    name));
  }
  std::vector<bool> seen(model.nodes.size(), false);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const auto index = static_cast<std::size_t>(visit.node);
    if (seen[index]) {
      return damaged(fmt::format(
          "{}: node {} is reached twice, nodes must form trees. Export it again.", name, index));
    }
    seen[index] = true;
    const tinygltf::Node& node = model.nodes[index];
    const glm::dmat4 toScene = visit.parentToScene * localTransform(node);
    if (node.mesh >= 0) {
      auto appended = collector.appendMesh(static_cast<std::size_t>(node.mesh), index, toScene);
      if (!appended) return tl::unexpected(appended.error());
    }
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      open.push_back({*child, toScene});
    }
  }
  return collector.take();
}

}  // namespace

tl::expected<Scene, Error> readGltf(std::span<const std::byte> bytes, SceneFormat format,
                                    const std::string& name,
                                    const std::optional<std::filesystem::path>& folder) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  GlbChunks chunks{text, {}};
  if (format == SceneFormat::kGlb) {
    const auto split = splitGlb(text, name);
    if (!split) return tl::unexpected(split.error());
    chunks = *split;
  }
  auto file = parseJson(chunks.json, name);
  if (!file) return tl::unexpected(file.error());
  auto plain = sieveGltf(*file, chunks.bin, name, folder);
  if (!plain) return tl::unexpected(plain.error());
  *file = Json();  // its data URIs may be most of the memory
  const auto model = readWithTinygltf(*plain, name);
  if (!model) return tl::unexpected(model.error());
  return collect(*model, name);
}

}  // namespace forewalk::navmesh
