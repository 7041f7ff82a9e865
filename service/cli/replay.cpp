// forewalk replay: a recorded session walked again, its answers compared to the last bit.
#include "service/daemon/replay.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/files.h"

namespace forewalk::cli {
namespace {

struct ReplayOptions {
  std::filesystem::path recording, answers;
  SceneOptions scene;
};

tl::expected<void, Error> run(ReplayOptions& options) {
  const std::string name = options.recording.string();
  const auto inFile = [&](const Error& error) {
    return tl::unexpected(Error{error.code, fmt::format("{}: {}", name, error.message)});
  };
  if (auto writable = service::checkWritable(options.answers); !writable) return writable;
  const auto bytes = service::readFile(options.recording);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const auto head = daemon::parseRecordingHead(text.substr(0, text.find('\n')));
  if (!head) return inFile(head.error());
  if (options.scene.scene.empty()) options.scene.scene = head->scene;
  const auto navMesh = loadNavMesh(options.scene);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return tl::unexpected(std::move(world.error()));

  std::string answers;
  const auto replayed = daemon::replay(text, std::move(*world), daemon::hashOf(*navMesh),
                                       [&](const daemon::Answer& answer) {
                                         if (options.answers.empty()) return;
                                         daemon::appendAnswerText(answer, {}, {}, answers);
                                         answers += '\n';
                                       });
  if (!replayed) return inFile(replayed.error());
  if (!options.answers.empty()) {
    if (auto written = service::writeFile(options.answers, answers); !written) return written;
  }
  if (replayed->firstDifference) {
    return inFile(
        Error{ErrorCode::kDataDamaged,
              fmt::format("line {} differs: recorded {}, replayed {}. Use the build that "
                          "recorded it.",
                          *replayed->firstDifference, replayed->recorded, replayed->replayed)});
  }
  if (options.answers == "-") return {};  // stdout is taken
  fmt::print("session {}: {} frames, all the same to the last bit{}\n", head->sessionId,
             replayed->frames,
             replayed->cutOff == 0
                 ? ""
                 : fmt::format(" ({} bytes of a last line are cut off)", replayed->cutOff));
  return {};
}

}  // namespace

Verb addReplay(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "replay", "Walk a session again that forewalk serve recorded, and compare");
  const auto options = std::make_shared<ReplayOptions>();
  verb->add_option("RECORDING", options->recording, "A file of forewalk serve --record")
      ->required();
  addSceneOptions(*verb, options->scene);
  CLI::Option* scene = verb->get_option("SCENE");
  scene->required(false);
  scene->description("The scene that was served; without, the one that the recording names");
  verb->add_option("--answers", options->answers,
                   "JSON lines to write, an answer a frame; - is stdout")
      ->check(fileName);
  verb->footer("Example: forewalk replay walks/0123456789abcdef-0.jsonl");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
