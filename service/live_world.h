// A world that moves while people walk in it.
//
//   any thread: changes --> a thread of its own: tiles, graph --> a slot per reader --> its frame
//
// The frame never waits: it looks into its reader's slot, and what it finds there is finished. A
// reader keeps its version until it takes the next one; what it leaves goes back through the slot,
// so that memory is freed here and never in a frame. Versions that a slow reader did not take are
// skipped.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/live_mesh.h"
#include "navmesh/links.h"
#include "navmesh/polygon_states.h"
#include "navmesh/standing.h"
#include "navmesh/world.h"
#include "rdw/session.h"

namespace forewalk::service {

/// What there is to walk on at one time. `states` belong to `world`.
struct WorldVersion {
  std::uint64_t number = 0;  ///< ascending from 1
  std::shared_ptr<const navmesh::World> world;
  std::shared_ptr<const navmesh::PolygonStates> states;
};

struct WorldSlot;

/// One thread's view of a LiveWorld; may outlive it. Ends outside of frames.
class WorldReader {
 public:
  WorldReader(WorldReader&&) noexcept;
  WorldReader& operator=(WorldReader&&) noexcept;
  ~WorldReader();

  /// Takes the newest version, where there is one; true if so. Nothing of the one before may be
  /// used from then on. Neither waits, locks, allocates nor frees.
  bool update() { return take(nullptr); }

  /// The same for a session that walks in version().world, between its frames: it enters the new
  /// world, and its predictions know what is closed there. For readers made for a session.
  bool update(rdw::Session& session) { return take(&session); }

  /// The version taken last. Lives until the next update.
  const WorldVersion& version() const { return version_; }

 private:
  friend class LiveWorld;
  WorldReader(std::shared_ptr<WorldSlot> slot, WorldVersion version);
  bool take(rdw::Session* session);

  std::shared_ptr<WorldSlot> slot_;
  WorldVersion version_;
};

/// An area's name: a door, a room that is closed for the night; any number.
enum class AreaId : std::uint32_t {};

struct LiveWorldSettings {
  navmesh::BuildSettings build{.tile = 6.4f};
  /// Where no polygon crosses (navmesh::TileSource::make): the outlines of doors that areas close.
  std::vector<navmesh::Obstacle> outlines;
  unsigned threads = 1;  ///< that build tiles; 0: all cores
};

/// How the last change went.
struct LiveWorldStatus {
  std::uint64_t version = 0;             ///< number of the newest version
  std::uint32_t tilesBuilt = 0;          ///< for the last change of obstacles
  double seconds = 0.0;                  ///< from taking it up to its publication
  std::uint32_t linksWithoutGround = 0;  ///< in the newest version
  std::string failure;                   ///< why the last one was not applied; empty where it was
};

/// Its functions may be called from any thread, but not from a frame: they lock, for as long as a
/// version takes to publish. None waits for tiles but waitUntilDone.
class LiveWorld {
 public:
  /// Builds the scene and starts the thread. Fails as navmesh::LiveMesh::make does.
  [[nodiscard]] static tl::expected<std::unique_ptr<LiveWorld>, Error> make(
      navmesh::Scene scene, const LiveWorldSettings& settings = {});

  LiveWorld(const LiveWorld&) = delete;
  LiveWorld& operator=(const LiveWorld&) = delete;
  ~LiveWorld();  ///< Changes not taken up yet are dropped. Readers keep what they have.

  /// Obstacles that come, move and go. The changes of one call are seen at once or not at all; of
  /// those that come while tiles are built, only an obstacle's last counts.
  /// Fails as navmesh::validate(Obstacle) does; then none is taken up.
  [[nodiscard]] tl::expected<void, Error> change(std::span<const navmesh::ObstacleChange> changes);

  /// Closes, opens or prices an area; published when the call returns. No tile is rebuilt. Which
  /// polygons it holds is found again in every world (navmesh::polygonsIn).
  /// Fails as navmesh::makePolygonStates does.
  [[nodiscard]] tl::expected<void, Error> setArea(AreaId id, navmesh::AreaCost area);

  /// Forgets an area: its ground is open again, where no other area holds it.
  void removeArea(AreaId id);

  /// Puts a link (lift, ladder, teleport) or puts it elsewhere, opens or closes it; published when
  /// the call returns. Its ends are found again in every world; one without ground there, where an
  /// obstacle stands, leads nowhere until it has ground again (LiveWorldStatus).
  /// Fails as navmesh::makeLinks does, also where an end is off the ground now.
  [[nodiscard]] tl::expected<void, Error> setLink(const navmesh::Link& link);

  /// Forgets a link.
  void removeLink(navmesh::LinkId id);

  /// Who stands where, all of them, in the place of those before (navmesh/standing.h). Published
  /// when the call returns, where they block other polygons than before, or at another cost; else
  /// nothing is done, which costs some microseconds for ten. Found again in every world. True where
  /// a version was published.
  /// Fails as navmesh::validate(Standing) does; then all stay where they were.
  [[nodiscard]] tl::expected<bool, Error> setStanding(std::span<const navmesh::Standing> standing);

  /// A reader that has the newest version.
  WorldReader reader();

  /// The same for a session to be made in version().world: what the session needs in each new world
  /// is made here. `limits` and `method` are those of its settings, whose states are
  /// version().states.
  WorldReader readerForSession(const prediction::PredictionLimits& limits,
                               prediction::Method method = prediction::Method::kPolygon);

  /// Returns when all changes so far are published, or have failed.
  void waitUntilDone();

  LiveWorldStatus status() const;

 private:
  LiveWorld(navmesh::LiveMesh mesh, unsigned threads);
  WorldReader add(std::optional<prediction::PredictionLimits> limits, prediction::Method method);
  void run();
  void apply(const std::vector<navmesh::ObstacleChange>& changes);
  tl::expected<void, Error> publish(std::shared_ptr<const navmesh::World> world);
  void deliver(WorldSlot& slot);
  bool collect();
  std::vector<navmesh::PolygonCost> blockedIn(const navmesh::World& world) const;

  // Changes on their way to the thread.
  mutable std::mutex changesMutex_;
  std::condition_variable changesCame_, changesDone_;
  std::map<navmesh::ObstacleId, std::optional<navmesh::Obstacle>> pending_;
  bool building_ = false;
  bool stop_ = false;

  // The newest version and who reads it.
  mutable std::mutex versionMutex_;
  WorldVersion newest_;
  std::shared_ptr<const prediction::FrontIndex> frontIndex_;  // of its world, once it was needed
  std::map<AreaId, navmesh::AreaCost> areas_;
  std::map<navmesh::LinkId, navmesh::Link> links_;
  std::vector<navmesh::Standing> standing_;
  std::vector<navmesh::PolygonCost> blocked_;  // by them, in the newest world
  std::vector<std::shared_ptr<WorldSlot>> slots_;
  LiveWorldStatus status_;

  navmesh::LiveMesh mesh_;  // the thread's
  navmesh::BuildRun run_;
  std::thread thread_;  // last, so that it finds all the others
};

}  // namespace forewalk::service
