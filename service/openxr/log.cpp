#include "service/openxr/log.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>

namespace forewalk::openxr {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::mutex mutex;
std::unique_ptr<std::FILE, Close> file;
bool silent = false;

}  // namespace

void openLog() {
  const char* name = std::getenv("FOREWALK_OPENXR_LOG");
  const std::string where = name == nullptr ? "" : name;
  const std::lock_guard lock(mutex);
  file.reset();
  silent = where == "off";
  if (!where.empty() && !silent) file.reset(std::fopen(where.c_str(), "a"));
}

void say(std::string_view line) noexcept {
  const std::lock_guard lock(mutex);
  if (silent) return;
  std::FILE* out = file ? file.get() : stderr;
  std::fprintf(out, "forewalk: %.*s\n", static_cast<int>(line.size()), line.data());
  std::fflush(out);
}

}  // namespace forewalk::openxr
