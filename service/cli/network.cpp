// forewalk network: a crowd whose agents are walked in other processes, and what delay does to it.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "agents/published_scenes.h"
#include "service/cli/verb.h"
#include "service/console.h"
#include "service/crowd_network.h"
#include "service/timing.h"

namespace forewalk::cli {
namespace {

struct NetworkOptions {
  std::string scene = "city-block", join;
  agents::NetworkSettings network;
  double delayMs = 0.0, lossPercent = 0.0, seconds = 120.0;
  std::uint32_t seeds = 5;
  std::uint16_t listen = 0;
  bool withoutBias = false, withoutContacts = false, processes = false, table = false;
};

agents::CrowdScene sceneOf(const NetworkOptions& options, std::uint64_t seed,
                           agents::NetworkSettings& network) {
  network.cells.reset();
  if (options.scene == "meeting") return agents::meetingScene(18, 8.0f, seed);
  network.cells = agents::cityBlockCells();
  return agents::cityBlockScene(seed);
}

void print(const agents::NetworkMetrics& m) {
  fmt::print("arrived            {} of {} in {:.1f} s, mean {:.1f} s, last {:.1f} s\n", m.arrived,
             m.agents, m.seconds, m.meanArrival, m.lastArrival);
  fmt::print("path efficiency    {:.3f}\n", m.efficiency);
  fmt::print("collisions         {} before contacts are resolved, deepest {:.1f} % of the radii\n",
             m.collisions, 100.0 * static_cast<double>(m.proposed.deepest));
  fmt::print("left after         {} pairs and ticks, deepest {:.2f} %\n", m.left.pairSteps,
             100.0 * static_cast<double>(m.left.deepest));
  fmt::print("hash               {:016x}\n", m.hash);
}

// Medians over the seeds; each seed is another scene and other losses.
tl::expected<void, Error> printTable(const NetworkOptions& options) {
  struct Row {
    double delay, loss;
    bool bias;
  };
  std::vector<Row> rows;
  for (const double loss : {0.0, 0.05}) {
    for (const double delay : {0.0, 0.1, 0.25, 0.5}) {
      for (const bool bias : {false, true}) rows.push_back({delay, loss, bias});
    }
  }
  service::ProgressBar bar("walking");
  std::string text =
      "delay_ms,loss_percent,bias,collisions,deepest_percent,mean_arrival_s,last_arrival_s,"
      "efficiency,arrived,agents,left_overlaps,hash\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::vector<double> collisions, deepest, arrival, last, efficiency;
    std::uint64_t hash = 0, left = 0;
    std::uint32_t arrived = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
      agents::NetworkSettings network = options.network;
      const agents::CrowdScene scene = sceneOf(options, seed, network);
      network.seed = seed;
      network.delay = static_cast<float>(rows[r].delay);
      network.loss = static_cast<float>(rows[r].loss);
      network.velocityBias = rows[r].bias;
      const auto run = agents::runNetwork(scene, network, options.seconds);
      if (!run) return tl::unexpected(run.error());
      collisions.push_back(run->collisions);
      deepest.push_back(100.0 * static_cast<double>(run->proposed.deepest));
      arrival.push_back(run->meanArrival);
      last.push_back(run->lastArrival);
      efficiency.push_back(run->efficiency);
      hash = (hash ^ run->hash) * 0x100000001b3ull;
      left += run->left.pairSteps;
      arrived += run->arrived;
      all += run->agents;
      bar.update(r * options.seeds + seed, rows.size() * options.seeds);
    }
    const auto median = [](std::vector<double>& of) { return service::quantile(of, 0.5); };
    text += fmt::format("{:.0f},{:.0f},{},{:.0f},{:.1f},{:.1f},{:.1f},{:.3f},{},{},{},{:016x}\n",
                        1000.0 * rows[r].delay, 100.0 * rows[r].loss, rows[r].bias ? "yes" : "no",
                        median(collisions), median(deepest), median(arrival), median(last),
                        median(efficiency), arrived, all, left, hash);
  }
  fmt::print("{}", text);
  return {};
}

