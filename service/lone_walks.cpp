#include "service/lone_walks.h"

#include <algorithm>
#include <cmath>

#include "agents/crowd.h"
#include "agents/evaluation/dtw.h"
#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
#include "navmesh/plan.h"
#include "service/crowd_models.h"

namespace forewalk::service {
namespace {

constexpr float kTick = 0.1f;              // seconds
constexpr float kRadius = 0.25f;           // metres
constexpr float kGoalRadius = 0.15f;       // metres
constexpr float kHaste = 1.5f;             // the fastest, in comfort speeds
constexpr float kPatience = 4.0f;          // times what the straight way takes
constexpr float kPatienceMore = 10.0f;     // seconds
constexpr float kAvatarPatience = 300.0f;  // seconds to each object: the autopilot is slow
constexpr double kSceneSpeed = 1.3;        // m/s
constexpr float kBefore = 0.5f;            // metres before a box
constexpr navmesh::SnapLimits kBeside{0.5f, 2.2f, 2.2f};  // as walks are recorded (recording.h)

glm::vec3 above(glm::dvec2 plan) { return navmesh::toSpace(glm::vec2(plan), 0.0f); }

/// Steps a crowd of one until `done`, or for `patience` seconds.
template <typename Done>
bool walkUntil(agents::Crowd& crowd, float patience, std::vector<glm::dvec2>& path,
               const Done& done) {
  const auto ticks = static_cast<int>(std::ceil(patience / kTick));
  for (int tick = 0; tick < ticks; ++tick) {
    if (done()) return true;
    crowd.step(kTick);
    path.push_back(crowd.view().position[0]);
  }
  return done();
}

// Samples kTick apart to samples 1 / rate apart, linear between.
std::vector<glm::dvec2> atRate(const std::vector<glm::dvec2>& ticks, double rate) {
  std::vector<glm::dvec2> points;
  const double perTick = rate * static_cast<double>(kTick);
  const double most = static_cast<double>(ticks.size() - 1) * perTick;
  for (std::size_t k = 0; static_cast<double>(k) <= most + 1e-6; ++k) {
    const double at =
        std::min(static_cast<double>(k) / perTick, static_cast<double>(ticks.size() - 1));
    const std::size_t before = std::min(static_cast<std::size_t>(at), ticks.size() - 1);
    const std::size_t after = std::min(before + 1, ticks.size() - 1);
    points.push_back(glm::mix(ticks[before], ticks[after], at - static_cast<double>(before)));
  }
  return points;
}

}  // namespace

std::vector<LoneModel> loneModels() {
  std::vector<LoneModel> models;
  for (const RegisteredModel& model : registeredModels()) {
    models.push_back({std::string(model.name), model.read(nullptr)});
  }
  return models;
}

std::vector<glm::dvec2> tautPath(const navmesh::World& world, glm::dvec2 from, glm::dvec2 to) {
  const auto start = navmesh::locate(world.graph, world.locations, above(from), kBeside);
  const auto goal = navmesh::locate(world.graph, world.locations, above(to), kBeside);
  if (!start || !goal) return {};
  navmesh::CorridorScratch scratch;
  std::vector<std::uint32_t> corridor;
  if (!navmesh::findCorridor(world.graph, *start, *goal, scratch, corridor)) return {};
  std::vector<glm::vec2> taut;
  navmesh::pullString(world.graph, start->plan, goal->plan, corridor, taut);
  std::vector<glm::dvec2> path(taut.begin(), taut.end());
  if (path.size() == 1) path.push_back(path.front());
  path.front() = from;
  path.back() = to;
  return path;
}

LonePath walkErrand(const std::shared_ptr<const navmesh::World>& world, float walkerRadius,
                    const LoneModel& model, const Errand& errand) {
  agents::CrowdSettings settings;
  settings.navigation.walkerRadius = walkerRadius;
  agents::Crowd crowd(settings);
  crowd.setWorld(world);
  agents::AgentSpec spec;
  spec.model = crowd.addModel(model.make());
  spec.position = errand.from;
  spec.heading = static_cast<float>(errand.heading);
  spec.radius = kRadius;
  spec.preferredSpeed = static_cast<float>(errand.speed);
  spec.maximumSpeed = kHaste * spec.preferredSpeed;
  spec.goalRadius = kGoalRadius;
  LonePath path;
  std::vector<glm::dvec2> ticks{errand.from};
  if (const auto walker = crowd.add(spec)) {
    crowd.setGoal(*walker, errand.to);
    const double way = agents::pathLength(tautPath(*world, errand.from, errand.to));
    path.arrived =
        walkUntil(crowd, kPatience * static_cast<float>(way / errand.speed) + kPatienceMore, ticks,
                  [&] { return crowd.arrived(*walker); });
  }
  path.seconds = static_cast<double>(kTick) * static_cast<double>(ticks.size() - 1);
  path.points = atRate(ticks, errand.rate);
  return path;
}

LonePath walkScene(const agents::AvatarScene& scene, const LoneModel& model) {
  agents::Crowd crowd;
  agents::AgentSpec spec;
  spec.model = crowd.addModel(model.make());
  spec.position = scene.start;
  spec.radius = 1.0f;
  spec.preferredSpeed = static_cast<float>(kSceneSpeed);
  const agents::AvatarObject* first = &scene.objects[scene.visits.front() - 1];
  spec.heading = navmesh::headingOf(first->centre - scene.start);
  agents::CellSettings cells;
  cells.low = cells.high = scene.start;
  for (const agents::AvatarObject& object : scene.objects) {
    cells.low = glm::min(cells.low, object.centre);
    cells.high = glm::max(cells.high, object.centre);
  }
  cells.low -= 6.0f;
  cells.high += 6.0f;
  cells.reach = 1.25f;
  const auto boxOf = [](const agents::AvatarObject& object) {
    return navmesh::BoxObstacle{navmesh::toSpace(object.centre, 1.0f),
                                {object.halfSize.x, 1.0f, object.halfSize.y},
                                object.heading};
  };
  std::vector<navmesh::ObstacleId> ids;
  for (const agents::AvatarObject& object : scene.objects) {
    ids.push_back(*crowd.addObstacle(boxOf(object)));  // ours, and valid
  }
  const auto walker = crowd.add(spec);
  LonePath path;
  std::vector<glm::dvec2> ticks{scene.start};
  path.arrived = walker && crowd.setCells(cells).has_value();
  for (const std::uint32_t visit : scene.visits) {
    if (!path.arrived) break;
    const agents::AvatarObject& object = scene.objects[visit - 1];
    crowd.removeObstacle(ids[visit - 1]);
    crowd.setGoal(*walker, object.centre);
    const float near = glm::length(object.halfSize) + spec.radius + kBefore;
    const float way = glm::distance(crowd.view().position[0], object.centre) / spec.preferredSpeed;
    path.arrived = walkUntil(crowd, kPatience * way + kPatienceMore, ticks, [&] {
      return glm::distance(crowd.view().position[0], object.centre) <= near;
    });
    ids[visit - 1] = *crowd.addObstacle(boxOf(object));
  }
  path.seconds = static_cast<double>(kTick) * static_cast<double>(ticks.size() - 1);
  path.points = std::move(ticks);
  return path;
}

LonePath walkSceneAsAvatar(const agents::AvatarScene& scene) {
  agents::AvatarNavigation avatar = agents::populate(scene);
  LonePath path{{scene.start}, 0.0, true};
  for (const std::uint32_t visit : scene.visits) {
    avatar.walkTo(agents::ObjectId{visit});
    const auto ticks = static_cast<int>(kAvatarPatience / kTick);
    for (int tick = 0; tick < ticks && !avatar.arrived(); ++tick) {
      avatar.step(kTick);
      path.points.push_back(avatar.position());
    }
    path.arrived = path.arrived && avatar.arrived();
  }
  path.seconds = static_cast<double>(kTick) * static_cast<double>(path.points.size() - 1);
  return path;
}

}  // namespace forewalk::service
