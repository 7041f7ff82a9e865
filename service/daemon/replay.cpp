#include "service/daemon/replay.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "service/daemon/recording_format.h"

namespace forewalk::daemon {
namespace {

tl::unexpected<Error> refuse(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

tl::expected<rdw::VirtualStart, Error> parseTeleport(std::string_view line,
                                                     const std::string& name) {
  const auto json = rdw::parseJson(line, name);
  if (!json) return tl::unexpected(json.error());
  rdw::Problem problem(name);
  rdw::Fields fields(*json, "", problem, "in a recording");
  rdw::VirtualStart to;
  const rdw::Json* teleport = fields.find("teleport");
  rdw::Fields place(*teleport, "teleport.", problem);
  std::vector<double> position;
  if (place.coordinates("position", 3, position)) {
    to.floor = glm::vec3(glm::dvec3(position[0], position[1], position[2]));
  } else {
    place.wrongKind("position", "[x, y, z], metres");
  }
  place.number("heading", -1e6, 1e6, to.heading);
  place.finish();
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return to;
}

}  // namespace

tl::expected<RecordingHead, Error> parseRecordingHead(std::string_view line) {
  const auto json = rdw::parseJson(line, "line 1");
  if (!json) return tl::unexpected(json.error());
  rdw::Problem problem("line 1");
  rdw::Fields fields(*json, "", problem, "in a recording");
  rdw::requireFormat(fields, "forewalk.session/1");
  RecordingHead head;
  fields.text("session", head.sessionId);
  fields.text("scene", head.scene);
  fields.text("navmesh", head.navMesh);
  const rdw::Json* settings = fields.find("settings");
  const rdw::Json* state = fields.find("state");
  if (settings == nullptr) fields.wrongKind("settings", "an object {...}");
  if (state != nullptr && !state->is_null()) {
    if (state->is_string()) head.state = fromBase64Url(state->get_ref<const std::string&>());
    if (!head.state) fields.wrongKind("state", "null or base64url");
  }
  if (problem.error()) return tl::unexpected(*problem.error());
  auto made = parseSettings(settings->dump());
  if (!made) return tl::unexpected(std::move(made.error()));
  head.settings = std::move(*made);
  return head;
}

tl::expected<Replay, Error> replay(std::string_view recording,
                                   std::shared_ptr<const navmesh::World> world,
                                   const NavMeshHash& navMesh,
                                   const std::function<void(const Answer&)>& answer) {
  Replay result;
  std::size_t number = 0;
  // Only lines with their end: the last one may have been on its way.
  const auto nextLine = [&]() -> std::optional<std::string_view> {
    const std::size_t end = recording.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = recording.substr(0, end);
    recording.remove_prefix(end + 1);
    ++number;
    return line;
  };
  const auto first = nextLine();
  if (!first) return refuse("the first line is not complete: nothing was recorded.");
  auto head = parseRecordingHead(*first);
  if (!head) return tl::unexpected(std::move(head.error()));
  if (head->navMesh == kMovingWorld) {
    return refuse(
        "recorded in a world that moves, which no recording holds: it can be read, but not walked "
        "again.");
  }
  if (head->navMesh != textOf(navMesh)) {
    return refuse(
        fmt::format("recorded in the navmesh {}, this one is {}. Give the scene and the "
                    "settings that the daemon had ({}).",
                    head->navMesh, textOf(navMesh), head->scene));
  }
  auto session = rdw::Session::make(std::move(world), head->settings);
  if (!session) return tl::unexpected(std::move(session.error()));
  if (head->state) {
    const auto state = stateFromBytes(*head->state, navMesh);
    if (!state) return tl::unexpected(state.error());
    if (!session->resume(state->state)) {
      return refuse("line 1: its state cannot be gone on from.");
    }
  }
  std::string again;
  while (const auto line = nextLine()) {
    if (line->starts_with("{\"world\"")) {
      result.worldChanged = number;
      break;
    }
    if (line->starts_with("{\"teleport\"")) {
      const auto to = parseTeleport(*line, fmt::format("line {}", number));
      if (!to) return tl::unexpected(to.error());
      if (!session->teleport(*to)) {
        return refuse(fmt::format("line {}: its place is not on this navmesh.", number));
      }
      continue;
    }
    constexpr std::string_view kIn = "{\"in\":", kOut = ",\"out\":";
    const std::size_t out = line->find(kOut);
    if (line->substr(0, kIn.size()) != kIn || out == std::string_view::npos) {
      return refuse(fmt::format("line {}: no frame.", number));
    }
    const auto frame = parseFrame(line->substr(kIn.size(), out - kIn.size()), true);
    if (!frame) {
      return refuse(fmt::format("line {}: {}", number, frame.error().message));
    }
    const Answer made = answerOf(frame->sequence, walk(*session, *frame));
    again.clear();
    appendAnswerText(made, {}, {}, again);
    again += '}';
    ++result.frames;
    if (answer) answer(made);
    const std::string_view recorded = line->substr(out + kOut.size());
    if (!result.firstDifference && recorded != again) {
      result.firstDifference = number;
      result.recorded = recorded;
      result.replayed = again;
    }
  }
  if (!result.worldChanged) result.cutOff = recording.size();
  return result;
}

}  // namespace forewalk::daemon
