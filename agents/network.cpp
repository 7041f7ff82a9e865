#include "agents/network.h"

#include <algorithm>
#include <cmath>

#include "agents/models/social_forces.h"

namespace forewalk::agents {
namespace {

constexpr float kHold = 0.5f;  // so long without a command the last one goes on, seconds

bool isFinite(glm::vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }

// Does what its memory row says: what came from a client.
class Commanded final : public Model {
 public:
  const char* name() const override { return "commanded"; }
  Needs needs() const override {
    Needs needs;
    needs.neighbourCount = needs.wallCount = 0;
    needs.neighbourRadius = needs.wallRadius = 0.0f;
    needs.memory = 2;
    return needs;
  }
  void plan(const PlanInput& input, Memory memory, Scratch&, std::span<Plan> plans) const override {
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      const std::span<const float> row = memory.of(input.which[k]);
      plans[k] = Plan::walk({row[0], row[1]});
    }
  }
};

CrowdSettings serverSettings(const NetworkSettings& settings) {
  CrowdSettings crowd;
  crowd.project = settings.resolveContacts;
  return crowd;
}

}  // namespace

NetworkClient::NetworkClient(const NetworkWelcome& welcome)
    : seconds_(welcome.seconds), deadReckoning_(welcome.deadReckoning) {
  crowd_.setFixedWalls(welcome.walls);
  SocialForceParameters parameters;
  if (!welcome.velocityBias) parameters.biasStrength = 0.0f;
  const ModelId model = crowd_.addModel(makeSocialForces(parameters));
  for (const NetworkWelcome::Member& member : welcome.members) {
    AgentSpec spec;
    spec.position = member.position;
    spec.velocity = member.velocity;
    spec.heading = member.heading;
    spec.radius = member.radius;
    spec.preferredSpeed = member.preferredSpeed;
    spec.maximumSpeed = member.maximumSpeed;
    spec.group = member.group;
    const bool own = member.client == welcome.client && member.flags == 0;
    // Others are moved by what the server says, and by nothing here.
    spec.flags = own ? 0 : static_cast<std::uint8_t>(member.flags | kHuman);
    if (own) spec.model = model;
    const auto id = crowd_.add(spec);
    if (!id) break;  // numbers that no server sends: nobody after it is known
    isOwn_.push_back(own);
    fresh_.push_back(true);
    if (own) own_.push_back({*id, std::vector<glm::vec2>(kRemembered, member.position)});
  }
}

NetworkClient::Own* NetworkClient::ownOf(std::uint32_t agent) {
  const auto at = std::lower_bound(
      own_.begin(), own_.end(), agent,
      [](const Own& own, std::uint32_t wanted) { return number(own.id) < wanted; });
  return at != own_.end() && number(at->id) == agent ? &*at : nullptr;
}

void NetworkClient::follow(Own& own, const NetworkSnapshot::Way& way) {
  if (way.count == 0 || way.count > NetworkSnapshot::Way::kCorners) {
    crowd_.clearGoal(own.id);
    own.way.count = 0;
    return;
  }
  // Told from behind, as it was some time ago: corners passed since are not walked back to.
  std::uint32_t first = 0;
  const std::uint32_t passed = own.way.count == 0 ? 0 : crowd_.routeOf(own.id).next + own.passed;
  for (std::uint32_t k = 0; k < passed; ++k) {
    while (first + 1 < way.count && way.corners[first] == own.way.corners[k]) ++first;
  }
  own.way = way;
  own.passed = first;
  crowd_.setWay(own.id, std::span(way.corners).subspan(first, way.count - first), way.beyond);
}

