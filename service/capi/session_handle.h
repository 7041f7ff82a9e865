// What a forewalk_session is.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/links.h"
#include "navmesh/standing.h"
#include "rdw/session.h"
#include "service/capi/flat_graph.h"
#include "service/capi/forewalk.h"
#include "service/capi/session_recording.h"
#include "service/capi/space_handle.h"
#include "service/daemon/session_bytes.h"
#include "service/live_world.h"

struct forewalk_session {
  forewalk_session(forewalk::rdw::Session made, forewalk_axes spoken)
      : session(std::move(made)),
        axes(spoken),
        graph(session.world().graph, session.settings().prediction.polygons,
              session.settings().method) {
    static std::atomic<std::uint32_t> sessions{0};
    number = ++sessions;
  }

  forewalk::rdw::Session session;
  std::vector<forewalk::navmesh::Link> links;
  std::vector<forewalk::navmesh::Standing> standing;
  forewalk_axes axes;
  forewalk::capi::FlatGraph graph;
  bool graphIsThisFrames = false;
  forewalk::capi::SpaceMember member;                     ///< of a space that it shares with others
  std::optional<forewalk::service::WorldReader> follows;  ///< a world that moves by itself
  std::shared_ptr<forewalk::service::LiveWorld> followed;
  std::optional<glm::vec3> gaze, chest;  ///< as told last, our axes
  std::unique_ptr<forewalk::capi::SessionRecording> recording;
  std::string scene;  ///< for recordings: what it walks in, and the hash of that; none: it moves
  std::optional<forewalk::daemon::NavMeshHash> navMesh;
  std::uint32_t number;     ///< its name in the log, from 1
  std::uint32_t flags = 0;  ///< of the last frame, for what is told once
  bool framed = false;      ///< it has had a frame
};

namespace forewalk::capi {

/// A session in `world`, from settings whose form was checked. On success *session is the caller's.
forewalk_status createSession(std::shared_ptr<const navmesh::World> world,
                              const forewalk_session_settings& settings, rdw::SessionSettings ours,
                              forewalk_session** session);

}  // namespace forewalk::capi
