// A crowd in several places: local navigation in clients, global navigation and contacts in the
// server.
//
// The network form of the virtual-agents paper (models/social_forces.h). Client and server are pure
// state machines, messages plain values: nothing here knows a socket or a clock. A link that delays
// and loses messages is part of it, so that what lateness does can be measured and repeated.
//
//   server, every tick   commands that came -> positions, contacts resolved, paths -> a snapshot
//   each client, every tick   snapshots that came -> others where they were, own ones corrected
//                        -> a velocity for each own agent (social forces) -> a command
//
// The server holds what is true. A client walks its own agents on at once, remembers where each
// command left them, and when the server answers to that command shifts them by the difference
// (prediction and reconciliation, as networked games have it). Others stand where they were last
// seen, delayed: what the velocity-bias force is to make up for.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "navmesh/random.h"

namespace forewalk::agents {

/// What a client is told once, before its first snapshot.
struct NetworkWelcome {
  struct Member {
    std::uint32_t client;  ///< whose it is; kNobodys: the server's (humans)
    std::uint32_t group;
    std::uint8_t flags;
    glm::vec2 position, velocity;
    float heading, radius, preferredSpeed, maximumSpeed;
    bool operator==(const Member&) const = default;
  };
  static constexpr std::uint32_t kNobodys = 0xffffffffu;

  std::uint32_t client = 0;     ///< its number
  float seconds = 0.05f;        ///< a tick
  bool velocityBias = true;     ///< plan with that force
  bool deadReckoning = false;   ///< walk others on at their last velocity where nothing came
  std::vector<Member> members;  ///< everybody; agent k is the k-th
  std::vector<Wall> walls;
};

/// The server's state after a tick, as told to one client.
struct NetworkSnapshot {
  struct State {
    std::uint32_t agent;
    glm::vec2 position, velocity;
    float heading;
    bool operator==(const State&) const = default;
  };
  /// Sub-goals of one of the client's agents: the next corners of the server's path.
  struct Way {
    static constexpr std::uint32_t kCorners = 4;
    std::uint32_t agent;
    std::uint32_t count;  ///< of corners; 0: nothing to walk to
    std::array<glm::vec2, kCorners> corners;
    float beyond;  ///< metres from the last one to the goal
    bool operator==(const Way&) const = default;
  };

  std::uint64_t tick = 0;
  std::uint64_t answered =
      0;                      ///< the client's last command that is in it, or was given up; 0: none
  std::vector<State> states;  ///< everybody, ascending
  std::vector<Way> ways;      ///< of the client's agents, ascending
  bool operator==(const NetworkSnapshot&) const = default;
};

/// What a client's agents are to do in one tick.
struct NetworkCommand {
  struct Motion {
    std::uint32_t agent;
    glm::vec2 velocity;  ///< m/s
    float heading;
    bool operator==(const Motion&) const = default;
  };
  std::uint64_t number = 0;  ///< 1, 2, ... per client
  std::vector<Motion> motions;
  bool operator==(const NetworkCommand&) const = default;
};

struct NetworkSettings {
  std::uint32_t clients = 2;
  float seconds = 0.05f;   ///< a tick
  float delay = 0.0f;      ///< of every message, one way, seconds; rounded to ticks
  float loss = 0.0f;       ///< share of messages that never arrive, 0 to 1
  std::uint64_t seed = 1;  ///< of the losses
  bool velocityBias = true;
  bool deadReckoning = false;
  bool resolveContacts = true;        ///< the server takes bodies out of each other
  std::optional<CellSettings> cells;  ///< paths over cells; none: straight on
};

/// Delays and loses. Messages arrive in the order of sending.
template <typename Message>
class Link {
 public:
  Link(std::uint64_t ticks, float loss, std::uint64_t seed)
      : ticks_(ticks), loss_(loss), rng_(seed) {}

  void send(std::uint64_t now, Message message) {
    const bool lost = navmesh::uniform(rng_) < static_cast<double>(loss_);
    if (!lost) under_.push_back({now + ticks_, std::move(message)});
  }

  /// Calls visit(message) for everything that has arrived by `now`.
  template <typename Visit>
  void receive(std::uint64_t now, const Visit& visit) {
    std::size_t k = 0;
    for (; k < under_.size() && under_[k].due <= now; ++k) visit(under_[k].message);
    under_.erase(under_.begin(), under_.begin() + static_cast<std::ptrdiff_t>(k));
  }

 private:
  struct Sent {
    std::uint64_t due;
    Message message;
  };
  std::uint64_t ticks_;
  float loss_;
  std::mt19937_64 rng_;
  std::vector<Sent> under_;
};

/// Local navigation: social forces for its own agents.
class NetworkClient {
 public:
  explicit NetworkClient(const NetworkWelcome& welcome);

  /// A snapshot older than one it has had is ignored, and so are agents it does not know.
  void receive(const NetworkSnapshot& snapshot);

  /// One tick: walks its own agents on, and says how.
  NetworkCommand step();

  const Crowd& crowd() const { return crowd_; }  ///< as the client sees it