void NetworkClient::receive(const NetworkSnapshot& snapshot) {
  if (any_ && snapshot.tick <= seen_) return;
  any_ = true;
  seen_ = snapshot.tick;
  for (const NetworkSnapshot::State& state : snapshot.states) {
    if (state.agent >= isOwn_.size() || !isFinite(state.position) || !isFinite(state.velocity) ||
        !std::isfinite(state.heading)) {
      continue;
    }
    const AgentId id{state.agent};
    if (!isOwn_[state.agent]) {
      crowd_.place(id, state.position, 0.0f, state.heading, state.velocity);
      fresh_[state.agent] = true;
      continue;
    }
    Own& own = *ownOf(state.agent);
    // Before its first command counts, it is where the server has it; what is too old to be
    // remembered corrects nothing.
    if (snapshot.answered > number_ || snapshot.answered + kRemembered <= number_) continue;
    if (snapshot.answered == 0 && number_ > 0) continue;
    glm::vec2 shift = state.position - own.after[snapshot.answered % kRemembered];
    if (number_ == 0) shift = state.position - crowd_.view().position[crowd_.indexOf(id)];
    if (!(glm::dot(shift, shift) > 1e-10f)) continue;
    for (std::uint64_t k = snapshot.answered; k <= number_; ++k)
      own.after[k % kRemembered] += shift;
    const AgentsView view = crowd_.view();
    const std::uint32_t i = crowd_.indexOf(id);
    crowd_.place(id, view.position[i] + shift, 0.0f, view.heading[i], view.velocity[i]);
  }
  for (const NetworkSnapshot::Way& way : snapshot.ways) {
    const bool finite =
        std::isfinite(way.beyond) && std::all_of(way.corners.begin(), way.corners.end(), isFinite);
    Own* own = ownOf(way.agent);
    if (own && finite) follow(*own, way);
  }
}

NetworkCommand NetworkClient::step() {
  NetworkCommand command;
  command.number = ++number_;
  std::vector<glm::vec2> before;
  for (const Own& own : own_) before.push_back(crowd_.view().position[crowd_.indexOf(own.id)]);
  for (std::uint32_t agent = 0; agent < isOwn_.size(); ++agent) {
    if (isOwn_[agent]) continue;
    const AgentsView view = crowd_.view();
    const std::uint32_t i = crowd_.indexOf(AgentId{agent});
    if (deadReckoning_ && !fresh_[agent]) {
      crowd_.place(AgentId{agent}, view.position[i] + view.velocity[i] * seconds_, 0.0f,
                   view.heading[i], view.velocity[i]);
    }
    fresh_[agent] = false;
  }
  crowd_.step(seconds_);
  const AgentsView view = crowd_.view();
  for (std::size_t k = 0; k < own_.size(); ++k) {
    const std::uint32_t i = crowd_.indexOf(own_[k].id);
    own_[k].after[number_ % kRemembered] = view.position[i];
    command.motions.push_back(
        {number(own_[k].id), (view.position[i] - before[k]) / seconds_, view.heading[i]});
  }
  return command;
}

NetworkServer::NetworkServer(const NetworkSettings& settings)
    : settings_(settings), crowd_(serverSettings(settings)), clients_(settings.clients) {}

tl::expected<NetworkServer, Error> NetworkServer::make(const CrowdScene& scene,
                                                       const NetworkSettings& settings) {
  NetworkServer server(settings);
  const ModelId model = server.crowd_.addModel(std::make_unique<Commanded>());
  server.ids_ = populate(scene, model, server.crowd_);
  if (settings.cells) {
    if (auto laid = server.crowd_.setCells(*settings.cells); !laid) {
      return tl::unexpected(std::move(laid.error()));
    }
  }
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < scene.agents.size(); ++k) {
    const SceneAgent& agent = scene.agents[k];
    const bool walks = agent.spec.flags == 0 && settings.clients > 0;
    server.clientOf_.push_back(walks ? next++ % settings.clients : NetworkWelcome::kNobodys);
    if (!(agent.spec.flags & kHuman)) continue;
    server.humans_.push_back(
        {server.ids_[k], agent.spec.position, agent.goal, agent.spec.preferredSpeed});
    server.crowd_.clearGoal(server.ids_[k]);
  }
  return server;
}

