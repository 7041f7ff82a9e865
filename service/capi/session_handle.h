// What a forewalk_session is.
//
// What needs threads or files hangs on two interfaces, so that a build without them (service/wasm)
// has all the rest.
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
#include "service/capi/space_handle.h"

namespace forewalk::capi {

/// A world that moves by itself, and whose newest version a session takes between its frames.
class WorldFollower {
 public:
  virtual ~WorldFollower() = default;
  virtual bool update(rdw::Session& session) = 0;  ///< true where it took one
};

/// Whoever writes a session's frames down. Allocates and waits for nothing.
class FrameRecorder {
 public:
  virtual ~FrameRecorder() = default;
  /// After a frame, with what it was told.
  virtual void frame(forewalk_session& session, const rdw::HeadPose& head, double seconds) = 0;
  virtual void teleport(const rdw::VirtualStart& to) = 0;
  virtual void worldChange() = 0;
};

}  // namespace forewalk::capi

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
  forewalk::capi::SpaceMember member;  ///< of a space that it shares with others
  std::unique_ptr<forewalk::capi::WorldFollower> follows;  ///< null: it is in a navmesh
  std::unique_ptr<forewalk::capi::FrameRecorder> recorder;
  std::optional<glm::vec3> gaze, chest;  ///< as told last, our axes
  std::string scene;                     ///< what its navmesh was made from
  std::uint64_t groundHash = 0;          ///< of its navmesh (contentHash); 0: it moves
  std::uint32_t number;                  ///< its name in the log, from 1
  std::uint32_t flags = 0;               ///< of the last frame, for what is told once
  bool framed = false;                   ///< it has had a frame
};

namespace forewalk::capi {

/// A session in `world`, from settings whose form was checked. On success *session is the caller's.
forewalk_status createSession(std::shared_ptr<const navmesh::World> world,
                              const forewalk_session_settings& settings, rdw::SessionSettings ours,
                              forewalk_session** session);

}  // namespace forewalk::capi
