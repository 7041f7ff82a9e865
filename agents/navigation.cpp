#include "agents/navigation.h"

#include <algorithm>
#include <limits>

#include "navmesh/funnel.h"
#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

// Out of sight of its next corner for so many ticks, an agent asks for another path: rounding hides
// corners for a moment, and a search costs more than a look.
constexpr std::uint8_t kLost = 10;

float squaredDistance(glm::vec2 a, glm::vec2 b) { return glm::dot(a - b, a - b); }

}  // namespace

void Navigation::setWorld(std::shared_ptr<const navmesh::World> world) {
  world_ = std::move(world);
  states_ = nullptr;
  for (Route& route : routes_) {
    route.place = {};
    if (route.state != Route::State::none) want(route);
  }
}

void Navigation::setCells(std::optional<GroundCells> cells) {
  cells_.reset();
  if (cells) {
    cells_.emplace(std::move(*cells));
    for (std::size_t k = 0; k < routes_.size(); ++k) cells_->add();
  }
  for (Route& route : routes_) {
    if (route.state != Route::State::none) want(route);
  }
}

void Navigation::add() {
  routes_.emplace_back();
  if (cells_) cells_->add();
}

void Navigation::setStates(std::shared_ptr<const navmesh::PolygonStates> states) {
  if (!world_) return;
  const navmesh::PolygonStates open;
  const navmesh::PolygonStates& was = states_ ? *states_ : open;
  const navmesh::PolygonStates& is = states ? *states : open;
  std::vector<glm::vec2> changed;  // where
  for (std::uint32_t polygon = 0; polygon < world_->graph.polygonCount(); ++polygon) {
    const navmesh::PolygonId id{polygon};
    if (was.costOf(id) != is.costOf(id)) changed.push_back(world_->graph.centroid[polygon]);
  }
  states_ = std::move(states);
  if (changed.empty()) return;
  struct Asking {
    float squaredDistance;
    std::uint32_t wantedSince, agent;
  };
  std::vector<Asking> asking;
  for (std::uint32_t i = 0; i < routes_.size(); ++i) {
    const Route& route = routes_[i];
    if (route.state == Route::State::none) continue;
    float nearest = std::numeric_limits<float>::infinity();
    for (const glm::vec2 place : changed) {
      nearest = std::min(nearest, squaredDistance(route.place.plan, place));
    }
    asking.push_back({nearest, route.wantedSince, i});
  }
  // By what all know of them, so that the order of storage does not matter.
  std::sort(asking.begin(), asking.end(), [](const Asking& a, const Asking& b) {
    return a.squaredDistance != b.squaredDistance ? a.squaredDistance < b.squaredDistance
                                                  : a.wantedSince < b.wantedSince;
  });
  for (const Asking& one : asking) wantAnew(routes_[one.agent]);
}

void Navigation::removeBySwap(std::uint32_t agent) {
  routes_[agent] = routes_.back();
  routes_.pop_back();
  if (cells_) cells_->removeBySwap(agent);
}

void Navigation::want(Route& route) {
  if (route.given) return;
  wantAnew(route);
  route.count = route.next = 0;
}

void Navigation::wantAnew(Route& route) {
  if (route.given) return;
  route.state = Route::State::wanted;
  route.wantedSince = asked_++;
}

void Navigation::setGoal(std::uint32_t agent, glm::vec2 goal, float height) {
  Route& route = routes_[agent];
  route.given = false;
  route.goal = goal;
  route.goalHeight = height;
  want(route);
}

void Navigation::clearGoal(std::uint32_t agent) {
  routes_[agent].state = Route::State::none;
  routes_[agent].given = false;
  if (cells_) cells_->forget(agent);
}

void Navigation::setWay(std::uint32_t agent, std::span<const glm::vec2> corners, float beyond) {
  Route& route = routes_[agent];
  if (cells_) cells_->forget(agent);
  const std::size_t kept = std::min<std::size_t>(corners.size(), Route::kCorners);
  std::copy_n(corners.begin(), kept, route.corners.begin());
  route.state = Route::State::found;
  route.given = true;
  route.toTheGoal = true;  // as far as this crowd can tell
  route.count = static_cast<std::uint8_t>(kept);
  route.next = 0;
  route.goal = route.corners[kept - 1];
  route.beyond = beyond;
}

