// A whole run over links that delay and lose.
#include <algorithm>
#include <cmath>

#include "agents/network.h"

namespace forewalk::agents {

tl::expected<NetworkSession, Error> NetworkSession::make(const CrowdScene& scene,
                                                         const NetworkSettings& settings,
                                                         double seconds) {
  auto server = NetworkServer::make(scene, settings);
  if (!server) return tl::unexpected(std::move(server.error()));
  return NetworkSession(std::move(*server), scene, settings, seconds);
}

NetworkSession::NetworkSession(NetworkServer server, const CrowdScene& scene,
                               const NetworkSettings& settings, double seconds)
    : server_(std::move(server)),
      settings_(settings),
      arrivalRadius_(scene.arrivalRadius),
      ticks_(static_cast<std::uint64_t>(
          std::llround(seconds / static_cast<double>(settings.seconds)))) {
  const auto delay = static_cast<std::uint64_t>(std::lround(settings.delay / settings.seconds));
  for (std::uint32_t c = 0; c < settings.clients; ++c) {
    // Each way its own losses.
    down_.emplace_back(delay, settings.loss, settings.seed * 1000003u + 2 * c);
    up_.emplace_back(delay, settings.loss, settings.seed * 1000003u + 2 * c + 1);
  }
  for (const SceneAgent& agent : scene.agents) {
    Walk walk;
    walk.goal = agent.goal;
    walk.last = agent.spec.position;
    walk.human = agent.spec.flags != 0;
    walks_.push_back(walk);
    metrics_.agents += !walk.human;
  }
}

bool NetworkSession::done() const {
  return server_.tick() >= ticks_ || metrics_.arrived == metrics_.agents;
}

void NetworkSession::stepServer() {
  for (std::uint32_t c = 0; c < settings_.clients; ++c) {
    up_[c].receive(server_.tick(),
                   [&](const NetworkCommand& command) { server_.receive(c, command); });
  }
  const AgentsView before = server_.crowd().view();
  proposed_.assign(before.position.begin(), before.position.end());
  server_.step();
  measure();
  for (std::uint32_t c = 0; c < settings_.clients; ++c) {
    down_[c].send(server_.tick(), server_.snapshot(c));
  }
}

void NetworkSession::measure() {
  const Crowd& crowd = server_.crowd();
  AgentsView view = crowd.view();
  const float seconds = settings_.seconds;
  // Where the clients would have had them, had the server not looked.
  for (std::uint32_t i = 0; i < view.size(); ++i) {
    if (view.flags[i] & kHuman) {
      proposed_[i] = view.position[i];
      continue;
    }
    glm::vec2 velocity = crowd.planOf(view.id[i]).velocity;
    const float speed = glm::length(velocity);
    if (speed > view.maximumSpeed[i]) velocity *= view.maximumSpeed[i] / speed;
    proposed_[i] += velocity * seconds;
  }
  metrics_.left += leftCounter_.count(view);
  view.position = proposed_;
  metrics_.proposed += proposedCounter_.count(view);
  metrics_.collisions += collisions_.count(view);
  view = crowd.view();

  const double now = static_cast<double>(server_.tick()) * static_cast<double>(seconds);
  for (std::size_t k = 0; k < walks_.size(); ++k) {
    Walk& walk = walks_[k];
    const std::uint32_t i = crowd.indexOf(server_.ids()[k]);
    const glm::vec2 at = view.position[i];
    if (walk.human || walk.arrival >= 0.0) continue;
    if (server_.tick() == 1) walk.planned = static_cast<double>(view.remaining[i]);
    walk.walked += static_cast<double>(glm::distance(at, walk.last));
    walk.last = at;
    if (glm::distance(at, walk.goal) > arrivalRadius_) continue;
    walk.arrival = now;
    ++metrics_.arrived;
  }
  metrics_.seconds = now;
  metrics_.hash = (metrics_.hash ^ crowd.hash()) * 0x100000001b3ull;
}

NetworkMetrics NetworkSession::metrics() const {
  NetworkMetrics metrics = metrics_;
  double efficiency = 0.0, arrival = 0.0;
  for (const Walk& walk : walks_) {
    if (walk.human || walk.arrival < 0.0) continue;
    arrival += walk.arrival;
    metrics.lastArrival = std::max(metrics.lastArrival, walk.arrival);
    // The last bit of the way, within the arrival radius, is not walked.
    const double due = std::max(0.0, walk.planned - static_cast<double>(arrivalRadius_));
    efficiency += walk.walked > 0.0 ? std::min(1.0, due / walk.walked) : 1.0;
  }
  if (metrics.arrived > 0) {
    metrics.meanArrival = arrival / metrics.arrived;
    metrics.efficiency = efficiency / metrics.arrived;
  }
  return metrics;
}

tl::expected<NetworkMetrics, Error> runNetwork(const CrowdScene& scene,
                                               const NetworkSettings& settings, double seconds) {
  auto session = NetworkSession::make(scene, settings, seconds);
  if (!session) return tl::unexpected(std::move(session.error()));
  std::vector<NetworkClient> clients;
  for (std::uint32_t c = 0; c < settings.clients; ++c) clients.emplace_back(session->welcome(c));
  while (!session->done()) {
    session->stepServer();
    for (std::uint32_t c = 0; c < settings.clients; ++c) {
      session->due(c, [&](const NetworkSnapshot& snapshot) { clients[c].receive(snapshot); });
      session->answer(c, clients[c].step());
    }
  }
  return session->metrics();
}

}  // namespace forewalk::agents