 private:
  static constexpr std::size_t kRemembered = 256;  // commands: 12 s at 20 a second
  struct Own {
    AgentId id;
    std::vector<glm::vec2> after;  // where command n left it, at n % kRemembered
    NetworkSnapshot::Way way{};    // the last that came
    std::uint32_t passed = 0;      // of its corners
  };
  Own* ownOf(std::uint32_t agent);
  void follow(Own& own, const NetworkSnapshot::Way& way);

  Crowd crowd_;
  float seconds_;
  bool deadReckoning_;
  std::vector<Own> own_;
  std::vector<bool> isOwn_;
  std::vector<bool> fresh_;  // somebody else's, seen anew since the last step
  std::uint64_t seen_ = 0, number_ = 0;
  bool any_ = false;
};

/// Global navigation, contacts, and what is true.
class NetworkServer {
 public:
  /// Agents of the scene that are not human are dealt to the clients in turn. Humans walk to and
  /// fro between their place and their goal. Fails as Crowd::setCells does.
  [[nodiscard]] static tl::expected<NetworkServer, Error> make(const CrowdScene& scene,
                                                               const NetworkSettings& settings);

  NetworkWelcome welcome(std::uint32_t client);

  /// A command that is late or speaks of agents that are not the client's, or not in finite
  /// numbers, is ignored as far as it does.
  void receive(std::uint32_t client, const NetworkCommand& command);

  void step();  ///< one tick
  NetworkSnapshot snapshot(std::uint32_t client) const;

  const Crowd& crowd() const { return crowd_; }
  std::span<const AgentId> ids() const { return ids_; }
  std::uint64_t tick() const { return tick_; }

 private:
  struct Client {
    std::uint64_t answered = 0;  // the last command that counts
    bool fresh = false;          // it came since the last tick
    std::uint32_t missed = 0;    // ticks without one, in a row
  };
  struct Human {
    AgentId id;
    glm::vec2 from, to;
    float speed;
  };
  explicit NetworkServer(const NetworkSettings& settings);
  void driveHumans();

  NetworkSettings settings_;
  Crowd crowd_;
  std::vector<AgentId> ids_;
  std::vector<std::uint32_t> clientOf_;  // per agent
  std::vector<Client> clients_;
  std::vector<Human> humans_;
  std::uint64_t tick_ = 0;
};

/// What lateness did.
struct NetworkMetrics {
  double seconds = 0.0;
  std::uint32_t agents = 0, arrived = 0;        ///< not human
  double meanArrival = 0.0, lastArrival = 0.0;  ///< seconds, of those that arrived
  double efficiency = 0.0;  ///< mean over them of the first path's length over the walked
  std::uint32_t collisions =
      0;                   ///< pairs whose bodies met deeper than 1 %, before contacts are resolved
  OverlapCount proposed;   ///< every tick, before contacts are resolved
  OverlapCount left;       ///< and after
  std::uint64_t hash = 0;  ///< of every tick's state
};

/// A whole run, but for the clients: they are the caller's, in this process or in another.
///
///   while (!session.done()) {
///     session.stepServer();
///     for (each client c) {
///       session.due(c, [&](const NetworkSnapshot& s) { clients[c].receive(s); });
///       session.answer(c, clients[c].step());
///     }
///   }
class NetworkSession {
 public:
  [[nodiscard]] static tl::expected<NetworkSession, Error> make(const CrowdScene& scene,
                                                                const NetworkSettings& settings,
                                                                double seconds);
  NetworkWelcome welcome(std::uint32_t client) { return server_.welcome(client); }
  void stepServer();
  template <typename Visit>
  void due(std::uint32_t client, const Visit& visit) {
    down_[client].receive(server_.tick(), visit);
  }
  void answer(std::uint32_t client, NetworkCommand command) {
    up_[client].send(server_.tick(), std::move(command));
  }
  bool done() const;  ///< all have arrived, or the time is over
  NetworkMetrics metrics() const;
  const NetworkServer& server() const { return server_; }

 private:
  NetworkSession(NetworkServer server, const CrowdScene& scene, const NetworkSettings& settings,
                 double seconds);
  void measure();

  NetworkServer server_;
  NetworkSettings settings_;
  float arrivalRadius_;
  std::uint64_t ticks_;
  std::vector<Link<NetworkSnapshot>> down_;
  std::vector<Link<NetworkCommand>> up_;
  struct Walk {
    glm::vec2 goal, last;
    double planned = 0.0, walked = 0.0, arrival = -1.0;
    bool human = false;
  };
  std::vector<Walk> walks_;
  OverlapCounter proposedCounter_, leftCounter_;
  CollisionCounter collisions_;
  std::vector<glm::vec2> proposed_;
  NetworkMetrics metrics_;
};

/// A run with all clients in this process.
[[nodiscard]] tl::expected<NetworkMetrics, Error> runNetwork(const CrowdScene& scene,
                                                             const NetworkSettings& settings,
                                                             double seconds);

}  // namespace forewalk::agents
