// The readers of OpenRDW's walks on any bytes: a path, and a path with its times, which the first
// line of "=" parts.
#include "rdw/openrdw_walk.h"

#include <cmath>
#include <string_view>

#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace rdw = forewalk::rdw;
  const auto bytes = std::as_bytes(std::span<const std::uint8_t>(data, size));
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t part = text.find("=\n");
  const auto pathBytes = bytes.subspan(0, std::min(part, size));
  const auto timeBytes =
      part == std::string_view::npos ? bytes.subspan(size) : bytes.subspan(part + 2);
  const auto path = rdw::parseOpenRdwPath(pathBytes, "fuzz");
  if (path) {
    require(!path->empty(), "a path has a point");
    for (const glm::dvec2 point : *path) {
      require(std::abs(point.x) <= 1e5 && std::abs(point.y) <= 1e5, "points are on this map");
    }
  } else {
    requireSentence(path.error().message, "fuzz");
  }
  const auto walk = rdw::parseOpenRdwWalk(pathBytes, "fuzz", timeBytes, "fuzz");
  if (!walk) {
    requireSentence(walk.error().message, "fuzz");
    return 0;
  }
  require(path && walk->samples.size() == path->size(), "a walk has the points of its path");
  for (std::size_t i = 0; i < walk->samples.size(); ++i) {
    require(walk->samples[i].plan == (*path)[i], "in their order");
    require(i == 0 || walk->samples[i].seconds > walk->samples[i - 1].seconds, "time increases");
  }
  require(!rdw::resample(*walk, 5.0).empty(), "a walk has a frame");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf({"0,0\n0.5, -1\n1e0,2\n", "0,0\n0.1, 0.1\n0.2,0.1\n=\n0.03\n0.04\n0.05\n",
                  "-0.01198855, -0.1055848\r\n-0.00975024, -0.1120655\r\n=\n0\n0.04444122\n"});
}
