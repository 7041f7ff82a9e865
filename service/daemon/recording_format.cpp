#include "service/daemon/recording_format.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

namespace forewalk::daemon {

std::string recordingHead(std::string_view sessionId, std::string_view scene,
                          std::string_view navMeshHash, std::string_view settingsText,
                          std::string_view state) {
  const std::string sceneText = nlohmann::json(std::string(scene))
                                    .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return fmt::format(
      R"({{"format":"forewalk.session/1","session":"{}","scene":{},"navmesh":"{}","settings":{},"state":{}}})"
      "\n",
      sessionId, sceneText, navMeshHash, settingsText,
      state.empty() ? "null" : fmt::format("\"{}\"", toBase64Url(state)));
}

void appendRecordedFrame(const Frame& frame, const Answer& answer, std::string& out) {
  out += "{\"in\":";
  out += frameText(frame);
  out += ",\"out\":";
  appendAnswerText(answer, {}, {}, out);
  out += "}\n";
}

void appendRecordedTeleport(const rdw::VirtualStart& to, std::string& out) {
  fmt::format_to(std::back_inserter(out),
                 "{{\"teleport\":{{\"position\":[{},{},{}],\"heading\":{}}}}}\n", to.floor.x,
                 to.floor.y, to.floor.z, to.heading);
}

void appendRecordedWorldChange(std::string& out) { out += "{\"world\":\"changed\"}\n"; }

}  // namespace forewalk::daemon
