#include "agents/models/golaem.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "agents/command_samples.h"
#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

// Overlaps up to this share of the radii's sum are touches.
constexpr float kTouch = 0.01f;
// Near the goal a trajectory lasts so many times the rest of the way, and at least so long.
constexpr float kBeyondGoal = 1.5f, kShortest = 0.5f;
// Personal space of who has arrived, metres.
constexpr float kLeastSpace = 0.05f;

struct GolaemScratch : Scratch {
  TrajectorySituation situation;
  TrajectorySearch search;
};

/// Bodies that touch already may part, a little nearer on the way: only what brings them closer is
/// dismissed.
template <typename Predicted>
void setHits(float distance, bool literal, Predicted& predicted) {
  const bool apart = literal || distance >= predicted.contact;
  predicted.hit = apart ? predicted.contact : 0.8f * distance;
  predicted.keep = apart ? predicted.contact : 0.999f * distance;
}

void addDisc(glm::vec2 apart, glm::vec2 velocity, float contact, bool agent, bool literal,
             TrajectorySituation& situation) {
  const float distance = glm::length(apart);
  if (distance < (1.0f - kTouch) * contact) situation.contact = true;
  situation.discs.push_back({apart, velocity, contact, contact, contact, agent});
  setHits(distance, literal, situation.discs.back());
}

void addNeighbours(const GolaemParameters& p, const PlanInput& input, std::uint32_t agent,
                   TrajectorySituation& situation) {
  const AgentsView& agents = input.agents;
  for (const Neighbour& neighbour : input.around.of(agent).neighbours) {
    const std::uint32_t other = neighbour.index;
    const float contact = agents.radius[agent] + agents.radius[other];
    glm::vec2 apart = agents.position[other] - agents.position[agent];
    if (apart == glm::vec2(0.0f)) {  // in one spot: the ids say who leaves to which side
      const bool first = number(agents.id[agent]) < number(agents.id[other]);
      apart = {first ? 0.05f * contact : -0.05f * contact, 0.0f};
    }
    addDisc(apart, agents.velocity[other], contact, true, p.literal, situation);
  }
}

void addWalls(const GolaemParameters& p, const PlanInput& input, std::uint32_t agent,
              TrajectorySituation& situation) {
  const glm::vec2 position = input.agents.position[agent];
  for (const NearWall& near : input.around.of(agent).walls) {
    const Wall& wall = input.around.walls[near.index];
    const float contact = wallRadius(input.agents.radius[agent], wall);
    if (wall.isCircle()) {
      addDisc(wall.from - position, wall.velocity, contact, false, p.literal, situation);
      continue;
    }
    const float distance = glm::distance(nearestOn(wall, position), position);
    if (distance < (1.0f - kTouch) * contact) situation.contact = true;
    situation.walls.push_back({wall.from - position, wall.to - position, wall.velocity, contact});
    setHits(distance, p.literal, situation.walls.back());
  }
}

/// What the body does now.
Command presentOf(const AgentsView& agents, std::uint32_t agent, const GolaemRow& row) {
  const glm::vec2 heading = navmesh::directionOf(agents.heading[agent]);
  return {std::max(0.0f, glm::dot(agents.velocity[agent], heading)), row.angular};
}

class Golaem final : public Model {
 public:
  explicit Golaem(const GolaemParameters& parameters) : p_(parameters) {
    if (!p_.clips) p_.clips = builtInClips();
    p_.points = std::clamp(p_.points, 1u, kMostPoints);
  }

  const char* name() const override { return p_.literal ? "golaem-literal" : "golaem"; }

  Needs needs() const override {
    Needs needs;
    needs.neighbourRadius = p_.agentWidths * p_.detectionWidth;
    needs.neighbourCount = p_.neighbourCount;
    needs.wallRadius = p_.obstacleWidths * p_.detectionWidth;
    needs.wallCount = p_.wallCount;
    needs.period = p_.period;
    needs.memory = kGolaemMemory;
    return needs;
  }

  std::unique_ptr<Scratch> makeScratch() const override {
    auto scratch = std::make_unique<GolaemScratch>();
    const std::size_t first = std::size_t{p_.linearSamples} * p_.angularSamples;
    const std::size_t second = std::size_t{p_.secondLinear ? p_.secondLinear : p_.linearSamples} *
                               (p_.secondAngular ? p_.secondAngular : p_.angularSamples);
    const std::size_t discs = std::size_t{p_.neighbourCount} + p_.wallCount;
    scratch->situation.first.reserve(first);
    scratch->situation.second.reserve(second);
    scratch->situation.discs.reserve(discs);
    scratch->situation.walls.reserve(p_.wallCount);
    scratch->search.reserve(first, second, p_.points, discs, p_.wallCount);
    return scratch;
  }

