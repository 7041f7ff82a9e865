// A recorded session walked again, and its answers compared letter by letter.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/session.h"
#include "service/daemon/message.h"
#include "service/daemon/session_bytes.h"

namespace forewalk::daemon {

/// The head of a recording.
struct RecordingHead {
  std::string sessionId;
  std::string scene;    ///< as the daemon was given it
  std::string navMesh;  ///< hash
  rdw::SessionSettings settings;
  std::optional<std::string> state;  ///< raw bytes of the state it went on from
};

/// Reads the first line. Fails (kDataDamaged, kFormatUnknown) naming what is wrong.
[[nodiscard]] tl::expected<RecordingHead, Error> parseRecordingHead(std::string_view line);

struct Replay {
  std::size_t frames = 0;
  std::optional<std::size_t> worldChanged;     ///< line, from 1, beyond which nothing was walked
  std::optional<std::size_t> firstDifference;  ///< line, from 1
  std::string recorded, replayed;              ///< of it
  std::size_t cutOff = 0;                      ///< bytes of a last line that was not finished
};

/// Walks the recording in `world`, whose hash is `navMesh`, from the head's settings and state, and
/// compares. The same build gives the same answers to the last bit. Calls `answer` (may be empty)
/// with each frame's. Fails where the recording is damaged, of another navmesh, or its session
/// cannot be made. O(frames).
[[nodiscard]] tl::expected<Replay, Error> replay(
    std::string_view recording, std::shared_ptr<const navmesh::World> world,
    const NavMeshHash& navMesh, const std::function<void(const Answer&)>& answer = {});

}  // namespace forewalk::daemon
