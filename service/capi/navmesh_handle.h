// What a forewalk_navmesh is.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "navmesh/world.h"

/// Only read after it is made, but for `owners`. Sessions hold the world, not this.
struct forewalk_navmesh {
  std::shared_ptr<const forewalk::navmesh::World> world;
  std::vector<std::byte>
      fwmesh;  ///< kept in place of the half-edge mesh, which is several times larger
  std::atomic<std::uint32_t> owners{1};
};
