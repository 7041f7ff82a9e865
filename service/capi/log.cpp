#include "service/capi/log.h"

#include <atomic>

namespace forewalk::capi {

namespace {

// Written in this order, read in the other: who sees a level sees its function.
std::atomic<void*> owner{nullptr};
std::atomic<forewalk_log_function> listener{nullptr};
std::atomic<forewalk_log_level> highest{FOREWALK_LOG_OFF};

}  // namespace

bool logs(forewalk_log_level level) noexcept {
  return level <= highest.load(std::memory_order_acquire);
}

void tell(forewalk_log_level level, const char* message) noexcept {
  if (!logs(level)) return;
  const forewalk_log_function function = listener.load(std::memory_order_acquire);
  if (function != nullptr) function(owner.load(std::memory_order_acquire), level, message);
}

}  // namespace forewalk::capi

extern "C" void forewalk_set_log(forewalk_log_function function, void* user,
                                 forewalk_log_level most) {
  using namespace forewalk::capi;
  highest.store(FOREWALK_LOG_OFF, std::memory_order_release);
  owner.store(user, std::memory_order_release);
  listener.store(function, std::memory_order_release);
  highest.store(function == nullptr ? FOREWALK_LOG_OFF : most, std::memory_order_release);
}
