// --links, wherever a command takes lifts, ladders and teleports.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <tl/expected.hpp>

#include "navmesh/links.h"
#include "navmesh/world.h"
#include "service/link_file.h"

namespace forewalk::cli {

inline CLI::Option* addLinksOption(CLI::App& verb, std::filesystem::path& file) {
  return verb
      .add_option(
          "--links", file,
          "Lifts, ladders and teleports: JSON of format forewalk.links/1 (prediction/README.md)")
      ->check(CLI::ExistingFile);
}

/// The links of a file on a world's ground. Fails as service::readLinks and navmesh::makeLinks do.
[[nodiscard]] inline tl::expected<navmesh::Links, Error> linksOn(
    const navmesh::World& world, const std::filesystem::path& file) {
  const auto links = service::readLinks(file);
  if (!links) return tl::unexpected(links.error());
  auto made = navmesh::makeLinks(world.graph, world.locations, *links);
  if (!made) {
    return tl::unexpected(Error{made.error().code, file.string() + ": " + made.error().message});
  }
  return made;
}

}  // namespace forewalk::cli