  void plan(const PlanInput& input, Memory memory, Scratch& scratch,
            std::span<Plan> plans) const override {
    GolaemScratch& own = static_cast<GolaemScratch&>(scratch);
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      const std::span<float> floats = memory.of(input.which[k]);
      GolaemRow row = golaemRow(floats);
      plans[k] = planFor(input, input.which[k], row, own);
      setGolaemRow(row, floats);
    }
  }

 private:
  Plan planFor(const PlanInput& input, std::uint32_t agent, GolaemRow& row,
               GolaemScratch& own) const {
    lookAround(p_, input, agent, row, own.situation);
    own.search.prepare(own.situation.problem);
    const TrajectoryChoice choice = own.search.best();
    const Command wanted = choice.kind == TrajectoryChoice::Kind::none
                               ? p_.clips->clips()[p_.clips->neutral()].motion
                               : own.situation.first[choice.first];
    const Command command =
        approached(presentOf(input.agents, agent, row), wanted, std::max(p_.period, input.seconds));
    PlanStatus status = PlanStatus::ok;
    if (choice.kind != TrajectoryChoice::Kind::free) status = PlanStatus::infeasible;
    if (own.situation.contact) status = PlanStatus::contact;
    row.linear = command.linear;
    row.angular = command.angular;
    // On the way from a motion that no clips make (a push, a jump), those of where it leads.
    auto blend = p_.clips->blend(command);
    if (!blend) blend = p_.clips->blend(wanted);
    for (std::size_t c = 0; c < 3; ++c) {
      row.clip[c] = static_cast<float>(blend->clip[c]);
      row.weight[c] = blend->weight[c];
    }
    return Plan::arc(command.linear, command.angular, status);
  }

  /// As near to the wanted command as the limits let it come until the next plan. Both parts come
  /// equally near, so what lies between two playable motions is playable.
  Command approached(Command present, Command wanted, float seconds) const {
    const float linear = std::abs(wanted.linear - present.linear);
    const float angular = std::abs(wanted.angular - present.angular);
    float share = 1.0f;
    if (linear > p_.linearAcceleration * seconds) share = p_.linearAcceleration * seconds / linear;
    if (angular * share > p_.angularAcceleration * seconds) {
      share = p_.angularAcceleration * seconds / angular;
    }
    if (share >= 1.0f) return wanted;
    return {present.linear + share * (wanted.linear - present.linear),
            present.angular + share * (wanted.angular - present.angular)};
  }

  GolaemParameters p_;
};

}  // namespace

GolaemRow golaemRow(std::span<const float> memory) {
  GolaemRow row{};
  std::memcpy(&row, memory.data(), std::min(memory.size_bytes(), sizeof(row)));
  return row;
}

void setGolaemRow(const GolaemRow& row, std::span<float> memory) {
  std::memcpy(memory.data(), &row, std::min(memory.size_bytes(), sizeof(row)));
}

void lookAround(const GolaemParameters& p, const PlanInput& input, std::uint32_t agent,
                const GolaemRow& row, TrajectorySituation& situation) {
  const AgentsView& agents = input.agents;
  TrajectoryProblem& problem = situation.problem;
  problem = {};
  problem.heading = navmesh::directionOf(agents.heading[agent]);
  problem.weights = p.weights;
  problem.points = std::clamp(p.points, 1u, kMostPoints);

  const glm::vec2 preferred = agents.preferredVelocity[agent];
  const float speed = glm::length(preferred);
  if (speed > 1e-6f) {
    problem.towards = preferred / speed;
    problem.comfortSpeed = row.comfortSpeed > 0.0f ? row.comfortSpeed
                           : p.comfortSpeed > 0.0f ? p.comfortSpeed
                                                   : agents.preferredSpeed[agent];
    problem.comfortSpeed = std::min(problem.comfortSpeed, agents.maximumSpeed[agent]);
    problem.remaining = agents.remaining[agent];
    // Who is nearly there lets others come as near as the goal is.
    if (!p.literal) {
      problem.weights.agentSpace =
          std::min(problem.weights.agentSpace, std::max(problem.remaining, kLeastSpace));
    }
  }
  const float boldness = std::clamp(row.boldness > 0.0f ? row.boldness : p.boldness, 0.0f, 1.0f);
  float lasts = boldness * p.shortestLook + (1.0f - boldness) * p.longestLook;
  if (!p.literal && problem.comfortSpeed > 0.0f) {
    lasts = std::min(lasts,
                     std::max(kBeyondGoal * problem.remaining / problem.comfortSpeed, kShortest));
  }
  problem.step = lasts / static_cast<float>(problem.points);

  const LocomotionDatabase& clips = p.clips ? *p.clips : *builtInClips();
  CommandSampling sampling;
  sampling.linearSamples = p.linearSamples;
  sampling.angularSamples = p.angularSamples;
  sampling.spacing = p.spacing;
  sampling.sideOffset = p.sideOffset;
  sampling.side = input.side;
  sampling.fastest = agents.maximumSpeed[agent];
  sampling.fitted = !p.literal;
  sampling.comfortSpeed = p.literal ? 0.0f : problem.comfortSpeed;
  if (p.dual) {
    CommandSampling second = sampling;
    if (p.secondLinear > 0) second.linearSamples = p.secondLinear;
    if (p.secondAngular > 0) second.angularSamples = p.secondAngular;
    sampleCommands(clips, second, situation.second);
  } else {
    situation.second.clear();
  }
  float until = std::max(p.period, input.seconds);
  if (!p.literal) until = std::max(until, p.reachSeconds);
  sampling.present = presentOf(agents, agent, row);
  sampling.reach = {p.linearAcceleration * until, p.angularAcceleration * until};
  sampleCommands(clips, sampling, situation.first);

  situation.contact = false;
  situation.discs.clear();
  situation.walls.clear();
  addNeighbours(p, input, agent, situation);
  addWalls(p, input, agent, situation);
  problem.first = situation.first;
  problem.second = situation.second;
  problem.discs = situation.discs;
  problem.walls = situation.walls;
}

std::unique_ptr<const Model> makeGolaem(const GolaemParameters& parameters) {
  return std::make_unique<Golaem>(parameters);
}

}  // namespace forewalk::agents