tl::expected<void, Error> join(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  unsigned port = 0;
  if (colon != std::string::npos) {
    const char* end = where.data() + where.size();
    const auto read = std::from_chars(where.data() + colon + 1, end, port);
    if (read.ec != std::errc() || read.ptr != end) port = 0;
  }
  if (port == 0 || port > 65535) {
    throw CLI::ValidationError("--join", fmt::format("\"{}\" is no ADDRESS:PORT", where));
  }
  return service::joinNetwork(where.substr(0, colon), static_cast<std::uint16_t>(port));
}

tl::expected<void, Error> run(const NetworkOptions& options) {
  if (!options.join.empty()) return join(options.join);
  NetworkOptions own = options;
  own.network.velocityBias = !options.withoutBias;
  own.network.resolveContacts = !options.withoutContacts;
  if (options.table) return printTable(own);
  own.network.delay = static_cast<float>(options.delayMs / 1000.0);
  own.network.loss = static_cast<float>(options.lossPercent / 100.0);
  agents::NetworkSettings network = own.network;
  const agents::CrowdScene scene = sceneOf(own, network.seed, network);
  auto metrics = [&]() -> tl::expected<agents::NetworkMetrics, Error> {
    if (options.listen > 0) {
      service::NetworkHost host;
      host.address = "0.0.0.0";
      host.port = options.listen;
      host.patience = 600.0;
      host.listening = [&](std::uint16_t port) -> tl::expected<void, Error> {
        fmt::print(stderr, "waiting for {} clients: forewalk network --join ADDRESS:{}\n",
                   network.clients, port);
        return {};
      };
      return service::serveNetwork(scene, network, options.seconds, host);
    }
    if (!options.processes) return agents::runNetwork(scene, network, options.seconds);
    return service::runNetworkInProcesses(scene, network, options.seconds,
                                          std::filesystem::read_symlink("/proc/self/exe"));
  }();
  if (!metrics) return tl::unexpected(std::move(metrics.error()));
  print(*metrics);
  return {};
}

}  // namespace

Verb addNetwork(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "network",
      "Walk a crowd over a network: its agents in clients, paths and contacts in the "
      "server, messages delayed and lost on purpose");
  const auto options = std::make_shared<NetworkOptions>();
  verb->add_option("--scene", options->scene, "18 virtual agents each; city-block has 3 humans")
      ->check(CLI::IsMember({"city-block", "meeting"}))
      ->capture_default_str();
  verb->add_option("--clients", options->network.clients, "To whom the agents are dealt in turn")
      ->check(CLI::Range(1u, 64u))
      ->capture_default_str();
  verb->add_option("--delay-ms", options->delayMs, "Of every message, one way; in ticks of 50 ms")
      ->check(CLI::Range(0.0, 5000.0))
      ->capture_default_str();
  verb->add_option("--loss-percent", options->lossPercent, "Of all messages")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  verb->add_flag("--no-bias", options->withoutBias, "Without the velocity-bias force");
  verb->add_flag("--no-contacts", options->withoutContacts, "The server leaves overlaps alone");
  verb->add_flag("--dead-reckoning", options->network.deadReckoning,
                 "Clients walk others on where no news came");
  verb->add_option("--seed", options->network.seed, "Of the scene and of the losses")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--seconds", options->seconds, "At most so long")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  verb->add_flag("--processes", options->processes,
                 "Each client a process of its own, over TCP; the result is the same");
  verb->add_option("--listen", options->listen,
                   "Wait at this port for clients that come with --join")
      ->check(CLI::Range(1, 65535));
  verb->add_option("--join", options->join, "Be a client of the server at ADDRESS:PORT");
  verb->add_flag("--table", options->table,
                 "CSV over delay 0 to 500 ms, loss 0 and 5 %, with and without the force: medians");
  verb->add_option("--seeds", options->seeds, "Scenes in the table")
      ->check(CLI::Range(1u, 1000u))
      ->capture_default_str();
  verb->footer(
      "Examples:\n"
      "  forewalk network --clients 2 --delay-ms 250 --loss-percent 5 --processes\n"
      "  forewalk network --table --scene meeting");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
