// A world that moves: service/live_world.h for C.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/build/obstacle.h"
#include "navmesh/plan.h"
#include "service/capi/axes.h"
#include "service/capi/build_settings.h"
#include "service/capi/log.h"
#include "service/capi/session_handle.h"
#include "service/capi/session_settings.h"
#include "service/capi/status.h"
#include "service/live_world.h"

struct forewalk_world {
  forewalk_world(std::shared_ptr<forewalk::service::LiveWorld> made, forewalk_axes spoken)
      : world(std::move(made)), axes(spoken) {}

  std::shared_ptr<forewalk::service::LiveWorld> world;  // sessions hold this, not the handle
  const forewalk_axes axes;
  std::atomic<std::uint32_t> owners{1};
};

namespace forewalk::capi {

namespace {

constexpr float kTile = 6.4f;        // metres
constexpr float kUnderADoor = 0.5f;  // metres of its area below its lowest corner
constexpr float kDoorHeight = 2.0f;  // metres above it
constexpr std::size_t kMostCorners = 64;

forewalk_world_settings defaultWorldSettings() {
  forewalk_world_settings settings{};
  settings.struct_size = sizeof settings;
  settings.axes = FOREWALK_AXES_OPENXR;
  return settings;
}

tl::unexpected<Error> refused(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

// On the plan, counter-clockwise, and the height of the lowest.
struct Outline {
  std::vector<glm::vec2> corners;
  float bottom = 0.0f;
};

tl::expected<Outline, Error> outlineFrom(forewalk_axes axes, const forewalk_vec3* corners,
                                         std::size_t count, const std::string& whose) {
  if (corners == nullptr || count < 3 || count > kMostCorners) {
    return refused(whose + ": " + std::to_string(corners == nullptr ? 0 : count) +
                   " corners cannot work: give 3 to " + std::to_string(kMostCorners) + ".");
  }
  Outline outline;
  double area = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 corner = positionFrom(axes, corners[i]);
    outline.bottom = i == 0 ? corner.y : std::min(outline.bottom, corner.y);
    outline.corners.push_back(navmesh::toPlan(corner));
    area += navmesh::cross(glm::dvec2(outline.corners[i > 0 ? i - 1 : 0]),
                           glm::dvec2(outline.corners[i]));
  }
  area += navmesh::cross(glm::dvec2(outline.corners.back()), glm::dvec2(outline.corners.front()));
  if (area < 0.0) std::reverse(outline.corners.begin(), outline.corners.end());
  return outline;
}

tl::expected<navmesh::Obstacle, Error> obstacleFrom(forewalk_axes axes,
                                                    const forewalk_obstacle& theirs) {
  const std::string whose = "obstacle " + std::to_string(theirs.id);
  const glm::vec3 position = positionFrom(axes, theirs.position);
  switch (theirs.shape) {
    case FOREWALK_SHAPE_BOX:
      return navmesh::BoxObstacle{position, glm::abs(positionFrom(axes, theirs.half_size)),
                                  angleSign(axes) * theirs.heading};
    case FOREWALK_SHAPE_CYLINDER:
      return navmesh::CylinderObstacle{position, theirs.radius, theirs.height};
    case FOREWALK_SHAPE_PRISM: {
      auto outline = outlineFrom(axes, theirs.corners, theirs.corner_count, whose);
      if (!outline) return tl::unexpected(outline.error());
      return navmesh::PrismObstacle{std::move(outline->corners), outline->bottom,
                                    outline->bottom + theirs.height};
    }
    default:
      return refused(whose + ": shape " + std::to_string(theirs.shape) +
                     " is none of FOREWALK_SHAPE_BOX, _CYLINDER, _PRISM (0 to 2).");
  }
}

tl::expected<navmesh::PlanArea, Error> areaFrom(forewalk_axes axes, const forewalk_door& door) {
  const std::string whose = "door " + std::to_string(door.id);
  auto outline = outlineFrom(axes, door.corners, door.corner_count, whose);
  if (!outline) return tl::unexpected(outline.error());
  const float height = door.height == 0.0f ? kDoorHeight : door.height;
  if (!(height > 0.0f)) {
    return refused(whose + ": a height of " + std::to_string(height) +
                   " m cannot work: give more than 0, or 0 for 2 m.");
  }
  return navmesh::PlanArea{std::move(outline->corners), outline->bottom - kUnderADoor,
                           outline->bottom + height};
}

tl::expected<void, Error> setDoor(service::LiveWorld& world, forewalk_axes axes,
                                  const forewalk_door& door) {
  auto area = areaFrom(axes, door);
  if (!area) return tl::unexpected(area.error());
  const float cost = door.open != 0 ? 1.0f : door.cost == 0.0f ? navmesh::kClosed : door.cost;
  return world.setArea(service::AreaId{door.id}, {std::move(*area), cost});
}

// `scene` is called with how to import and fills in a scene, or refuses.
template <typename MakeScene>
forewalk_status makeWorld(const forewalk_world_settings* given, MakeScene makeScene,
                          forewalk_world** world) {
  forewalk_world_settings known = defaultWorldSettings();
  if (const auto status = readSettings(given, "forewalk_world_settings", known)) return status;
  if (known.axes < FOREWALK_AXES_OPENXR || known.axes > FOREWALK_AXES_UNREAL) {
    return unknownConstant("forewalk_world_settings", "axes", known.axes, FOREWALK_AXES_UNREAL);
  }
  if (known.doors == nullptr && known.door_count > 0) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_world_settings: doors is null while door_count is not 0.");
  }
  Preparation preparation;
  if (const auto status = read(known.build, preparation)) return status;
  service::LiveWorldSettings settings;
  settings.build = preparation.build;
  if (settings.build.tile == 0.0f) settings.build.tile = kTile;
  for (std::size_t i = 0; i < known.door_count; ++i) {
    auto area = areaFrom(known.axes, known.doors[i]);
    if (!area) return fail(area.error());
    settings.outlines.push_back(
        navmesh::PrismObstacle{std::move(area->corners), area->bottom, area->top});
  }
  navmesh::Scene scene;
  if (const auto status = makeScene(known.axes, preparation, scene)) return status;
  auto live = service::LiveWorld::make(std::move(scene), settings);
  if (!live) return fail(live.error());
  for (std::size_t i = 0; i < known.door_count; ++i) {
    if (auto set = setDoor(**live, known.axes, known.doors[i]); !set) return fail(set.error());
  }
  *world = new forewalk_world(std::move(*live), known.axes);
  tell(FOREWALK_LOG_INFO, "world: {} polygons, {} doors.",
       (*world)->world->reader().version().world->graph.polygonCount(), known.door_count);
  return FOREWALK_OK;
}

// A session's view of the world, which it keeps alive.
class Follower final : public WorldFollower {
 public:
  Follower(std::shared_ptr<service::LiveWorld> world, service::WorldReader reader)
      : world_(std::move(world)), reader_(std::move(reader)) {}
  bool update(rdw::Session& session) override { return reader_.update(session); }

