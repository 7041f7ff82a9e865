// Sessions as files that are only ever appended to, a line a frame.
//
//   {"format":"forewalk.session/1","session":"…","scene":"…","navmesh":"…","settings":{…},"state":"…"}
//   {"in":{"sequence":0,"seconds":0.0,"position":[…],"orientation":[…]},"out":{…}}
//   {"teleport":{"position":[…],"heading":…}}
//   {"world":"changed"}
//
// "in" and "out" are a frame and its answer as in PROTOCOL.md, without the token. Floats are the
// shortest text that reads back to the same float. "state" is null for a session that began here,
// else base64url of the state it went on from. A last line that is cut off is left out when it is
// read. Beyond a change of the world, which no recording holds, nothing can be walked again.
#pragma once

#include <string>
#include <string_view>

#include "rdw/session.h"
#include "service/daemon/message.h"

namespace forewalk::daemon {

/// What stands for the hash of a navmesh in recordings of worlds that move.
inline constexpr std::string_view kMovingWorld = "moving";

/// The first line of a recording, with its end.
std::string recordingHead(std::string_view sessionId, std::string_view scene,
                          std::string_view navMeshHash, std::string_view settingsText,
                          std::string_view state);

/// Appends a frame's line, with its end.
void appendRecordedFrame(const Frame& frame, const Answer& answer, std::string& out);

/// The same for what came between two frames.
void appendRecordedTeleport(const rdw::VirtualStart& to, std::string& out);
void appendRecordedWorldChange(std::string& out);

}  // namespace forewalk::daemon
