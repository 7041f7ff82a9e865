// Which instance, session and space a handle belongs to.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <unordered_map>

#include "service/openxr/config.h"
#include "service/openxr/next.h"
#include "service/openxr/redirected_session.h"

namespace forewalk::openxr {

/// An XrInstance that the layer is in.
struct LayerInstance {
  XrInstance handle = XR_NULL_HANDLE;
  Next next;
  std::unique_ptr<const LayerConfig> config;  ///< null: everything is passed on unchanged
  /// Layers' colours can be scaled; until somebody refuses that.
  mutable std::atomic<bool> tints = false;
};

/// An XrSession: it keeps its instance.
struct LayerSession {
  std::shared_ptr<const LayerInstance> instance;
  std::unique_ptr<RedirectedSession> redirected;  ///< null: the runtime has no space for it
};

/// A space, and the session that keeps it.
struct LayerSpace {
  std::shared_ptr<LayerSession> session;
  AppSpace space;
};

/// All handles of the process. Any thread; who found something keeps it alive. A look-up costs a
/// shared lock.
class Registry {
 public:
  static Registry& instance();

  void add(std::shared_ptr<const LayerInstance> instance);
  void add(XrSession handle, std::shared_ptr<LayerSession> session);
  void add(LayerSpace space);

  std::shared_ptr<const LayerInstance> find(XrInstance handle) const;
  std::shared_ptr<LayerSession> find(XrSession handle) const;
  std::optional<LayerSpace> find(XrSpace handle) const;

  /// The latest instance: for handles that nobody told us of, as extensions make them. A loader has
  /// one instance at a time.
  std::shared_ptr<const LayerInstance> latest() const;

  /// What is removed takes what was made from it along. Returns what it was.
  std::shared_ptr<const LayerInstance> remove(XrInstance handle);
  std::shared_ptr<LayerSession> remove(XrSession handle);
  void remove(XrSpace handle);

 private:
  mutable std::shared_mutex mutex_;
  std::unordered_map<XrInstance, std::shared_ptr<const LayerInstance>> instances_;
  std::unordered_map<XrSession, std::shared_ptr<LayerSession>> sessions_;
  std::unordered_map<XrSpace, LayerSpace> spaces_;
  std::shared_ptr<const LayerInstance> latest_;
};

}  // namespace forewalk::openxr