 private:
  std::shared_ptr<service::LiveWorld> world_;
  service::WorldReader reader_;
};

forewalk_status statusOf(const tl::expected<void, Error>& done) {
  return done ? FOREWALK_OK : fail(done.error());
}

}  // namespace

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_world_settings_init(forewalk_world_settings* settings, uint32_t struct_size) {
  initKnown(defaultWorldSettings(), settings, struct_size);
}

forewalk_status forewalk_world_from_file(const char* path, const forewalk_world_settings* settings,
                                         forewalk_world** world) {
  if (world != nullptr) *world = nullptr;
  if (path == nullptr || world == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_from_file: path or world is null.");
  }
  return guarded([&]() -> forewalk_status {
    const std::filesystem::path file(std::u8string(path, path + std::strlen(path)));
    return makeWorld(
        settings,
        [&](forewalk_axes, const Preparation& preparation, navmesh::Scene& scene) {
          const auto ending = file.extension();
          if (ending == ".fwmesh" || ending == ".bin") {
            return fail(FOREWALK_ERROR_FORMAT_UNSUPPORTED,
                        std::string(path) +
                            ": holds a built navmesh, and a world that moves needs the scene: "
                            ".obj, .off, .ply, .stl, .gltf or .glb.");
          }
          auto made = navmesh::importScene(file, preparation.import);
          if (!made) return fail(made.error());
          scene = std::move(*made);
          return static_cast<forewalk_status>(FOREWALK_OK);
        },
        world);
  });
}

