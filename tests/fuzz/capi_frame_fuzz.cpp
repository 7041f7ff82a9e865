// The C interface under any sequence of calls: settings, frames, teleports and graphs with whatever
// numbers the bytes make, and sometimes a navmesh of the bytes themselves.
//
// Every call returns a status of the header, whatever comes out of a frame is finite, and after all
// of it the session still takes a sound frame as a new one would.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <vector>

#include "service/capi/forewalk.h"
#include "tests/fuzz/fuzz.h"

namespace {

void require(bool promise, const char* what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %s (last error: %s)\n", what, forewalk_last_error());
  std::abort();
}

/// Reads numbers off the bytes; zeros when they are spent.
class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  bool spent() const { return left_ == 0; }

  template <typename T>
  T raw() {
    T value{};
    const std::size_t count = std::min(left_, sizeof value);
    if (count > 0) std::memcpy(&value, at_, count);
    at_ += count;
    left_ -= count;
    return value;
  }

  /// Mostly numbers of a sensible size, so that sessions are made and walked; often enough the
  /// edges.
  float number() {
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
    static const float kEdges[] = {0.0f,       -0.0f,         1.0f,   -1.0f, 1e-30f,
                                   3e38f,      -3e38f,        1e6f,   -1e6f, kInfinity,
                                   -kInfinity, std::nanf(""), 1e-45f, 0.5f,  100.0f};
    const auto choice = raw<std::uint8_t>();
    if (choice < std::size(kEdges)) return kEdges[choice];
    if (choice < 32) return raw<float>();
    return static_cast<float>(raw<std::int16_t>()) / 8192.0f;
  }

  forewalk_vec3 vector(float scale) {
    return {scale * number(), scale * number(), scale * number()};
  }

