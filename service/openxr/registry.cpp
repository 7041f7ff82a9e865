#include "service/openxr/registry.h"

#include <mutex>
#include <utility>

namespace forewalk::openxr {
namespace {

template <typename Map, typename Handle>
auto found(const Map& map, Handle handle) -> typename Map::mapped_type {
  const auto at = map.find(handle);
  return at == map.end() ? typename Map::mapped_type{} : at->second;
}

template <typename Map, typename Handle>
auto taken(Map& map, Handle handle) -> typename Map::mapped_type {
  auto node = map.extract(handle);
  return node.empty() ? typename Map::mapped_type{} : std::move(node.mapped());
}

}  // namespace

Registry& Registry::instance() {
  static Registry registry;
  return registry;
}

void Registry::add(std::shared_ptr<const LayerInstance> instance) {
  const std::lock_guard lock(mutex_);
  latest_ = instance;
  instances_.insert_or_assign(instance->handle, std::move(instance));
}

void Registry::add(XrSession handle, std::shared_ptr<LayerSession> session) {
  const std::lock_guard lock(mutex_);
  sessions_.insert_or_assign(handle, std::move(session));
}

void Registry::add(LayerSpace space) {
  const std::lock_guard lock(mutex_);
  spaces_.insert_or_assign(space.space.handle, std::move(space));
}

std::shared_ptr<const LayerInstance> Registry::find(XrInstance handle) const {
  const std::shared_lock lock(mutex_);
  return found(instances_, handle);
}

std::shared_ptr<LayerSession> Registry::find(XrSession handle) const {
  const std::shared_lock lock(mutex_);
  return found(sessions_, handle);
}

std::optional<LayerSpace> Registry::find(XrSpace handle) const {
  const std::shared_lock lock(mutex_);
  const auto at = spaces_.find(handle);
  return at == spaces_.end() ? std::nullopt : std::optional(at->second);
}

std::shared_ptr<const LayerInstance> Registry::latest() const {
  const std::shared_lock lock(mutex_);
  return latest_;
}

std::shared_ptr<const LayerInstance> Registry::remove(XrInstance handle) {
  const std::lock_guard lock(mutex_);
  auto instance = taken(instances_, handle);
  if (latest_ == instance) latest_.reset();
  std::erase_if(spaces_,
                [&](const auto& space) { return space.second.session->instance == instance; });
  std::erase_if(sessions_,
                [&](const auto& session) { return session.second->instance == instance; });
  return instance;
}

std::shared_ptr<LayerSession> Registry::remove(XrSession handle) {
  const std::lock_guard lock(mutex_);
  auto session = taken(sessions_, handle);
  std::erase_if(spaces_, [&](const auto& space) { return space.second.session == session; });
  return session;
}

void Registry::remove(XrSpace handle) {
  const std::lock_guard lock(mutex_);
  const LayerSpace space = taken(spaces_, handle);
  if (space.session && space.session->redirected) space.session->redirected->forget(handle);
}

}  // namespace forewalk::openxr
