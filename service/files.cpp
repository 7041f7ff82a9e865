#include "service/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/fwmesh.h"
#include "navmesh/plan.h"

namespace forewalk::service {
namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

std::string endingOf(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

tl::unexpected<Error> unwritable(const std::filesystem::path& file, const std::string& reason) {
  return fail(ErrorCode::kFileUnwritable,
              fmt::format("{}: cannot be written: {}. Give another path.", file.string(), reason));
}

tl::expected<void, Error> makeFolders(const std::filesystem::path& file) {
  if (!file.has_parent_path()) return {};
  std::error_code failure;
  std::filesystem::create_directories(file.parent_path(), failure);
  if (failure) return unwritable(file, failure.message());
  return {};
}

tl::expected<void, Error> writeBytes(const std::filesystem::path& file, const void* bytes,
                                     std::size_t size) {
  const auto refuse = [&](const std::string& reason) { return unwritable(file, reason); };
  if (file == "-") {
    if (std::fwrite(bytes, 1, size, stdout) != size || std::fflush(stdout) != 0) {
      return refuse(std::strerror(errno));
    }
    return {};
  }
  if (auto made = makeFolders(file); !made) return made;
  errno = 0;
  const Stream stream(std::fopen(file.c_str(), "wb"), &std::fclose);
  if (!stream) return refuse(std::strerror(errno));
  if (std::fwrite(bytes, 1, size, stream.get()) != size || std::fflush(stream.get()) != 0) {
    return refuse(std::strerror(errno));
  }
  return {};
}

}  // namespace

tl::expected<std::vector<std::byte>, Error> readFile(const std::filesystem::path& file) {
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::kFileUnreadable,
                fmt::format("{}: cannot be read: {}.", file.string(), reason));
  };
  std::error_code failure;
  if (std::filesystem::is_directory(file, failure)) return refuse("it is a directory");
  errno = 0;
  const Stream stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) return refuse(std::strerror(errno));
  std::vector<std::byte> bytes;
  std::byte chunk[1 << 16];
  for (std::size_t got; (got = std::fread(chunk, 1, sizeof chunk, stream.get())) > 0;) {
    bytes.insert(bytes.end(), chunk, chunk + got);
  }
  if (std::ferror(stream.get())) return refuse(std::strerror(errno));
  return bytes;
}

tl::expected<void, Error> writeFile(const std::filesystem::path& file, std::string_view text) {
  return writeBytes(file, text.data(), text.size());
}

tl::expected<void, Error> writeFile(const std::filesystem::path& file,
                                    const std::vector<std::byte>& bytes) {
  return writeBytes(file, bytes.data(), bytes.size());
}