void Navigation::moved(std::uint32_t agent) {
  Route& route = routes_[agent];
  // A human is placed every frame, a small step away: following goes on from the last place.
  if ((world_ || cells_) && route.state == Route::State::found) want(route);
}

void Navigation::updateCells() {
  const bool changed = cells_->update([&](std::uint32_t agent) {
    if (routes_[agent].state != Route::State::found) return;
    want(routes_[agent]);
    ++notified_;
  });
  if (!changed) return;
  for (Route& route : routes_) {
    if (route.state != Route::State::closed) continue;
    want(route);
    ++notified_;
  }
}

void Navigation::findPaths(std::span<const glm::vec2> positions, std::span<const float> heights,
                           std::span<const float> radii) {
  waiting_ = closed_ = notified_ = 0;
  if (cells_) updateCells();
  queue_.clear();
  for (std::uint32_t i = 0; i < routes_.size(); ++i) {
    Route& route = routes_[i];
    if (route.state == Route::State::closed) ++closed_;
    if (route.state != Route::State::wanted) continue;
    if (!world_ && !cells_) {
      route.state = Route::State::found;
      route.corners[0] = route.goal;
      route.count = 1;
      route.next = 0;
      route.toTheGoal = true;
      route.beyond = 0.0f;
      continue;
    }
    queue_.push_back(i);
  }
  const std::size_t budget = std::min<std::size_t>(queue_.size(), settings_.pathsPerTick);
  waiting_ = static_cast<std::uint32_t>(queue_.size() - budget);
  // Nobody asks at the same time as another, so the order is that of asking and no other.
  std::partial_sort(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(budget),
                    queue_.end(), [&](std::uint32_t a, std::uint32_t b) {
                      return routes_[a].wantedSince < routes_[b].wantedSince;
                    });
  for (std::size_t k = 0; k < budget; ++k) {
    find(queue_[k], positions[queue_[k]], heights[queue_[k]], radii[queue_[k]]);
    if (routes_[queue_[k]].state == Route::State::closed) ++closed_;
  }
}

void Navigation::find(std::uint32_t agent, glm::vec2 position, float height, float radius) {
  Route& route = routes_[agent];
  route.state = Route::State::closed;
  route.count = route.next = 0;
  const bool found =
      cells_ ? cells_->find(agent, position, route.goal, radius, settings_.snap.distance, path_)
             : findOnNavMesh(route, position, height);
  if (!found) return;
  // The path's first point is where the agent stands.
  if (path_.size() == 1) path_.push_back(path_.back());
  const std::size_t kept = std::min<std::size_t>(path_.size() - 1, Route::kCorners);
  std::copy_n(path_.begin() + 1, kept, route.corners.begin());
  route.count = static_cast<std::uint8_t>(kept);
  route.toTheGoal = kept + 1 >= path_.size();
  route.beyond = navmesh::lengthOf(std::span<const glm::vec2>(path_).subspan(kept));
  route.state = Route::State::found;
}

bool Navigation::findOnNavMesh(Route& route, glm::vec2 position, float height) {
  const navmesh::NavGraph& graph = world_->graph;
  if (route.place.polygon == navmesh::kNoPolygon) {
    const auto here = navmesh::locate(graph, world_->locations, navmesh::toSpace(position, height),
                                      settings_.snap);
    if (!here) return false;
    route.place = *here;
  }
  const auto there = navmesh::locate(
      graph, world_->locations, navmesh::toSpace(route.goal, route.goalHeight), settings_.snap);
  if (!there) return false;
  if (!navmesh::findCorridor(graph, route.place, *there, scratch_, corridor_, states_.get())) {
    return false;
  }
  navmesh::pullString(graph, route.place.plan, there->plan, corridor_, path_);
  if (path_.size() == 1) path_.push_back(there->plan);
  return true;
}

