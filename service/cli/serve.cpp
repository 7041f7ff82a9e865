// forewalk serve: the daemon. Ends at SIGTERM or SIGINT, once its sessions have gone elsewhere.
#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "navmesh/build/fwmesh.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/daemon/daemon.h"
#include "service/files.h"

namespace forewalk::cli {
namespace {

struct ServeOptions {
  SceneOptions scene;
  daemon::DaemonSettings daemon;
  unsigned port = 7878;
  std::filesystem::path tokenFile, keyFile, inspector;
  std::string log = "info";
};

tl::expected<void, Error> run(ServeOptions& options) {
  // Before any thread starts, so that all of them leave the signals to this one.
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);

  spdlog::set_default_logger(spdlog::stderr_color_mt("forewalk"));  // stdout has the address
  spdlog::set_level(spdlog::level::from_str(options.log));
  daemon::DaemonSettings settings = options.daemon;
  settings.access.port = static_cast<unsigned short>(options.port);
  auto token = daemon::secretFrom(options.tokenFile, "FOREWALK_TOKEN");
  if (!token) return tl::unexpected(std::move(token.error()));
  settings.access.token = std::move(*token);
  auto key = daemon::secretFrom(options.keyFile, "FOREWALK_STATE_KEY");
  if (!key) return tl::unexpected(std::move(key.error()));
  settings.stateKey = std::move(*key);
  if (!options.inspector.empty()) {
    auto pages = daemon::loadPages(options.inspector);
    if (!pages) return tl::unexpected(std::move(pages.error()));
    settings.pages = std::move(*pages);
  }
  // What could be refused at once is, before the scene is built.
  if (auto sound = daemon::validate(settings.access); !sound) return sound;
  settings.scene = options.scene.scene.string();
  const auto navMesh = loadNavMesh(options.scene);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return tl::unexpected(std::move(world.error()));
  const std::vector<std::byte> fwmesh = navmesh::saveFwmesh(*navMesh);
  settings.fwmesh.assign(reinterpret_cast<const char*>(fwmesh.data()), fwmesh.size());
  auto started =
      daemon::Daemon::start(std::move(*world), daemon::hashOf(fwmesh), std::move(settings));
  if (!started) return tl::unexpected(std::move(started.error()));
  fmt::print("http://{}:{}\n", options.daemon.access.address, (*started)->port());
  std::fflush(stdout);

  int signal = 0;
  sigwait(&ends, &signal);
  (*started)->drain();
  return {};
}

}  // namespace

Verb addServe(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("serve", "Run sessions for others over WebSocket, until SIGTERM");
  const auto options = std::make_shared<ServeOptions>();
  daemon::DaemonSettings& daemon = options->daemon;
  daemon::Limits& limits = daemon.limits;
  addSceneOptions(*verb, options->scene);
  verb->add_option("--listen", daemon.access.address,
                   "IP address; any but loopback needs an access token")
      ->capture_default_str();
  verb->add_option("--port", options->port, "0: any free one; the address is printed on stdout")
      ->check(wholeNumber)
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  verb->add_option("--serve-threads", daemon.threads, "That run sessions; 0: one for each core")
      ->check(wholeNumber)
      ->check(CLI::Range(0, 1024));
  verb->add_option("--token-file", options->tokenFile,
                   "Its first line is the access token that clients have to send; without, the "
                   "variable FOREWALK_TOKEN");
  verb->add_option(
      "--key-file", options->keyFile,
      "Its first line signs state tokens, the same for all daemons that share sessions; "
      "without, the variable FOREWALK_STATE_KEY, or a random one");
  verb->add_option("--origin", daemon.access.origins,
                   "Of pages that may open sessions, such as https://lab.example.org; may be given "
                   "several times");
  verb->add_option("--inspector", options->inspector, "Folder of the page that is served at /");
  verb->add_option("--record", daemon.recordings, "Folder that every session is recorded in")
      ->check(fileName);
  verb->add_option("--max-sessions", limits.sessions, "At one time")
      ->check(wholeNumber)
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  verb->add_option("--max-message", limits.messageBytes, "Bytes of one message")
      ->check(wholeNumber)
      ->check(CLI::Range(256, 1 << 24))
      ->capture_default_str();
  verb->add_option("--max-rate", limits.messagesPerSecond, "Messages of a session, per second")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  verb->add_option("--idle", limits.idleSeconds, "Seconds without a frame")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  verb->add_option("--handshake", limits.handshakeSeconds, "Seconds for a request, and for a hello")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  verb->add_option("--send", limits.sendSeconds, "Seconds for a client to take an answer")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  verb->add_option("--drain", limits.drainSeconds, "Seconds for sessions to leave after SIGTERM")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  verb->add_option("--log", options->log,
                   "What is logged, on stderr: debug, info, warning, error or off")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  verb->footer(
      "Example: forewalk serve assets/scenes/museum.obj --record walks\n"
      "Messages are described in service/daemon/PROTOCOL.md; GET /healthz and /metrics say how it\n"
      "is. SIGTERM: sessions are told to go on elsewhere, and it ends with status 0.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