std::uint64_t contentHash(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

tl::expected<void, Error> checkWritable(const std::filesystem::path& file) {
  if (file.empty() || file == "-") return {};
  if (auto made = makeFolders(file); !made) return made;
  std::error_code failure;
  const auto status = std::filesystem::status(file, failure);
  const bool isNew = !std::filesystem::exists(status);
  // Whoever reads a pipe would take the first opening for all there is.
  if (!isNew && !std::filesystem::is_regular_file(status) && !std::filesystem::is_directory(status))
    return {};
  errno = 0;
  Stream stream(std::fopen(file.c_str(), "ab"), &std::fclose);
  if (!stream) return unwritable(file, std::strerror(errno));
  stream.reset();
  if (isNew) std::filesystem::remove(file, failure);
  return {};
}

tl::expected<void, Error> checkSpace(const std::filesystem::path& folder, std::uintmax_t bytes) {
  std::error_code problem;
  const std::filesystem::space_info space = std::filesystem::space(folder, problem);
  // A file system that does not say is taken to have room: writing will tell.
  if (problem || space.available >= bytes) return {};
  constexpr double kMegabyte = 1e6;
  return tl::unexpected(
      Error{ErrorCode::kFileUnwritable,
            fmt::format("{}: the disk has {:.1f} MB left, {:.1f} MB are needed; make room, or give "
                        "another folder.",
                        folder.string(), static_cast<double>(space.available) / kMegabyte,
                        static_cast<double>(bytes) / kMegabyte)});
}

bool isBuiltNavMesh(const std::filesystem::path& file) {
  const std::string ending = endingOf(file);
  return ending == ".fwmesh" || ending == ".bin";
}

tl::expected<navmesh::NavMesh, Error> loadNavMesh(const std::filesystem::path& file,
                                                  const navmesh::ImportSettings& import,
                                                  const navmesh::BuildSettings& build,
                                                  const navmesh::BuildRun& run) {
  if (isBuiltNavMesh(file)) {
    auto bytes = readFile(file);
    if (!bytes) return tl::unexpected(std::move(bytes.error()));
    return endingOf(file) == ".bin" ? navmesh::importMset(*bytes, file.string())
                                    : navmesh::loadFwmesh(*bytes, file.string());
  }
  if (!navmesh::sceneFormatOf(file)) {
    const std::string ending = endingOf(file);
    return fail(
        ErrorCode::kFormatUnknown,
        fmt::format("{}: the ending {} names no format we read. Try .obj .off .ply .stl .gltf "
                    ".glb, .fwmesh, or RecastDemo's .bin.",
                    file.string(), ending.empty() ? "(none)" : "\"" + ending + "\""));
  }
  auto scene = navmesh::importScene(file, import);
  if (!scene) return tl::unexpected(std::move(scene.error()));
  return navmesh::buildNavMesh(*scene, build, run);
}

tl::expected<std::shared_ptr<const navmesh::World>, Error> makeWorld(
    const navmesh::NavMesh& navMesh) {
  auto graph = navmesh::makeNavGraph(navmesh::flatten(navMesh));
  if (!graph) return tl::unexpected(std::move(graph.error()));
  return std::make_shared<const navmesh::World>(navmesh::makeWorld(std::move(*graph)));
}

namespace {

// The nearest point of a convex polygon, itself included.
glm::vec2 nearestIn(const navmesh::NavGraph& graph, navmesh::PolygonId polygon, glm::vec2 plan) {
  if (navmesh::contains(graph, polygon, plan)) return plan;
  const auto ring = graph.ringOf(polygon);
  glm::vec2 nearest = ring[0];
  float best = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::vec2 a = ring[i];
    const glm::vec2 along = ring[(i + 1) % ring.size()] - a;
    const float squared = glm::dot(along, along);
    const float t =
        squared > 0.0f ? glm::clamp(glm::dot(plan - a, along) / squared, 0.0f, 1.0f) : 0.0f;
    const glm::vec2 point = a + t * along;
    const float distance = glm::dot(plan - point, plan - point);
    if (distance < best) {
      best = distance;
      nearest = point;
    }
  }
  return nearest;
}

}  // namespace

tl::expected<navmesh::Location, Error> placeIn(const navmesh::World& world, glm::vec3 position,
                                               std::string_view sceneName) {
  if (const auto place = navmesh::locate(world.graph, world.locations, position)) return *place;
  const glm::vec2 plan = navmesh::toPlan(position);
  glm::vec3 nearest{0.0f};
  float best = std::numeric_limits<float>::infinity();
  for (std::uint32_t p = 0; p < world.graph.polygonCount(); ++p) {
    const navmesh::PolygonId polygon{p};
    const glm::vec2 point = nearestIn(world.graph, polygon, plan);
    const glm::vec3 there = navmesh::toSpace(point, navmesh::heightAt(world.graph, polygon, point));
    const float distance = glm::distance(there, position);
    if (distance < best) {
      best = distance;
      nearest = there;
    }
  }
  return fail(
      ErrorCode::kPositionOffNavMesh,
      fmt::format("position ({:g}, {:g}, {:g}) lies off the navmesh of {}: the nearest walkable "
                  "point is {:.2f} m away. Try {:.2f},{:.2f},{:.2f}.",
                  position.x, position.y, position.z, sceneName, best, nearest.x, nearest.y,
                  nearest.z));
}

}  // namespace forewalk::service
