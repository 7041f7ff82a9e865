// The tracked space readers (JSON and OpenRDW's text) on any bytes.
#include <cmath>
#include <string_view>

#include "rdw/tracked_space.h"
#include "tests/fuzz/fuzz.h"

using forewalk::rdw::TrackedSpace;
using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto space = TrackedSpace::read(text);
  if (!space) {
    requireSentence(space.error().message, "tracked space");
    return 0;
  }
  require(space->area() > 0.0 && space->clearance() > 0.0, "a room has floor");
  require(space->contains(space->centre()), "its centre lies inside");
  for (const glm::dvec2 direction :
       {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)}) {
    const double free = space->distanceAlong(space->centre(), direction);
    require(std::isfinite(free) && free >= space->clearance() - 1e-6,
            "no wall is nearer than the clearance");
  }
  require(space->signedDistance({1e6, 1e6}) < 0.0, "the far away is outside");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf(
      {R"({"format": "forewalk.space/1", "rectangle": [6, 4.5]})",
       R"({"format": "forewalk.space/1", "circle": 3.5})",
       std::string_view(
           R"({"format": "forewalk.space/1", "polygon": [[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]],
                                "holes": [[[0.5, 4], [1, 4], [1, 5]]]})"),
       "5,5\n-5,5\n-5,-5\n5,-5\n\n1,1\n1,2\n2,2\n2,1\n\n-1,-1\n-2,-1\n-2,-2\n",
       "1\n9,9\n-9,9\n-9,-9\n\n3,3\n3,4\n4,4\n\n//"
       "\n3,2\n-3,2\n-3,-2\n3,-2\n\n1,1\n1,1.5\n1.5,1\n\n/\n"
       "0,0\n0,1\n5,5\n0,1\n\n//\n"});
}