bool Navigation::sees(const navmesh::Location& from, glm::vec2 to) const {
  const navmesh::NavGraph& graph = world_->graph;
  navmesh::PolygonId polygon = from.polygon;
  // What lies in between and costs more is what the path goes around.
  const float most = states_ ? std::max(1.0f, states_->costOf(polygon)) : 1.0f;
  std::uint32_t enteredBy = 0xffffffffu;  // half-portal of `polygon` we came in by
  for (std::uint32_t steps = 0; steps <= graph.polygonCount(); ++steps) {
    if (navmesh::contains(graph, polygon, to)) return true;
    std::uint32_t out = 0xffffffffu;
    for (std::uint32_t h = graph.portalStart[navmesh::index(polygon)];
         h < graph.portalStart[navmesh::index(polygon) + 1]; ++h) {
      if (h == enteredBy) continue;
      const navmesh::Portal& portal = graph.portals[h];
      // Through it, and outward: left on the left, right on the right, the end beyond.
      if (navmesh::turn(from.plan, to, portal.left) >= 0.0f &&
          navmesh::turn(from.plan, to, portal.right) <= 0.0f &&
          navmesh::turn(portal.right, portal.left, to) <= 0.0f) {
        out = h;
        break;
      }
    }
    if (out == 0xffffffffu) return false;
    enteredBy = graph.portalTwin[out];
    polygon = graph.portalTo[out];
    if (states_ && (states_->costOf(polygon) > most || states_->isClosed(polygon))) return false;
  }
  return false;
}

SubGoal Navigation::advance(std::uint32_t agent, glm::vec2 position) {
  Route& route = routes_[agent];
  if (route.count == 0 || route.state == Route::State::none) return {position, 0.0f};
  const float reach = settings_.cornerReach * settings_.cornerReach;
  while (route.next + 1 < route.count) {
    const bool reached = squaredDistance(position, route.corners[route.next]) < reach;
    const glm::vec2 after = route.corners[route.next + 1u];
    const bool seesOn =
        cells_ ? cells_->sees(agent, position, after)
               : route.place.polygon != navmesh::kNoPolygon && sees(route.place, after);
    if (!reached && !seesOn) break;
    ++route.next;
  }
  if (route.place.polygon != navmesh::kNoPolygon && route.state == Route::State::found &&
      !route.given) {
    const bool inSight = sees(route.place, route.corners[route.next]);
    route.lost = inSight ? std::uint8_t{0} : static_cast<std::uint8_t>(route.lost + 1);
    if (route.lost == kLost) {
      route.lost = 0;
      route.state = Route::State::wanted;  // in the turn it once had: first among those who ask
    }
  }
  const bool last = route.next + 1 == route.count;
  if (last && !route.toTheGoal && route.state == Route::State::found &&
      squaredDistance(position, route.corners[route.next]) < 4.0f) {
    // Found anew before the last corner is reached, likewise.
    route.state = Route::State::wanted;
  }
  if (cells_ && !route.given && cells_->lost(position, route.corners[route.next])) {
    route.state = Route::State::wanted;
  }
  SubGoal goal{route.corners[route.next], glm::distance(position, route.corners[route.next])};
  for (std::uint32_t k = route.next; k + 1u < route.count; ++k) {
    goal.remaining += glm::distance(route.corners[k], route.corners[k + 1u]);
  }
  goal.remaining += route.beyond;
  return goal;
}

bool Navigation::follow(std::uint32_t agent, glm::vec2& position, float& height) {
  Route& route = routes_[agent];
  if (!world_) return false;
  const glm::vec3 space = navmesh::toSpace(position, height);
  const auto place = route.place.polygon == navmesh::kNoPolygon
                         ? navmesh::locate(world_->graph, world_->locations, space, settings_.snap)
                         : navmesh::locateFrom(world_->graph, world_->locations, route.place, space,
                                               settings_.snap);
  if (!place) {
    route.place = {};
    return false;
  }
  route.place = *place;
  position = place->plan;
  height = place->height;
  return true;
}

}  // namespace forewalk::agents
