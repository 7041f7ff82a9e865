#include "navmesh/build/scene_glb.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "navmesh/build/little_endian.h"
#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinChunk = 0x004e4942;
constexpr std::size_t kHeader = 12;
constexpr std::size_t kChunkHeader = 8;

void appendChunk(std::string& glb, std::uint32_t kind, std::string_view content,
                 std::size_t padding) {
  appendLittle(glb, static_cast<std::uint32_t>(content.size() + padding));
  appendLittle(glb, kind);
  glb += content;
  glb.append(padding, '\0');
}

}  // namespace

tl::expected<GlbChunks, Error> splitGlb(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, 4) != std::string_view("glTF").substr(0, bytes.size())) {
    return refuse(ErrorCode::kFormatUnknown,
                  fmt::format("{}: begins with {}, a .glb begins with glTF. Check its ending.",
                              name, inQuotes(bytes.substr(0, 4))));
  }
  const auto endsEarly = [&](std::uint64_t needed) {
    return damaged(fmt::format("{}: ends early, {} bytes of {}. Copy or export it again.", name,
                               bytes.size(), needed));
  };
  if (bytes.size() < kHeader + kChunkHeader) return endsEarly(kHeader + kChunkHeader);
  const std::uint32_t version = loadLittle(bytes, 4);
  if (version != 2) {
    return refuse(
        ErrorCode::kFormatUnsupported,
        fmt::format("{}: GLB version {} is not read, 2 is. Export it as glTF 2.0.", name, version));
  }
  const std::uint32_t length = loadLittle(bytes, 8);
  if (length > bytes.size()) return endsEarly(length);
  bytes = bytes.substr(0, length);
  GlbChunks chunks;
  std::size_t at = kHeader;
  for (int chunk = 0; at + kChunkHeader <= bytes.size(); ++chunk) {
    const std::uint64_t size = loadLittle(bytes, at);
    const std::uint32_t kind = loadLittle(bytes, at + 4);
    at += kChunkHeader;
    if (size > bytes.size() - at) {
      return damaged(
          fmt::format("{}: chunk {} has {} bytes, {} are left of the file. Copy or export it "
                      "again.",
                      name, chunk, size, bytes.size() - at));
    }
    const std::string_view content = bytes.substr(at, static_cast<std::size_t>(size));
    at += content.size();
    if (chunk == 0 && kind != kJsonChunk) break;
    if (chunk == 0) chunks.json = content;
    if (chunk == 1 && kind == kBinChunk) chunks.bin = content;
  }
  if (chunks.json.empty()) {
    return damaged(fmt::format("{}: the first chunk is no JSON. Export it again.", name));
  }
  return chunks;
}

tl::expected<std::string, Error> joinGlb(std::string json, std::string_view bin,
                                         const std::string& name) {
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::size_t padding = (4 - bin.size() % 4) % 4;
  const std::size_t size = kHeader + kChunkHeader + json.size() +
                           (bin.empty() ? 0 : kChunkHeader + bin.size() + padding);
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} bytes, a .glb holds at most {}. Split the scene.", name, size,
                              std::numeric_limits<std::uint32_t>::max()));
  }
  std::string glb;
  glb.reserve(size);
  glb += "glTF";
  appendLittle(glb, 2);
  appendLittle(glb, static_cast<std::uint32_t>(size));
  appendChunk(glb, kJsonChunk, json, 0);
  if (!bin.empty()) {
    appendChunk(glb, kBinChunk, bin, padding);
  }
  return glb;
}

}  // namespace forewalk::navmesh
