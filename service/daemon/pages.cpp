#include "service/daemon/pages.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "service/files.h"

namespace forewalk::daemon {
namespace {

constexpr std::size_t kMostFiles = 4096;
constexpr std::size_t kMostBytes = 64u << 20;

constexpr std::pair<std::string_view, std::string_view> kTypes[] = {
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".jsonl", "application/jsonl"},
    {".map", "application/json"},
    {".wasm", "application/wasm"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".txt", "text/plain; charset=utf-8"},
    {".gltf", "model/gltf+json"},
    {".glb", "model/gltf-binary"},
    {".fwmesh", "application/octet-stream"},
    {".obj", "text/plain; charset=utf-8"}};

std::string_view typeOf(const std::filesystem::path& file) {
  for (const auto& [ending, type] : kTypes) {
    if (file.extension() == ending) return type;
  }
  return {};
}

tl::unexpected<Error> refuse(ErrorCode code, const std::filesystem::path& folder,
                             std::string_view what) {
  return tl::unexpected(Error{code, fmt::format("--inspector {}: {}", folder.string(), what)});
}

}  // namespace

tl::expected<Pages, Error> loadPages(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code failure;
  if (!fs::is_directory(folder, failure)) {
    return refuse(ErrorCode::kFileUnreadable, folder,
                  "there is no such folder. Build the inspector, or leave the option out.");
  }
  Pages pages;
  std::size_t bytes = 0;
  fs::recursive_directory_iterator at(folder, failure);
  while (!failure && at != fs::recursive_directory_iterator()) {
    const fs::directory_entry& entry = *at;
    const bool hidden = entry.path().filename().string().front() == '.';
    if (hidden && entry.is_directory(failure)) at.disable_recursion_pending();
    const std::string_view type = typeOf(entry.path());
    if (!hidden && !type.empty() && !entry.is_symlink(failure) && entry.is_regular_file(failure)) {
      auto content = service::readFile(entry.path());
      if (!content) return tl::unexpected(std::move(content.error()));
      bytes += content->size();
      if (pages.size() == kMostFiles || bytes > kMostBytes) {
        return refuse(ErrorCode::kTooLarge, folder,
                      fmt::format("more than {} files or {} MiB. Is it the inspector's folder?",
                                  kMostFiles, kMostBytes >> 20));
      }
      pages["/" + fs::relative(entry.path(), folder, failure).generic_string()] = {
          type, std::string(reinterpret_cast<const char*>(content->data()), content->size())};
    }
    at.increment(failure);
  }
  if (failure) return refuse(ErrorCode::kFileUnreadable, folder, failure.message());
  const auto index = pages.find("/index.html");
  if (index == pages.end()) {
    return refuse(ErrorCode::kDataDamaged, folder,
                  "has no index.html. Give the folder that the inspector was built into.");
  }
  pages["/"] = index->second;
  return pages;
}

}  // namespace forewalk::daemon