  std::vector<std::uint8_t> block() {
    const std::size_t count = std::min<std::size_t>(left_, raw<std::uint16_t>());
    const std::size_t taken = std::min(count, left_);
    std::vector<std::uint8_t> bytes(at_, at_ + taken);
    at_ += taken;
    left_ -= taken;
    return bytes;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

bool isDocumented(forewalk_status status) {
  return (status >= FOREWALK_OK && status <= FOREWALK_ERROR_FILE_UNWRITABLE) ||
         (status >= FOREWALK_ERROR_ARGUMENT && status <= FOREWALK_ERROR_OUT_OF_MEMORY);
}

void check(forewalk_status status) {
  require(isDocumented(status), "a status of the header, and none of our defects");
  if (status != FOREWALK_OK) require(forewalk_last_error()[0] != '\0', "a failure has a sentence");
}

/// Two rooms and a passage between them.
forewalk_navmesh* defaultNavMesh() {
  static forewalk_navmesh* const navmesh = [] {
    const float vertices[] = {-4, 0, 3,  0, 0, 3,  0, 0, -3, -4, 0, -3, 0, 0, 1,  1, 0, 1,
                              1,  0, -1, 0, 0, -1, 1, 0, 3,  5,  0, 3,  5, 0, -3, 1, 0, -3};
    const std::uint32_t indices[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7, 8, 9, 10, 8, 10, 11};
    forewalk_navmesh* made = nullptr;
    require(forewalk_navmesh_from_triangles(vertices, 12, indices, 18, FOREWALK_AXES_OPENXR,
                                            nullptr, &made) == FOREWALK_OK,
            "the default navmesh is sound");
    return made;
  }();
  return navmesh;
}

bool isFinite(const forewalk_frame_out& out) {
  const forewalk_pose& pose = out.virtual_pose;
  float sum = 0.0f;  // finite only where all are; each is far below the largest float
  for (const float number :
       {pose.position.x, pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y,
        pose.orientation.z, pose.orientation.w, out.translation, out.rotation, out.curvature,
        out.bending, out.injected_yaw, out.injected_translation.x, out.injected_translation.y,
        out.injected_translation.z, out.reset_remaining, out.reset_turned, out.predict_seconds,
        out.steer_seconds}) {
    sum += number;
  }
  return std::isfinite(sum);
}

void frame(forewalk_session* session, forewalk_vec3 position, forewalk_quat orientation,
           double seconds) {
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  require(forewalk_frame(session, position, orientation, seconds, &out) == FOREWALK_OK,
          "a frame does not fail");
  require(isFinite(out), "what comes out of a frame is finite");
  require(out.flags < 1u << 13, "flags are those of the header");
  require(out.instruction >= FOREWALK_INSTRUCTION_NONE &&
              out.instruction <= FOREWALK_INSTRUCTION_TURN_RIGHT,
          "instructions are those of the header");
  // More than a turn only for who turns the other way than they are asked to.
  require(out.reset_remaining >= 0.0f, "what is left to turn is not negative");
}

void graph(forewalk_session* session) {
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  require(forewalk_graph(session, &view) == FOREWALK_OK, "a graph does not fail");
  float sum = 0.0f;
  for (std::uint32_t i = 0; i < view.node_count; ++i) {
    const forewalk_node& node = view.nodes[i];
    require(i == 0 ? node.prev == UINT32_MAX : node.prev < view.node_count, "nodes name nodes");
    sum += node.position.x + node.position.y + node.position.z + node.distance;
  }
  for (std::uint32_t i = 0; i < view.edge_count; ++i) {
    const forewalk_edge& edge = view.edges[i];
    require(edge.from < view.node_count && edge.to < view.node_count, "edges join nodes");
    require(edge.path_start <= view.point_count &&
                edge.path_count <= view.point_count - edge.path_start,
            "paths lie in the points");
    sum += edge.length;
  }
  for (std::uint32_t i = 0; i < view.point_count; ++i) {
    sum += view.points[i].x + view.points[i].y + view.points[i].z;
  }
  require(std::isfinite(sum), "a graph is finite");
}

forewalk_session_settings settingsFrom(Reader& reader, std::vector<forewalk_point2>& points,
                                       std::vector<std::size_t>& sizes) {
  forewalk_session_settings settings;
  forewalk_session_settings_init(&settings, sizeof settings);
  const auto touched = reader.raw<std::uint16_t>();
  settings.axes = reader.raw<std::uint8_t>() % 3;
  // A predictive one studies the room first, which takes long; veteran() sees to those.
  const auto controller = reader.raw<std::uint8_t>();
  settings.controller = controller < 255 ? controller % 3 : FOREWALK_CONTROLLER_S2O_PREDICTIVE;
  if (touched & 1u) settings.limits = reader.raw<std::uint8_t>() % 6;
  if (touched & 2u) settings.horizon = 20.0f * std::abs(reader.number());
  if (touched & 4u) settings.width = 4.0f * reader.number();
  if (touched & 8u) settings.depth = 400.0f * reader.number();
  if (touched & 16u) settings.struct_size = reader.raw<std::uint32_t>() % 200;
  if (touched & 32u) {
    settings.has_start = 1;
    settings.start_floor = reader.vector(settings.axes == FOREWALK_AXES_UNREAL ? 100.0f : 1.0f);
    settings.start_heading = reader.number();
  }
  if (touched & 64u) settings.polygon_limit = reader.raw<std::uint32_t>() % 8;
  if (touched & 128u) {
    settings.rotation_min = reader.number();
    settings.rotation_max = reader.number();
    settings.translation_min = reader.number();
    settings.translation_max = reader.number();
    settings.curvature_max = reader.number();
    settings.bending_min = reader.number();
    settings.bending_max = reader.number();
  }
  if (touched & 256u) {
    const std::size_t corners = reader.raw<std::uint8_t>() % 12;
    const std::size_t holes = reader.raw<std::uint8_t>() % 3;
    for (std::size_t i = 0; i < holes; ++i) sizes.push_back(reader.raw<std::uint8_t>() % 6);
    std::size_t all = corners;
    for (const std::size_t size : sizes) all += size;
    for (std::size_t i = 0; i < all; ++i) points.push_back({reader.number(), reader.number()});
    settings.border = points.data();
    settings.border_count = corners;
    settings.hole_points = points.data() + corners;
    settings.hole_sizes = sizes.data();
    settings.hole_count = holes;
  }
  if (touched & 512u) settings.resets = 0;
  if (touched & 1024u) settings.always_predict = 0;
  if (touched & 2048u) settings.axes = reader.raw<std::int32_t>();
  if (touched & 4096u) settings.controller = reader.raw<std::int32_t>();
  return settings;
}

forewalk_session* makeSession(const forewalk_navmesh* navmesh, Reader& reader) {
  std::vector<forewalk_point2> points;
  std::vector<std::size_t> sizes;
  const forewalk_session_settings settings = settingsFrom(reader, points, sizes);
  forewalk_session* session = nullptr;
  const forewalk_status status = forewalk_session_create(navmesh, &settings, &session);
  check(status);
  require((status == FOREWALK_OK) == (session != nullptr),
          "a session where and only where it is OK");
  return session;
}

/// A user with a predictive controller who lives through all inputs.
forewalk_session* veteran(std::uint8_t choice) {
  static forewalk_session* sessions[6] = {};
  forewalk_session*& session = sessions[choice % 6];
  if (session == nullptr) {
    forewalk_session_settings settings;
    forewalk_session_settings_init(&settings, sizeof settings);
    settings.axes = choice % 3;
    settings.controller =
        choice % 6 < 3 ? FOREWALK_CONTROLLER_S2C_PREDICTIVE : FOREWALK_CONTROLLER_S2O_PREDICTIVE;
    require(forewalk_session_create(defaultNavMesh(), &settings, &session) == FOREWALK_OK,
            "the default settings are sound");
  }
  return session;
}

/// A navmesh of the bytes where they make one, else the default one.
forewalk_navmesh* navMeshFrom(Reader& reader) {
  forewalk_navmesh* navmesh = nullptr;
  switch (reader.raw<std::uint8_t>() % 8) {
    case 0: {
      const std::vector<std::uint8_t> bytes = reader.block();
      check(forewalk_navmesh_from_fwmesh(bytes.data(), bytes.size(), &navmesh));
      break;
    }
    case 1: {
      // On a raster, so that the grid of voxels stays small.
      std::vector<float> vertices(3 * (reader.raw<std::uint8_t>() % 12u));
      for (float& coordinate : vertices)
        coordinate = 0.05f * static_cast<float>(reader.raw<std::int8_t>());
      std::vector<std::uint32_t> indices(reader.raw<std::uint8_t>() % 24u);
      for (std::uint32_t& index : indices) index = reader.raw<std::uint8_t>() % 13u;
      forewalk_build_settings settings;
      forewalk_build_settings_init(&settings, sizeof settings);
      settings.partition = reader.raw<std::uint8_t>() % 4;
      if (reader.raw<std::uint8_t>() % 4 == 0) settings.slope = reader.number();
      if (reader.raw<std::uint8_t>() % 4 == 0) settings.radius = reader.number();
      check(forewalk_navmesh_from_triangles(vertices.data(), vertices.size() / 3, indices.data(),
                                            indices.size(), reader.raw<std::uint8_t>() % 4,
                                            &settings, &navmesh));
      break;
    }
    default:
      break;
  }
  if (navmesh == nullptr) {
    navmesh = defaultNavMesh();
    forewalk_navmesh_retain(navmesh);
  }
  return navmesh;
}

/// A user who stands at the origin is told so, whatever was before.
void stillUsable(forewalk_session* session) {
  static double later = 1e12;  // than any input's time
  for (int i = 0; i < 3; ++i) {
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    later += 1.0;
    require(forewalk_frame(session, {0, 0, 0}, {0, 0, 0, 1}, later, &out) == FOREWALK_OK,
            "the session stays usable");
    require(isFinite(out), "what comes out of a frame is finite");
    constexpr std::uint32_t kOfOddInput =
        FOREWALK_FLAG_POSE_NOT_FINITE | FOREWALK_FLAG_ORIENTATION_NOT_UNIT |
        FOREWALK_FLAG_ORIENTATION_UNUSABLE | FOREWALK_FLAG_TIME_RAN_BACKWARDS |
        FOREWALK_FLAG_TRACKING_JUMP;
    require(i < 2 || (out.flags & kOfOddInput) == 0, "odd input is forgotten");
  }
  graph(session);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Reader reader(data, size);
  forewalk_navmesh* navmesh = navMeshFrom(reader);
  forewalk_session* session = makeSession(navmesh, reader);
  forewalk_navmesh_release(navmesh);
  if (session == nullptr) return 0;

  forewalk_session* const users[] = {session, veteran(reader.raw<std::uint8_t>())};
  double seconds = 0.0;
  for (int calls = 0; calls < 400 && !reader.spent(); ++calls) {
    const auto call = reader.raw<std::uint8_t>();
    const forewalk_vec3 place = reader.vector(call & 8u ? 1.0f : 100.0f);
    forewalk_quat orientation{0, 0, 0, 1};
    switch (call % 16) {
      case 0: {
        const float heading = reader.number();
        for (forewalk_session* user : users) check(forewalk_session_teleport(user, place, heading));
        break;
      }
      case 1:
        for (forewalk_session* user : users) graph(user);
        break;
      case 2:
        seconds = static_cast<double>(reader.number()) * static_cast<double>(reader.number());
        for (forewalk_session* user : users) frame(user, place, orientation, seconds);
        break;
      case 3: {
        forewalk_frame_out out{};
        out.struct_size = reader.raw<std::uint32_t>();
        check(forewalk_frame(session, place, orientation, seconds, &out));
        break;
      }
      case 4:
        check(forewalk_frame(call < 128 ? session : nullptr, place, orientation, seconds, nullptr));
        break;
      default:
        seconds += 0.01 * static_cast<double>(call >> 4);
        orientation = {reader.number(), reader.number(), reader.number(), reader.number()};
        for (forewalk_session* user : users) frame(user, place, orientation, seconds);
        break;
    }
  }
  for (forewalk_session* user : users) stillUsable(user);
  forewalk_session_destroy(session);
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  std::vector<std::vector<std::uint8_t>> seeds;
  const auto walk = [](std::vector<std::uint8_t> seed) {
    // Frames of a walk: call, three coordinates and four of the orientation, each a choice and 16
    // bits.
    for (int i = 0; i < 12; ++i) {
      seed.push_back(0x1d);
      for (const int value : {40 * i, 8192, -60 * i, 0, 100 * i, 0, 8192}) {
        const auto word = static_cast<std::uint16_t>(value);
        seed.insert(seed.end(),
                    {200, static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8)});
      }
    }
    seed.push_back(1);
    return seed;
  };
  for (std::uint8_t axes = 0; axes < 3; ++axes) {
    for (std::uint8_t controller = 0; controller < 3; ++controller) {
      seeds.push_back(
          walk({2, 0, 0, axes, controller, static_cast<std::uint8_t>(axes + controller)}));
    }
  }
  // A navmesh of two triangles, then one of a .fwmesh.
  std::vector<std::uint8_t> floor = {1, 4};
  for (const int coordinate : {-60, 0, 60, 60, 0, 60, 60, 0, -60, -60, 0, -60}) {
    floor.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(coordinate)));
  }
  floor.insert(floor.end(), {6, 0, 1, 2, 0, 2, 3, 0, 1, 1, 0, 0, 0, 0, 2, 3});
  seeds.push_back(walk(floor));

  std::size_t size = 0;
  require(forewalk_navmesh_save(defaultNavMesh(), nullptr, &size) == FOREWALK_OK, "saved");
  std::vector<std::uint8_t> file(size);
  require(forewalk_navmesh_save(defaultNavMesh(), file.data(), &size) == FOREWALK_OK, "saved");
  std::vector<std::uint8_t> loaded = {0, static_cast<std::uint8_t>(size),
                                      static_cast<std::uint8_t>(size >> 8)};
  loaded.insert(loaded.end(), file.begin(), file.end());
  loaded.insert(loaded.end(), {0, 0, 0, 2, 4});
  seeds.push_back(walk(loaded));
  return seeds;
}
