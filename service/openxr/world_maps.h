// What a frame knows about the spaces: for each kind, the map that takes what the runtime says
// about it into the application's world.
//
// Spaces are located by the runtime in one of its own, the tracking space (floor at height 0). Two
// things an application can tell from poses: where the user's body is (head, hands, whatever is
// tracked), and what is fixed in its world (LOCAL, STAGE, ...). Bodies are redirected, what is
// fixed stays. With G the map of a kind and X the pose of a space in the tracking space, a space A
// located in B is, for the application,
//
//   inverse(G_B X_B) G_A X_A  =  K (A in B),   K = inverse(X_B) inverse(G_B) G_A X_B
//
// so that spaces of maps that are equal keep the runtime's answer to the bit.
#pragma once

#include <openxr/openxr.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>

#include "service/openxr/rigid.h"

namespace forewalk::openxr {

/// The body moves with the user through the room. Whatever is not known to be fixed counts as
/// body: an anchor on a real table is passed as the table is.
enum class Kind : std::uint8_t { kBody, kStage, kLocal, kLocalFloor, kUnbounded };
inline constexpr std::size_t kKinds = 5;

Kind kindOf(XrReferenceSpaceType type);

/// The maps of one frame, by Kind.
struct WorldMaps {
  XrTime time = 0;  ///< the frame is displayed at
  std::array<Rigid, kKinds> of;
  bool signal = false;  ///< the user is to turn, or to step back

  const Rigid& operator[](Kind kind) const { return of[static_cast<std::size_t>(kind)]; }
  Rigid& operator[](Kind kind) { return of[static_cast<std::size_t>(kind)]; }
};

/// Those of the last frames. An application prepares a frame while another is still being drawn,
/// and asks for the past of a hand: who asks for a time gets the maps of the frame that was shown
/// then, so that all answers for one frame agree. Any thread.
class WorldMapHistory {
 public:
  void add(const WorldMaps& maps);

  /// Of the latest frame displayed at `time` or before; of the oldest known, where all came later;
  /// none before the first.
  std::optional<WorldMaps> at(XrTime time) const;

 private:
  static constexpr std::size_t kFrames = 32;  // a third of a second, and more frames than overlap

  mutable std::mutex mutex_;
  std::array<WorldMaps, kFrames> maps_;
  std::size_t count_ = 0;  // ever added; the ring's next place is count_ % kFrames
};

}  // namespace forewalk::openxr
