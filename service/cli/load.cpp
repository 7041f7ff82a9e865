// forewalk load: how many sessions a daemon carries. Starts one of its own, or asks one that runs.
#include "service/daemon/load.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/files.h"

extern char** environ;

namespace forewalk::cli {
namespace {

struct LoadOptions {
  SceneOptions scene;
  daemon::LoadSettings load;
  std::vector<unsigned> sessions{25, 50, 100, 200};
  unsigned port = 0;
  unsigned serveThreads = 0;
  std::filesystem::path csv, record;
  double worstP99 = 0.0;
};

/// This program's own `serve`, on a port of its choice. Ends with its owner.
class ServeChild {
 public:
  static tl::expected<ServeChild, Error> start(std::vector<std::string> arguments) {
    const auto failed = [](const char* what) {
      return tl::unexpected(
          Error{ErrorCode::kFileUnreadable, fmt::format("forewalk serve: {}.", what)});
    };
    int pipe[2];
    if (::pipe(pipe) != 0) return failed("no pipe to it can be made");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe[1], 1);
    posix_spawn_file_actions_addclose(&actions, pipe[0]);
    posix_spawn_file_actions_addclose(&actions, pipe[1]);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    ServeChild child;
    const int status =
        ::posix_spawn(&child.process_, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe[1]);
    if (status != 0) child.process_ = -1;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(::fdopen(pipe[0], "r"), &std::fclose);
    std::array<char, 256> line{};
    if (status != 0 || std::fgets(line.data(), static_cast<int>(line.size()), out.get()) == nullptr)
      return failed("it did not start; it says why above");
    const std::string text(line.data());
    child.port_ =
        static_cast<unsigned short>(std::strtoul(text.c_str() + text.rfind(':') + 1, nullptr, 10));
    return child;
  }
  ServeChild(ServeChild&& other) noexcept
      : process_(std::exchange(other.process_, -1)), port_(other.port_) {}
  ServeChild& operator=(ServeChild&&) = delete;
  ~ServeChild() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  unsigned short port() const { return port_; }

