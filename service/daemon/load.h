// Many made-up users at once against a daemon, and what each answer took: `forewalk load`.
//
// Round trips are counted from the moment a frame was due, not from when it got away, so that a
// daemon that stalls cannot hide behind the client that waits for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "service/daemon/message.h"

namespace forewalk::daemon {

/// Somebody made up who walks up and down their room, looking about, and turns where they are told
/// to; the same for the same `number`.
class MadeUpBody {
 public:
  explicit MadeUpBody(unsigned number = 0) : heading_(0.7 * number), phase_(number) {}

  /// `dt` seconds further on; the first frame has `sequence` 0, then 1, 2, ...
  Frame next(double dt, bool turning);

 private:
  glm::dvec2 position_{0.0};
  double heading_, phase_, seconds_ = 0.0;
  std::uint32_t sequence_ = 0;
};

struct LoadSettings {
  std::string address = "127.0.0.1";
  unsigned short port = 0;
  std::string accessToken;     ///< empty: none is sent
  std::string session = "{}";  ///< of the hellos: JSON
  unsigned sessions = 200;
  double rate = 90.0;     ///< frames a second and session
  double seconds = 10.0;  ///< that frames are sent for
  bool json = false;      ///< else binary
  unsigned checked = 2;   ///< sessions whose answers are worked out again
};

struct LoadResult {
  std::uint64_t sent = 0, answered = 0;
  std::uint64_t lost = 0;  ///< sent, and not answered within two seconds of the end
  std::uint64_t late = 0;  ///< got away more than a frame's time after they were due
  unsigned failed = 0;     ///< sessions that could not begin, or ended early
  std::string failure;     ///< why the first of them did
  double medianMs = 0, p99Ms = 0, p999Ms = 0, worstMs = 0;  ///< of the round trips
  double connectSeconds = 0;                                ///< until all sessions had begun
  std::uint64_t checkedFrames = 0;
  std::uint64_t wrongFrames = 0;  ///< whose answer is not that of a session of our own
  std::uint64_t hash = 0;         ///< of the checked answers
  // What the daemon says of itself (/metrics), over the seconds of frames.
  double daemonCores = 0;  ///< processor seconds a second
  double daemonMiBBefore = 0, daemonMiBAfter = 0;
  double clientCores = 0;
};

/// Runs one round against a daemon that listens. `world` is the daemon's, or null: answers are not
/// checked then. Fails where the daemon cannot be reached or the settings are no session's.
[[nodiscard]] tl::expected<LoadResult, Error> runLoad(const LoadSettings& settings,
                                                      std::shared_ptr<const navmesh::World> world);

}  // namespace forewalk::daemon
