// Links, people standing and other navmeshes, told to one session.
#include <memory>
#include <utility>
#include <vector>

#include "service/capi/axes.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/session_handle.h"
#include "service/capi/status.h"

namespace forewalk::capi {

namespace {

constexpr const char* kTellTheWorld =
    "the session is in a forewalk_world: tell that what changes (forewalk_world_set_link, "
    "_set_standing, _set_obstacles).";

/// Graphs by fronts know the states by their index, so that the world is entered again.
void setStates(rdw::Session& session, std::shared_ptr<const navmesh::PolygonStates> states) {
  const rdw::SessionSettings& settings = session.settings();
  if (settings.method != prediction::Method::kFront) {
    session.setStates(states);
    return;
  }
  rdw::PreparedWorld next = rdw::prepareWorld(session.sharedWorld(), settings.prediction,
                                              settings.method, nullptr, std::move(states));
  session.enter(next);
}

/// What is known of a world beside its floor. With `groundless`, links whose ground has gone lead
/// nowhere.
tl::expected<std::shared_ptr<const navmesh::PolygonStates>, Error> statesOf(
    const navmesh::World& world, const std::vector<navmesh::Link>& list,
    const std::vector<navmesh::Standing>& standing, std::vector<navmesh::LinkId>* groundless) {
  auto links = navmesh::makeLinks(world.graph, world.locations, list, groundless);
  if (!links) return tl::unexpected(links.error());
  std::vector<navmesh::PolygonCost> blocked;
  for (const navmesh::Standing& one : standing) {
    navmesh::blockedBy(world.graph, world.locations, one, blocked);
  }
  auto states = navmesh::makePolygonStates(world.graph, {}, std::move(*links), blocked);
  if (!states) return tl::unexpected(states.error());
  return std::make_shared<const navmesh::PolygonStates>(std::move(*states));
}

// Recordings hold no links, nobody who stands, and no other navmesh.
void noteWorldChange(forewalk_session& session) {
  session.groundHash = 0;
  if (session.recorder) session.recorder->worldChange();
}

}  // namespace

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

forewalk_status forewalk_session_set_links(forewalk_session* session, const forewalk_link* links,
                                           size_t count) {
  if (session == nullptr || (links == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_set_links: session or links is null.");
  }
  if (session->follows) return failLiteral(FOREWALK_ERROR_ARGUMENT, kTellTheWorld);
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::Link> list;
    for (size_t i = 0; i < count; ++i) {
      list.push_back(linkFrom(session->axes, links[i]));
    }
    const navmesh::World& world = session->session.world();
    auto states = statesOf(world, list, session->standing, nullptr);
    if (!states) return fail(states.error());
    session->links = std::move(list);
    noteWorldChange(*session);
    setStates(session->session, std::move(*states));
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_session_set_standing(forewalk_session* session,
                                              const forewalk_standing* standing, size_t count) {
  if (session == nullptr || (standing == nullptr && count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_set_standing: session or standing is null.");
  }
  if (session->follows) return failLiteral(FOREWALK_ERROR_ARGUMENT, kTellTheWorld);
  return guarded([&]() -> forewalk_status {
    std::vector<navmesh::Standing> people;
    for (size_t i = 0; i < count; ++i) {
      people.push_back(standingFrom(session->axes, standing[i]));
      if (auto valid = navmesh::validate(people.back()); !valid) return fail(valid.error());
    }
    std::vector<navmesh::LinkId> groundless;
    auto states = statesOf(session->session.world(), session->links, people, &groundless);
    if (!states) return fail(states.error());
    session->standing = std::move(people);
    noteWorldChange(*session);
    setStates(session->session, std::move(*states));
    return FOREWALK_OK;
  });
}

forewalk_status forewalk_session_enter(forewalk_session* session, const forewalk_navmesh* navmesh) {
  if (session == nullptr || navmesh == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_session_enter: session or navmesh is null.");
  }
  if (session->follows) return failLiteral(FOREWALK_ERROR_ARGUMENT, kTellTheWorld);
  return guarded([&]() -> forewalk_status {
    const rdw::SessionSettings& settings = session->session.settings();
    const bool byFronts = settings.method == prediction::Method::kFront;
    std::vector<navmesh::LinkId> groundless;
    auto states = statesOf(*navmesh->world, session->links, session->standing, &groundless);
    if (!states) return fail(states.error());
    rdw::PreparedWorld next = rdw::prepareWorld(
        navmesh->world, settings.prediction, settings.method,
        byFronts && (*states)->allOpen() ? navmesh->frontIndex() : nullptr, *states);
    FlatGraph graph(navmesh->world->graph, settings.prediction.polygons, settings.method);
    session->session.enter(next);
    noteWorldChange(*session);
    session->graph = std::move(graph);
    session->graphIsThisFrames = false;
    return FOREWALK_OK;
  });
}

}  // extern "C"
