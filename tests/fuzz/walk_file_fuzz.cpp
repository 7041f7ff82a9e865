// The reader of recorded walks on any bytes; what it accepts has to survive resampling.
#include <cmath>

#include "rdw/walk_file.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

namespace {

void checkWalk(const forewalk::rdw::Walk& walk) {
  require(walk.samples.size() >= 2, "a walk has two samples");
  for (std::size_t i = 0; i < walk.samples.size(); ++i) {
    const auto& sample = walk.samples[i];
    require(std::isfinite(sample.seconds) && std::isfinite(sample.plan.x) &&
                std::isfinite(sample.plan.y),
            "samples are finite");
    require(i == 0 || sample.seconds > walk.samples[i - 1].seconds, "time increases");
  }
  const auto frames =
      forewalk::rdw::resample(walk, 5.0);  // a day at most, so half a million frames
  require(!frames.empty(), "a walk has a frame");
  for (const auto& frame : frames) {
    require(
        std::isfinite(frame.plan.x) && std::isfinite(frame.plan.y) && std::abs(frame.heading) < 3.2,
        "frames are finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using forewalk::rdw::WalkTimes;
  const auto bytes = std::as_bytes(std::span<const std::uint8_t>(data, size));
  const auto timed = forewalk::rdw::parseWalks(bytes, "fuzz");
  for (const WalkTimes times : {WalkTimes::kRequired, WalkTimes::kOptional}) {
    const auto walks = forewalk::rdw::parseWalks(bytes, "fuzz", times);
    if (walks) {
      require(!walks->empty(), "a file that is accepted has a walk");
      for (const auto& walk : *walks) checkWalk(walk);
    } else {
      require(!timed || times == WalkTimes::kRequired, "times may be given where they need not");
      requireSentence(walks.error().message, "fuzz");
    }
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf(
      {"walker_id,t,x,z\nu0,0.000,0.0532,-0.0236\nu0,0.044,0.0526,-0.0237\nu1,0.0,1e1,-2\nu1,0.1,"
       "10,-2\n",
       "t,x,z\r\n0,0,0\r\n0.5,0.25,-0.25\r\n1.5,-1,+1\r\n", "z,note,t,x\n0,,1,0\n0,a b,2,1\n",
       "x,z\n0,0\n0.5,-1\n", "walker_id,z,x\na,0,0\nb,1,0\na,0,1\nb,2,2\n"});
}