 private:
  ServeChild() = default;
  pid_t process_ = -1;
  unsigned short port_ = 0;
};

tl::expected<void, Error> run(LoadOptions& options) {
  if (options.scene.scene.empty() == (options.port == 0)) {
    throw CLI::ValidationError("SCENE", "give a SCENE to serve, or the --port of a running daemon");
  }
  if (auto writable = service::checkWritable(options.csv); !writable) return writable;
  if (const char* token = std::getenv("FOREWALK_TOKEN")) options.load.accessToken = token;
  std::optional<ServeChild> child;
  std::shared_ptr<const navmesh::World> world;
  options.load.port = static_cast<unsigned short>(options.port);
  if (options.port == 0) {
    const auto navMesh = loadNavMesh(options.scene);
    if (!navMesh) return tl::unexpected(navMesh.error());
    auto made = service::makeWorld(*navMesh);
    if (!made) return tl::unexpected(std::move(made.error()));
    world = std::move(*made);
    std::vector<std::string> arguments = {"forewalk",
                                          "serve",
                                          options.scene.scene.string(),
                                          "--port",
                                          "0",
                                          "--log",
                                          "error",
                                          "--max-sessions",
                                          "100000",
                                          "--serve-threads",
                                          std::to_string(options.serveThreads)};
    if (!options.record.empty()) {
      arguments.insert(arguments.end(), {"--record", options.record.string()});
    }
    auto started = ServeChild::start(std::move(arguments));
    if (!started) return tl::unexpected(std::move(started.error()));
    child.emplace(std::move(*started));
    options.load.port = child->port();
  }
  const char* head =
      "sessions   frames  lost  late  p50 ms  p99 ms p99.9 ms  max ms  daemon cores  "
      "client cores  daemon MiB\n";
  fmt::print("{}", head);
  std::string csv =
      "sessions,frames,lost,late,p50_ms,p99_ms,p999_ms,max_ms,daemon_cores,client_cores,"
      "daemon_mib_before,daemon_mib_after\n";
  std::uint64_t lost = 0, checked = 0, wrong = 0;
  double worst = 0.0;
  for (const unsigned sessions : options.sessions) {
    options.load.sessions = sessions;
    const auto result = daemon::runLoad(options.load, world);
    if (!result) return tl::unexpected(result.error());
    const daemon::LoadResult& r = *result;
    fmt::print(
        "{:8} {:8} {:5} {:5} {:7.3f} {:7.3f} {:8.3f} {:7.3f} {:13.2f} {:13.2f}  {:.1f} to {:.1f}\n",
        sessions, r.answered, r.lost, r.late, r.medianMs, r.p99Ms, r.p999Ms, r.worstMs,
        r.daemonCores, r.clientCores, r.daemonMiBBefore, r.daemonMiBAfter);
    std::fflush(stdout);
    csv +=
        fmt::format("{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f},{:.2f},{:.2f}\n",
                    sessions, r.answered, r.lost, r.late, r.medianMs, r.p99Ms, r.p999Ms, r.worstMs,
                    r.daemonCores, r.clientCores, r.daemonMiBBefore, r.daemonMiBAfter);
    if (r.checkedFrames > 0) {
      fmt::print("         {} answers worked out again: {} differ, hash {:016x}\n", r.checkedFrames,
                 r.wrongFrames, r.hash);
    }
    if (r.failed > 0) fmt::print("         {} sessions failed: {}\n", r.failed, r.failure);
    lost += r.lost + r.failed;
    checked += r.checkedFrames;
    wrong += r.wrongFrames;
    worst = std::max(worst, r.p99Ms);
  }
  if (!options.csv.empty()) {
    if (auto written = service::writeFile(options.csv, csv); !written) return written;
  }
  if (lost > 0 || wrong > 0 ||
      (world && !options.load.json && options.load.checked > 0 && checked == 0) ||
      (options.worstP99 > 0.0 && worst > options.worstP99)) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format(
                  "load: {} frames or sessions lost, {} of {} answers wrong, worst p99 {:.3f} ms. "
                  "Try fewer sessions, or a machine with nothing else to do.",
                  lost, wrong, checked, worst)});
  }
  return {};
}

}  // namespace

Verb addLoad(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "load", "Many made-up users at once against forewalk serve: latency, processor, memory");
  const auto options = std::make_shared<LoadOptions>();
  daemon::LoadSettings& load = options->load;
  addSceneOptions(*verb, options->scene);
  CLI::Option* scene = verb->get_option("SCENE");
  scene->required(false);
  scene->description("Serve this scene in a process of its own, and check answers against it");
  verb->add_option("--port", options->port, "Instead of SCENE: of a daemon that runs")
      ->check(wholeNumber)
      ->check(CLI::Range(1, 65535));
  verb->add_option("--address", load.address, "Of a daemon that runs")->capture_default_str();
  verb->add_option("--serve-threads", options->serveThreads, "Of the daemon; 0: one for each core");
  verb->add_option("--record", options->record, "Folder that the daemon records in");
  verb->add_option("--sessions", options->sessions, "How many at once; several rounds: 25,50,100")
      ->delimiter(',')
      ->capture_default_str();
  verb->add_option("--rate", load.rate, "Frames a second and session")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--seconds", load.seconds, "Of each round")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  verb->add_option("--session", load.session, "JSON of the hello's \"session\"")
      ->capture_default_str();
  verb->add_flag("--json", load.json, "Frames in JSON; else binary");
  verb->add_option("--check", load.checked, "Sessions whose answers are worked out again (binary)")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--max-p99", options->worstP99, "Exit with status 1 where the p99 is above, ms");
  verb->add_option("--csv", options->csv, "The table as a file; - is stdout")->check(fileName);
  verb->footer(
      "Example: forewalk load assets/scenes/museum.obj --sessions 25,50,100,200 --seconds 10\n"
      "Round trips count from the moment a frame was due. Cores are processor seconds a second.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
