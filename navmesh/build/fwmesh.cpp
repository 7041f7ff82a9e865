#include "navmesh/build/fwmesh.h"

#include <fmt/format.h>

#include "navmesh/build/fwmesh_flat.h"

namespace forewalk::navmesh {

std::vector<std::byte> saveFwmesh(const NavMesh& navMesh) {
  return saveFlatFwmesh(navMesh.settings, flatten(navMesh));
}

tl::expected<NavMesh, Error> loadFwmesh(std::span<const std::byte> bytes, const std::string& name) {
  const auto flat = loadFlatFwmesh(bytes, name);
  if (!flat) return tl::unexpected(flat.error());
  const auto inFile = [&](const Error& error) {
    return tl::unexpected(Error{error.code, fmt::format("{}: {}", name, error.message)});
  };
  auto navMesh = makeNavMesh(flat->polygons, flat->settings);
  if (!navMesh) return inFile(navMesh.error());
  if (auto sound = validate(*navMesh); !sound) return inFile(sound.error());
  return navMesh;
}

}  // namespace forewalk::navmesh
