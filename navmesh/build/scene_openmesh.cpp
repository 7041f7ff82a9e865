// OBJ, OFF, PLY and STL through OpenMesh's readers, once they have passed their sieve.
#include <fmt/format.h>

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <locale>
#include <mutex>
#include <sstream>

#include "navmesh/build/scene_readers.h"
#include "navmesh/build/scene_sieve.h"
#include "navmesh/build/scene_triangulate.h"

namespace forewalk::navmesh {
namespace {

/// What OpenMesh hands over: vertices and faces as they come, without half-edges, so that no face
/// is refused for sharing an edge with two others.
class Soup final : public OpenMesh::IO::BaseImporter {
 public:
  using Vec2f = OpenMesh::Vec2f;
  using Vec3f = OpenMesh::Vec3f;
  using Vec4f = OpenMesh::Vec4f;
  using Vec3d = OpenMesh::Vec3d;
  using Vec3uc = OpenMesh::Vec3uc;
  using Vec4uc = OpenMesh::Vec4uc;
  using VertexHandle = OpenMesh::VertexHandle;
  using HalfedgeHandle = OpenMesh::HalfedgeHandle;
  using EdgeHandle = OpenMesh::EdgeHandle;
  using FaceHandle = OpenMesh::FaceHandle;
  using StatusInfo = OpenMesh::Attributes::StatusInfo;

  std::vector<glm::vec3> vertices;
  std::vector<std::size_t> faceStart{0};
  std::vector<std::uint32_t> corners;

  VertexHandle add_vertex(const Vec3f& p) override {
    vertices.emplace_back(p[0], p[1], p[2]);
    return VertexHandle(static_cast<int>(vertices.size() - 1));
  }
  VertexHandle add_vertex(const Vec3d& p) override { return add_vertex(Vec3f(p)); }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0.0f, 0.0f, 0.0f)); }
  void set_point(VertexHandle v, const Vec3f& p) override {
    vertices[static_cast<std::size_t>(v.idx())] = {p[0], p[1], p[2]};
  }
  FaceHandle add_face(const VHandles& ring) override {
    for (const VertexHandle v : ring) corners.push_back(static_cast<std::uint32_t>(v.idx()));
    faceStart.push_back(corners.size());
    return FaceHandle(static_cast<int>(faceStart.size() - 2));
  }
  std::size_t n_vertices() const override { return vertices.size(); }
  std::size_t n_faces() const override { return faceStart.size() - 1; }
  std::size_t n_edges() const override { return 0; }

  // The rest of the interface is about half-edges, normals, colours and textures, which the sieve
  // never lets through.
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_status(VertexHandle, const StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(HalfedgeHandle, const StatusInfo&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_status(EdgeHandle, const StatusInfo&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_status(FaceHandle, const StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}
};

/// What differs from format to format.
struct Reading {
  tl::expected<Sieved, Error> (*sieve)(std::string_view bytes, const std::string& name);
  const char* ending;  ///< as OpenMesh knows it
  bool joinsVertices;  ///< equal corners become one vertex
  bool dropsFaces;     ///< those without area
};

Reading readingOf(SceneFormat format) {
  switch (format) {
    case SceneFormat::kObj:
      return {sieveObj, "obj", false, true};
    case SceneFormat::kOff:
      return {sieveOff, "off", false, false};
    case SceneFormat::kPly:
      return {sievePly, "ply", false, false};
    default:
      return {sieveStl, "stl", true, true};
  }
}

bool readWithOpenMesh(Sieved& sieved, const char* ending, Soup& soup) {
  OpenMesh::IO::Options options;
  if (sieved.binary) options += OpenMesh::IO::Options::Binary;
  // OpenMesh's readers are singletons that keep what they read about a file.
  static std::mutex oneAtATime;
  const std::lock_guard lock(oneAtATime);
  std::istringstream stream(std::move(sieved.text), std::ios::in | std::ios::binary);
  stream.imbue(std::locale::classic());
  return OpenMesh::IO::IOManager().read(stream, ending, soup, options);
}

Scene triangulated(Soup soup, const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.vertices = std::move(soup.vertices);
  scene.triangles.reserve(soup.corners.size() / 3);
  for (std::size_t face = 0; face + 1 < soup.faceStart.size(); ++face) {
    const std::span<const std::uint32_t> ring(soup.corners.data() + soup.faceStart[face],
                                              soup.faceStart[face + 1] - soup.faceStart[face]);
    triangulate(ring, scene.vertices, scene.triangles);
  }
  return scene;
}

}  // namespace

tl::expected<Scene, Error> readMeshFile(std::span<const std::byte> bytes, SceneFormat format,
                                        const std::string& name) {
  const Reading reading = readingOf(format);
  auto sieved = reading.sieve({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
  if (!sieved) return tl::unexpected(sieved.error());

  if (sieved->faces == 0) {
    return refuse(
        ErrorCode::kSceneEmpty,
        fmt::format("{}: no face in it. Export the meshes as faces, not as points or lines.",
                    name));
  }

  Soup soup;
  const bool read = readWithOpenMesh(*sieved, reading.ending, soup);
  const std::uint64_t faces = soup.n_faces();
  const bool sameVertices = reading.joinsVertices || soup.n_vertices() == sieved->vertices;
  const bool sameFaces = reading.dropsFaces ? faces <= sieved->faces : faces == sieved->faces;
  if (!read || !sameVertices || !sameFaces) {
    return damaged(
        fmt::format("{}: OpenMesh read {} vertices and {} faces, the file has {} and {}. "
                    "Export it again.",
                    name, soup.n_vertices(), faces, sieved->vertices, sieved->faces));
  }

  return triangulated(std::move(soup), name);
}

}  // namespace forewalk::navmesh
