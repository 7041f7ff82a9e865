#include "service/live_world.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "service/parallel.h"

namespace forewalk::service {

namespace {

using Lock = std::unique_lock<std::mutex>;

// How long something that a reader has given back may wait for its end while nothing else happens.
constexpr std::chrono::milliseconds kCollectEvery{100};

struct Delivery {
  WorldVersion version;
  rdw::PreparedWorld prepared;  // only states where the session is in that world already
  Delivery* next = nullptr;     // given back before this one
};

}  // namespace

// Between LiveWorld and one reader. Each side only ever exchanges pointers: a delivery belongs to
// whoever took it out.
struct WorldSlot {
  ~WorldSlot() {
    delete incoming.load();
    freeReturned();
  }

  void freeReturned() {
    for (Delivery* one = returned.exchange(nullptr, std::memory_order_acquire); one != nullptr;) {
      const std::unique_ptr<Delivery> last(one);
      one = one->next;
      --out;
    }
  }

  std::atomic<Delivery*> incoming{nullptr};  // the newest version, until the reader takes it
  std::atomic<Delivery*> returned{nullptr};  // a stack; the reader pushes, LiveWorld takes all
  std::atomic<bool> ended{false};            // the reader is gone

  // LiveWorld's, under its versionMutex_.
  std::optional<prediction::PredictionLimits> limits;  // of the session; none: no session
  prediction::Method method = prediction::Method::kPolygon;
  std::shared_ptr<const navmesh::World> sessionWorld;           // what was last prepared for it
  std::shared_ptr<const navmesh::PolygonStates> sessionStates;  // by fronts: in these states
  int out = 0;  // deliveries neither taken back nor freed
};

// ---- The reader's side

WorldReader::WorldReader(std::shared_ptr<WorldSlot> slot, WorldVersion version)
    : slot_(std::move(slot)), version_(std::move(version)) {}

WorldReader::WorldReader(WorldReader&&) noexcept = default;

WorldReader& WorldReader::operator=(WorldReader&& other) noexcept {
  std::swap(slot_, other.slot_);
  std::swap(version_, other.version_);
  return *this;
}

WorldReader::~WorldReader() {
  if (slot_) slot_->ended.store(true);
}

bool WorldReader::take(rdw::Session* session) {
  if (slot_->incoming.load(std::memory_order_relaxed) == nullptr) return false;
  Delivery* delivery = slot_->incoming.exchange(nullptr, std::memory_order_acquire);
  if (delivery == nullptr) return false;  // taken back for a newer one
  std::swap(version_, delivery->version);
  if (session != nullptr && delivery->prepared.world != nullptr) {
    session->enter(delivery->prepared);
  } else if (session != nullptr) {
    session->setStates(delivery->prepared.states);
  }
  // What was left goes back. Repeats only where LiveWorld takes the stack in between.
  delivery->next = slot_->returned.load(std::memory_order_relaxed);
  while (!slot_->returned.compare_exchange_weak(delivery->next, delivery, std::memory_order_release,
                                                std::memory_order_relaxed)) {
  }
  return true;
}

// ---- The owner's side

tl::expected<std::unique_ptr<LiveWorld>, Error> LiveWorld::make(navmesh::Scene scene,
                                                                const LiveWorldSettings& settings) {
  navmesh::BuildRun run;
  run.forEach = onThreads(settings.threads);
  auto mesh = navmesh::LiveMesh::make(std::move(scene), settings.build, settings.outlines, run);
  if (!mesh) return tl::unexpected(mesh.error());
  return std::unique_ptr<LiveWorld>(new LiveWorld(std::move(*mesh), settings.threads));
}

LiveWorld::LiveWorld(navmesh::LiveMesh mesh, unsigned threads) : mesh_(std::move(mesh)) {
  if (threads != 1) run_.forEach = onThreads(threads);
  newest_ = {1, mesh_.world(), std::make_shared<const navmesh::PolygonStates>()};
  status_.version = 1;
  thread_ = std::thread([this] { run(); });
}

LiveWorld::~LiveWorld() {
  {
    const Lock lock(changesMutex_);
    stop_ = true;
  }
  changesCame_.notify_all();
  thread_.join();
}

tl::expected<void, Error> LiveWorld::change(std::span<const navmesh::ObstacleChange> changes) {
  for (const navmesh::ObstacleChange& one : changes) {
    if (!one.obstacle) continue;
    if (auto valid = navmesh::validate(*one.obstacle); !valid) return valid;
  }
  {
    const Lock lock(changesMutex_);
    for (const navmesh::ObstacleChange& one : changes) {
      pending_.insert_or_assign(one.id, one.obstacle);
    }
  }
  changesCame_.notify_all();
  return {};
}

tl::expected<void, Error> LiveWorld::setArea(AreaId id, navmesh::AreaCost area) {
  const Lock lock(versionMutex_);
  const auto before = areas_.find(id);
  std::optional<navmesh::AreaCost> old;
  if (before != areas_.end()) old = before->second;
  areas_.insert_or_assign(id, std::move(area));
  auto published = publish(newest_.world);
  if (!published) {
    if (old) {
      areas_.insert_or_assign(id, std::move(*old));
    } else {
      areas_.erase(id);
    }
  }
  return published;
}

void LiveWorld::removeArea(AreaId id) {
  const Lock lock(versionMutex_);
  if (areas_.erase(id) == 0) return;
  // The others were sound when they came.
  if (auto published = publish(newest_.world); !published) {
    status_.failure = published.error().message;
  }
}

tl::expected<void, Error> LiveWorld::setLink(const navmesh::Link& link) {
  const Lock lock(versionMutex_);
  const navmesh::World& world = *newest_.world;
  if (auto alone = navmesh::makeLinks(world.graph, world.locations, {&link, 1}); !alone) {
    return tl::unexpected(alone.error());
  }
  const auto before = links_.find(link.id);
  std::optional<navmesh::Link> old;
  if (before != links_.end()) old = before->second;
  links_.insert_or_assign(link.id, link);
  auto published = publish(newest_.world);
  if (!published) {
    links_.erase(link.id);
    if (old) links_.emplace(link.id, *old);
  }
  return published;
}

void LiveWorld::removeLink(navmesh::LinkId id) {
  const Lock lock(versionMutex_);
  if (links_.erase(id) == 0) return;
  if (auto published = publish(newest_.world); !published) {
    status_.failure = published.error().message;
  }
}

tl::expected<bool, Error> LiveWorld::setStanding(std::span<const navmesh::Standing> standing) {
  for (const navmesh::Standing& one : standing) {
    if (auto valid = navmesh::validate(one); !valid) return tl::unexpected(valid.error());
  }
  const Lock lock(versionMutex_);
  standing_.assign(standing.begin(), standing.end());
  if (blockedIn(*newest_.world) == blocked_) return false;
  if (auto published = publish(newest_.world); !published) {
    return tl::unexpected(published.error());
  }
  return true;
}

/// Each polygon once, at its highest cost: whoever stands behind another changes nothing.
std::vector<navmesh::PolygonCost> LiveWorld::blockedIn(const navmesh::World& world) const {
  std::vector<navmesh::PolygonCost> blocked;
  for (const navmesh::Standing& one : standing_) {
    navmesh::blockedBy(world.graph, world.locations, one, blocked);
  }
  std::sort(blocked.begin(), blocked.end(), [](const auto& a, const auto& b) {
    return a.polygon != b.polygon ? a.polygon < b.polygon : a.cost > b.cost;
  });
  blocked.erase(std::unique(blocked.begin(), blocked.end(),
                            [](const auto& a, const auto& b) { return a.polygon == b.polygon; }),
                blocked.end());
  return blocked;
}

WorldReader LiveWorld::reader() { return add(std::nullopt, prediction::Method::kPolygon); }

WorldReader LiveWorld::readerForSession(const prediction::PredictionLimits& limits,
                                        prediction::Method method) {
  return add(limits, method);
}

WorldReader LiveWorld::add(std::optional<prediction::PredictionLimits> limits,
                           prediction::Method method) {
  auto slot = std::make_shared<WorldSlot>();
  slot->limits = limits;
  slot->method = method;
  const Lock lock(versionMutex_);
  if (limits) slot->sessionWorld = newest_.world;
  if (method == prediction::Method::kFront) slot->sessionStates = newest_.states;
  slots_.push_back(slot);
  return WorldReader(std::move(slot), newest_);
}

void LiveWorld::waitUntilDone() {
  Lock lock(changesMutex_);
  changesDone_.wait(lock, [this] { return pending_.empty() && !building_; });
}

LiveWorldStatus LiveWorld::status() const {
  const Lock lock(versionMutex_);
  return status_;
}

void LiveWorld::run() {
  Lock lock(changesMutex_);
  while (!stop_) {
    if (pending_.empty()) {
      lock.unlock();
      const bool more = collect();
      lock.lock();
      const auto woken = [this] { return stop_ || !pending_.empty(); };
      if (more) {
        changesCame_.wait_for(lock, kCollectEvery, woken);
      } else {
        changesCame_.wait(lock, woken);
      }
      continue;
    }
    std::vector<navmesh::ObstacleChange> changes;
    for (auto& [id, obstacle] : pending_) changes.push_back({id, std::move(obstacle)});
    pending_.clear();
    building_ = true;
    lock.unlock();
    apply(changes);
    lock.lock();
    building_ = false;
    if (pending_.empty()) changesDone_.notify_all();
  }
  building_ = false;
  pending_.clear();
  changesDone_.notify_all();
}

void LiveWorld::apply(const std::vector<navmesh::ObstacleChange>& changes) {
  const auto start = std::chrono::steady_clock::now();
  std::string failure;
  std::uint32_t tilesBuilt = 0;
  try {
    const auto update = mesh_.apply(changes, run_);
    const Lock lock(versionMutex_);
    if (!update) {
      failure = update.error().message;
    } else {
      tilesBuilt = update->tilesBuilt;
      if (update->world != newest_.world) {
        if (auto published = publish(update->world); !published) {
          failure = published.error().message;
        }
      }
    }
  } catch (const std::exception& exception) {  // no memory, no thread
    failure = exception.what();
  }
  const Lock lock(versionMutex_);
  status_.failure = std::move(failure);
  status_.tilesBuilt = tilesBuilt;
  status_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Under versionMutex_, as are the two below.
tl::expected<void, Error> LiveWorld::publish(std::shared_ptr<const navmesh::World> world) {
  std::vector<navmesh::AreaCost> areas;
  for (const auto& [id, area] : areas_) areas.push_back(area);
  std::vector<navmesh::Link> list;
  for (const auto& [id, link] : links_) list.push_back(link);
  std::vector<navmesh::LinkId> groundless;
  auto links = navmesh::makeLinks(world->graph, world->locations, list, &groundless);
  if (!links) return tl::unexpected(links.error());
  std::vector<navmesh::PolygonCost> blocked = blockedIn(*world);
  auto states = navmesh::makePolygonStates(world->graph, areas, std::move(*links), blocked);
  if (!states) return tl::unexpected(states.error());
  blocked_ = std::move(blocked);
  status_.linksWithoutGround = static_cast<std::uint32_t>(groundless.size());
  frontIndex_ = nullptr;
  newest_ = {newest_.number + 1, std::move(world),
             std::make_shared<const navmesh::PolygonStates>(std::move(*states))};
  status_.version = newest_.number;
  std::erase_if(slots_, [](const auto& slot) { return slot->ended.load(); });
  for (const std::shared_ptr<WorldSlot>& slot : slots_) deliver(*slot);
  return {};
}

void LiveWorld::deliver(WorldSlot& slot) {
  slot.freeReturned();
  // One that the reader did not take goes on with the newer version: for a moment there is none,
  // and the reader keeps what it has.
  std::unique_ptr<Delivery> delivery(slot.incoming.exchange(nullptr, std::memory_order_acquire));
  if (delivery == nullptr) {
    delivery = std::make_unique<Delivery>();
    ++slot.out;
  }
  delivery->version = newest_;
  // Fronts are prepared for a world in its states, not for the world alone.
  const bool byFronts = slot.method == prediction::Method::kFront;
  if (slot.limits &&
      (slot.sessionWorld != newest_.world || (byFronts && slot.sessionStates != newest_.states))) {
    if (byFronts && frontIndex_ == nullptr) {
      frontIndex_ = rdw::makeFrontIndex(*newest_.world, newest_.states.get());
    }
    delivery->prepared = rdw::prepareWorld(newest_.world, *slot.limits, slot.method, frontIndex_);
    slot.sessionWorld = newest_.world;
    if (byFronts) slot.sessionStates = newest_.states;
  }
  delivery->prepared.states = newest_.states;
  slot.incoming.store(delivery.release(), std::memory_order_release);
}

/// Frees what readers have given back. Whether there is, or will be, more.
bool LiveWorld::collect() {
  const Lock lock(versionMutex_);
  std::erase_if(slots_, [](const auto& slot) { return slot->ended.load(); });
  bool more = false;
  for (const std::shared_ptr<WorldSlot>& slot : slots_) {
    slot->freeReturned();
    more = more || slot->out > 0;
  }
  return more;
}

}  // namespace forewalk::service
