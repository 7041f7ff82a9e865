// forewalk trajectories: what somebody in a crowd chooses from, as a picture.
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "service/cli/verb.h"
#include "service/clip_file.h"
#include "service/files.h"
#include "service/trajectory_picture.h"

namespace forewalk::cli {
namespace {

struct TrajectoriesOptions {
  std::string scene = "circle";
  std::string form = "dual";
  std::uint32_t count = 30;
  std::uint64_t seed = 1;
  service::TrajectoryPictureSettings picture;
  std::filesystem::path clips;
  std::filesystem::path out;
};

agents::CrowdScene sceneOf(const TrajectoriesOptions& options) {
  if (options.scene == "head-on") return agents::headOnScene();
  if (options.scene == "random") return agents::randomScene(options.count, options.seed);
  if (options.scene == "blocks") return agents::blocksScene(5);
  return agents::circleScene(options.count);
}

tl::expected<void, Error> run(TrajectoriesOptions& options) {
  if (auto writable = service::checkWritable(options.out); !writable) return writable;
  agents::GolaemParameters& parameters = options.picture.parameters;
  parameters.dual = options.form != "single";
  if (options.form == "full") parameters.secondLinear = parameters.secondAngular = 0;
  if (!options.clips.empty()) {
    const auto bytes = service::readFile(options.clips);
    if (!bytes) return tl::unexpected(bytes.error());
    auto clips = service::parseClips({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                                     options.clips.string());
    if (!clips) return tl::unexpected(std::move(clips.error()));
    parameters.clips = std::move(*clips);
  }
  const agents::CrowdScene scene = sceneOf(options);
  options.picture.subtitle =
      fmt::format("{}, agent {} after {:g} s, {} command", scene.name, options.picture.agent,
                  options.picture.seconds, options.form);
  const auto drawn = service::pictureTrajectories(scene, options.picture);
  if (!drawn) return tl::unexpected(drawn.error());
  return service::writeFile(options.out, *drawn);
}

}  // namespace

Verb addTrajectories(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("trajectories",
                                          "What a virtual walker chooses from (SVG): free "
                                          "trajectories by penalty, dismissed ones grey");
  const auto options = std::make_shared<TrajectoriesOptions>();
  verb->add_option("--scene", options->scene, "Who walks where")
      ->check(CLI::IsMember({"circle", "random", "head-on", "blocks"}))
      ->capture_default_str();
  verb->add_option("--agents", options->count, "How many, in circle and random")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "Of random")->check(wholeNumber)->capture_default_str();
  verb->add_option("--agent", options->picture.agent, "Whose choice, counted from 0")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--seconds", options->picture.seconds, "When, into the scene")
      ->check(CLI::Range(0.0f, 3600.0f))
      ->capture_default_str();
  verb->add_option("--form", options->form,
                   "single: one command a trajectory; dual: 2 x 3 more for the second half; full: "
                   "all for both")
      ->check(CLI::IsMember({"single", "dual", "full"}))
      ->capture_default_str();
  verb->add_option("--clips", options->clips,
                   "Motion clips, forewalk.clips/1 (service/clip_file.h); else those of a person");
  verb->add_option("--out", options->out, "SVG to write; - is stdout")->required()->check(fileName);
  verb->footer(
      "Example:\n"
      "  forewalk trajectories --scene circle --agents 30 --seconds 2 --out trajectories.svg");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
