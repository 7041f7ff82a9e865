// forewalk build: a scene in, a navmesh out.
#include "navmesh/build/build.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "navmesh/build/fwmesh.h"
#include "navmesh/build/navmesh_dump.h"
#include "service/cli/links_option.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/files.h"

namespace forewalk::cli {
namespace {

struct BuildOptions {
  SceneOptions scene;
  std::filesystem::path out;
  std::filesystem::path dump;
  std::filesystem::path links;
};

// Under another ending no verb would read it back, and under a scene's it could replace the scene.
void checkEnding(const std::filesystem::path& out) {
  std::error_code unknown;
  if (out == "-" || out.extension() == ".fwmesh" ||
      std::filesystem::is_character_file(out, unknown))
    return;
  throw CLI::ValidationError(
      "--out", fmt::format("{} would not be read back; give a name that ends in .fwmesh, or -",
                           out.string()));
}

tl::expected<void, Error> run(const BuildOptions& options) {
  checkEnding(options.out);
  refuseBothToStdout("--out", options.out, "--dump", options.dump);
  for (const std::filesystem::path& file : {options.out, options.dump}) {
    if (auto writable = service::checkWritable(file); !writable) return writable;
  }
  auto navMesh = loadNavMesh(options.scene);
  if (!navMesh) return tl::unexpected(std::move(navMesh.error()));
  const navmesh::PolygonMesh polygons = navmesh::flatten(*navMesh);
  const auto graph = navmesh::makeNavGraph(polygons);
  if (!graph) return tl::unexpected(graph.error());
  navmesh::Links links;
  if (!options.links.empty()) {
    auto made = linksOn(navmesh::makeWorld(*graph), options.links);
    if (!made) return tl::unexpected(std::move(made.error()));
    links = std::move(*made);
  }
  if (auto written = service::writeFile(options.out, navmesh::saveFwmesh(*navMesh)); !written) {
    return written;
  }
  if (!options.dump.empty()) {
    const std::string text = navmesh::dumpNavMesh(polygons, *graph, navMesh->settings, links);
    if (auto written = service::writeFile(options.dump, text); !written) return written;
  }
  if (options.out == "-" || options.dump == "-") return {};  // stdout is taken
  double area = 0.0;
  for (std::uint32_t p = 0; p < graph->polygonCount(); ++p) {
    area += navmesh::areaOf(*graph, navmesh::PolygonId{p});
  }
  fmt::print("{}: {} polygons, {:.1f} m^2 walkable, {} connected {}\n", options.out.string(),
             graph->polygonCount(), area, graph->componentCount,
             graph->componentCount == 1 ? "piece" : "pieces");
  return {};
}

}  // namespace

Verb addBuild(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("build", "Build a navmesh from a scene and save it");
  const auto options = std::make_shared<BuildOptions>();
  addSceneOptions(*verb, options->scene);
  verb->add_option("--out", options->out, "Navmesh to write (.fwmesh); - is stdout")
      ->required()
      ->check(fileName);
  verb->add_option("--dump", options->dump,
                   "Polygons and portals as JSON (forewalk.navmesh/1); - is stdout")
      ->check(fileName);
  addLinksOption(*verb, options->links)
      ->description(
          "Lifts, ladders and teleports to try on the navmesh: JSON of format "
          "forewalk.links/1. Their ends must lie on its ground; the dump lists them");
  verb->footer(
      "Example:\n"
      "  forewalk build assets/scenes/office.obj --radius 0.3 --tile 16 --out office.fwmesh \\\n"
      "      --dump office.json\n"
      "The same scene and settings give the same bytes, whatever the number of threads.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