NetworkWelcome NetworkServer::welcome(std::uint32_t client) {
  NetworkWelcome welcome;
  welcome.client = client;
  welcome.seconds = settings_.seconds;
  welcome.velocityBias = settings_.velocityBias;
  welcome.deadReckoning = settings_.deadReckoning;
  const AgentsView view = crowd_.view();
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    const std::uint32_t i = crowd_.indexOf(ids_[k]);
    welcome.members.push_back({clientOf_[k], view.group[i], view.flags[i], view.position[i],
                               view.velocity[i], view.heading[i], view.radius[i],
                               view.preferredSpeed[i], view.maximumSpeed[i]});
  }
  const std::span<const Wall> walls = crowd_.walls();
  welcome.walls.assign(walls.begin(), walls.end());
  return welcome;
}

void NetworkServer::receive(std::uint32_t client, const NetworkCommand& command) {
  if (client >= clients_.size() || command.number <= clients_[client].answered) return;
  clients_[client].answered = command.number;
  clients_[client].fresh = true;
  for (const NetworkCommand::Motion& motion : command.motions) {
    if (motion.agent >= clientOf_.size() || clientOf_[motion.agent] != client) continue;
    if (!isFinite(motion.velocity)) continue;
    const std::span<float> row = crowd_.memoryOf(ids_[motion.agent]);
    row[0] = motion.velocity.x;
    row[1] = motion.velocity.y;
  }
}

void NetworkServer::driveHumans() {
  for (const Human& human : humans_) {
    const glm::vec2 way = human.to - human.from;
    const float length = glm::length(way);
    if (!(length > 0.0f)) continue;
    const double walked = static_cast<double>(tick_ + 1) * static_cast<double>(settings_.seconds) *
                          static_cast<double>(human.speed);
    const float along = static_cast<float>(std::fmod(walked, 2.0 * static_cast<double>(length)));
    const bool back = along > length;
    const glm::vec2 ahead = way / length;
    const glm::vec2 velocity = ahead * (back ? -human.speed : human.speed);
    crowd_.place(human.id, human.from + ahead * (back ? 2.0f * length - along : along), 0.0f,
                 navmesh::headingOf(velocity), velocity);
  }
}

void NetworkServer::step() {
  for (std::uint32_t c = 0; c < clients_.size(); ++c) {
    Client& client = clients_[c];
    if (client.fresh) {
      client.fresh = false;
      client.missed = 0;
    } else if (client.answered > 0) {
      // Lost on the way: the last one goes on in its place, and stops after a while.
      ++client.answered;
      if (static_cast<float>(++client.missed) * settings_.seconds <= kHold) continue;
      for (std::size_t k = 0; k < ids_.size(); ++k) {
        if (clientOf_[k] != c) continue;
        const std::span<float> row = crowd_.memoryOf(ids_[k]);
        row[0] = row[1] = 0.0f;
      }
    }
  }
  driveHumans();
  crowd_.step(settings_.seconds);
  ++tick_;
}

NetworkSnapshot NetworkServer::snapshot(std::uint32_t client) const {
  NetworkSnapshot snapshot;
  snapshot.tick = tick_;
  snapshot.answered = clients_[client].answered;
  const AgentsView view = crowd_.view();
  for (std::uint32_t k = 0; k < ids_.size(); ++k) {
    const std::uint32_t i = crowd_.indexOf(ids_[k]);
    snapshot.states.push_back({k, view.position[i], view.velocity[i], view.heading[i]});
    if (clientOf_[k] != client) continue;
    NetworkSnapshot::Way way{k, 0, {}, 0.0f};
    const Route& route = crowd_.routeOf(ids_[k]);
    if (route.state == Route::State::found) {
      way.count = std::min<std::uint32_t>(route.count - route.next, NetworkSnapshot::Way::kCorners);
      for (std::uint32_t c = 0; c < way.count; ++c) way.corners[c] = route.corners[route.next + c];
      way.beyond = route.beyond;
      for (std::uint32_t c = route.next + way.count; c < route.count; ++c) {
        way.beyond += glm::distance(route.corners[c - 1], route.corners[c]);
      }
    }
    snapshot.ways.push_back(way);
  }
  return snapshot;
}

}  // namespace forewalk::agents