forewalk_status forewalk_world_from_triangles(const float* vertices, size_t vertex_count,
                                              const uint32_t* indices, size_t index_count,
                                              const forewalk_world_settings* settings,
                                              forewalk_world** world) {
  if (world == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_from_triangles: world is null.");
  }
  *world = nullptr;
  return guarded([&]() -> forewalk_status {
    return makeWorld(
        settings,
        [&](forewalk_axes axes, const Preparation& preparation, navmesh::Scene& scene) {
          return sceneFrom({vertices, vertex_count, indices, index_count}, axes, preparation,
                           scene);
        },
        world);
  });
}

void forewalk_world_retain(forewalk_world* world) {
  if (world != nullptr) world->owners.fetch_add(1, std::memory_order_relaxed);
}

void forewalk_world_release(forewalk_world* world) {
  if (world == nullptr) return;
  if (world->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete world;
}

forewalk_status forewalk_world_set_obstacles(forewalk_world* world,
                                             const forewalk_obstacle* obstacles, size_t count) {
  if (world == nullptr || (obstacles == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_world_set_obstacles: world or obstacles is null.");
  }
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::ObstacleChange> changes;
    for (size_t i = 0; i < count; ++i) {
      auto obstacle = obstacleFrom(world->axes, obstacles[i]);
      if (!obstacle) return fail(obstacle.error());
      changes.push_back({navmesh::ObstacleId{obstacles[i].id}, std::move(*obstacle)});
    }
    return statusOf(world->world->change(changes));
  });
}

forewalk_status forewalk_world_remove_obstacle(forewalk_world* world, uint32_t id) {
  if (world == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_remove_obstacle: world is null.");
  }
  return guarded([&] {
    const navmesh::ObstacleChange change{navmesh::ObstacleId{id}, std::nullopt};
    return statusOf(world->world->change({&change, 1}));
  });
}

forewalk_status forewalk_world_set_door(forewalk_world* world, const forewalk_door* door) {
  if (world == nullptr || door == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_set_door: world or door is null.");
  }
  return guarded([&] { return statusOf(setDoor(*world->world, world->axes, *door)); });
}

forewalk_status forewalk_world_set_link(forewalk_world* world, const forewalk_link* link) {
  if (world == nullptr || link == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_set_link: world or link is null.");
  }
  return guarded([&] { return statusOf(world->world->setLink(linkFrom(world->axes, *link))); });
}

forewalk_status forewalk_world_remove_link(forewalk_world* world, uint32_t id) {
  if (world == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_remove_link: world is null.");
  }
  return guarded([&]() -> forewalk_status {
    world->world->removeLink(navmesh::LinkId{id});
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_world_set_standing(forewalk_world* world,
                                            const forewalk_standing* standing, size_t count) {
  if (world == nullptr || (standing == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_world_set_standing: world or standing is null.");
  }
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::Standing> people;
    for (size_t i = 0; i < count; ++i) people.push_back(standingFrom(world->axes, standing[i]));
    const auto set = world->world->setStanding(people);
    return set ? FOREWALK_OK : fail(set.error());
  });
}

forewalk_status forewalk_world_wait(forewalk_world* world) {
  if (world == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_world_wait: world is null.");
  }
  return guarded([&]() -> forewalk_status {
    world->world->waitUntilDone();
    const std::string failure = world->world->status().failure;
    return failure.empty() ? FOREWALK_OK : fail(FOREWALK_ERROR_NOTHING_WALKABLE, failure);
  });
}

uint64_t forewalk_world_version(const forewalk_world* world) {
  return world == nullptr ? 0 : world->world->status().version;
}

forewalk_status forewalk_session_create_in_world(forewalk_world* world,
                                                 const forewalk_session_settings* settings,
                                                 forewalk_session** session) {
  if (session != nullptr) *session = nullptr;
  if (world == nullptr || session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_create_in_world: world or session is null.");
  }
  return guarded([&]() -> forewalk_status {
    forewalk_session_settings known;
    rdw::SessionSettings ours;
    if (const auto status = readSession(settings, known, ours)) return status;
    service::WorldReader reader = world->world->readerForSession(ours.prediction, ours.method);
    ours.states = reader.version().states;
    if (const auto status = createSession(reader.version().world, known, std::move(ours), session))
      return status;
    (*session)->follows = std::make_unique<Follower>(world->world, std::move(reader));
    return FOREWALK_OK;
  });
}

}  // extern "C"
