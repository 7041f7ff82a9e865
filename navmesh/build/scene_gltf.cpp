// glTF 2.0 through tinygltf, which neither checks that accessors lie in their buffers nor which
// extensions a file requires, cuts long integers short, and opens whatever files a URI names.
//
// So the JSON passes a sieve first: it refuses what we do not read, by name, and hands on only what
// a scene needs (nodes, triangles, positions, indices and the bytes they lie in). Images,
// materials, skins and animations never reach tinygltf. What it returns is checked against the
// buffers' real sizes before it is read.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kIntMost = std::numeric_limits<std::int32_t>::max();  // tinygltf's indices
constexpr std::int64_t kBytesMost = std::int64_t{1} << 33;
constexpr std::uint64_t kCornersMost = std::uint64_t{1} << 30;  // 4 GiB of indices

tl::unexpected<Error> damaged(std::string message) {
  return refuse(ErrorCode::kDataDamaged, std::move(message));
}

// ---------------------------------------------------------------------------------------------------
// Required extensions.

/// Extensions about looks leave the triangles as they are.
bool isAboutLooks(std::string_view extension) {
  static constexpr std::string_view kBeginnings[] = {
      "KHR_materials_", "KHR_texture_",    "EXT_texture_", "MSFT_texture_",
      "KHR_lights_",    "EXT_lights_",     "KHR_xmp",      "KHR_techniques_webgl",
      "MSFT_packing_",  "ADOBE_materials_"};
  return std::any_of(std::begin(kBeginnings), std::end(kBeginnings),
                     [&](std::string_view beginning) { return extension.starts_with(beginning); });
}

std::string_view remedy(std::string_view extension) {
  if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression" ||
      extension == "KHR_meshopt_compression" || extension == "KHR_mesh_quantization") {
    return "Export without mesh compression";
  }
  return "Export without it";
}

// ---------------------------------------------------------------------------------------------------
// The sieve.

/// What tinygltf is given.
struct PlainGltf {
  Json json = Json::object();
  std::string_view bin;                         ///< of the .glb, in the caller's bytes
  std::vector<std::vector<std::byte>> outside;  ///< buffer files, already read
};

/// Copies what a scene needs from one JSON tree to another. The first thing wrong stays in `error`
/// and everything after it does nothing.
class Sieve {
 public:
  Sieve(const Json& file, const std::string& name,
        const std::optional<std::filesystem::path>& folder, PlainGltf& out)
      : file_(file), name_(name), folder_(folder), out_(out) {}

  std::optional<Error> error;

  void run() {
    if (!file_.is_object()) return fail("the JSON is no object");
    checkVersion();
    checkExtensions();
    if (error) return;
    out_.json["asset"]["version"] = "2.0";
    for (const char* list : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
      out_.json[list] = Json::array();
    }
    const Json& scenes = list("scenes");
    const Json& nodes = list("nodes");
    const Json& meshes = list("meshes");
    if (file_.contains("scene")) {
      out_.json["scene"] = integer(file_, "scene", "the file", 0, count(scenes) - 1, std::nullopt);
    }
    for (std::size_t i = 0; i < scenes.size() && !error; ++i) {
      const std::string where = fmt::format("scene {}", i);
      if (!isObject(scenes[i], where)) return;
      Json scene = Json::object();
      scene["nodes"] = indices(scenes[i], "nodes", where, count(nodes));
      out_.json["scenes"].push_back(std::move(scene));
    }
    for (std::size_t i = 0; i < nodes.size() && !error; ++i)
      passNode(nodes[i], i, count(nodes), count(meshes));
    for (std::size_t i = 0; i < meshes.size() && !error; ++i) passMesh(meshes[i], i);
  }

 private:
  static std::int64_t count(const Json& array) { return static_cast<std::int64_t>(array.size()); }

  void fail(ErrorCode code, const std::string& message) {
    if (!error) error = Error{code, fmt::format("{}: {}", name_, message)};
  }
  void fail(const std::string& message) {
    fail(ErrorCode::kDataDamaged, message + ". Export it again.");
  }

  bool isObject(const Json& value, const std::string& where) {
    if (!value.is_object()) fail(where + " is no JSON object");
    return !error;
  }

  /// A top-level array, empty where there is none.
  const Json& list(const char* key) {
    static const Json kNone = Json::array();
    const auto found = file_.find(key);
    if (found == file_.end()) return kNone;
    if (!found->is_array()) {
      fail(fmt::format("{} is no JSON array", key));
      return kNone;
    }
    return *found;
  }

  /// Member `key` in [low, high]; `otherwise` where it is missing, which is wrong without one.
  std::int64_t integer(const Json& object, const char* key, const std::string& where,
                       std::int64_t low, std::int64_t high, std::optional<std::int64_t> otherwise) {
    const auto found = object.find(key);
    if (found == object.end()) {
      if (!otherwise) fail(fmt::format("{} has no {}", where, key));
      return otherwise.value_or(low);
    }
    // Some exporters write 12.0.
    const bool whole = found->is_number() && std::abs(found->get<double>()) < 9e15 &&
                       std::trunc(found->get<double>()) == found->get<double>();
    const std::int64_t value = whole ? static_cast<std::int64_t>(found->get<double>()) : -1;
    if (!whole || value < low || value > high) {
      fail(high < low
               ? fmt::format("{} has {} {}, there is none", where, key, inQuotes(found->dump()))
               : fmt::format("{} has {} {}, a whole number from {} to {} is needed", where, key,
                             inQuotes(found->dump(-1, ' ', true, Json::error_handler_t::replace)),
                             low, high));
      return low;
    }
    return value;
  }

  /// Member `key`, an array of indices below `count`; empty where it is missing.
  Json indices(const Json& object, const char* key, const std::string& where, std::int64_t count) {
    Json result = Json::array();
    const auto found = object.find(key);
    if (found == object.end()) return result;
    if (!found->is_array()) {
      fail(fmt::format("{} has {} that are no JSON array", where, key));
      return result;
    }
    for (const Json& value : *found) {
      if (!value.is_number_integer() || value.get<double>() < 0.0 ||
          value.get<double>() >= static_cast<double>(count)) {
        fail(fmt::format("{} has {} {}, there are {}", where, key, shown(value), count));
        return result;
      }
      result.push_back(value);
    }
    return result;
  }

  /// Copies member `key`, an array of `size` numbers, if it is there.
  void passNumbers(const Json& from, Json& to, const char* key, std::size_t size,
                   const std::string& where) {
    const auto found = from.find(key);
    if (found == from.end()) return;
    const bool sound = found->is_array() && found->size() == size &&
                       std::all_of(found->begin(), found->end(),
                                   [](const Json& value) { return value.is_number(); });
    if (!sound)
      return fail(
          fmt::format("{} has {} {}, {} numbers are needed", where, key, shown(*found), size));
    to[key] = *found;
  }

  static std::string shown(const Json& value) {
    return inQuotes(value.dump(-1, ' ', true, Json::error_handler_t::replace));
  }

  void checkVersion() {
    const auto asset = file_.find("asset");
    if (asset == file_.end() || !asset->is_object() || !asset->contains("version")) {
      return fail("asset.version is missing");
    }
    const Json& version = (*asset)["version"];
    if (!version.is_string() || !version.get_ref<const std::string&>().starts_with("2.")) {
      fail(ErrorCode::kFormatUnsupported,
           fmt::format("glTF version {} is not read, 2.0 is. Export it as glTF 2.0.",
                       shown(version)));
    }
    const auto least = asset->find("minVersion");
    if (least != asset->end() && *least != "2.0") {
      fail(
          ErrorCode::kFormatUnsupported,
          fmt::format("needs glTF version {}, 2.0 is read. Export it as glTF 2.0.", shown(*least)));
    }
  }

  void checkExtensions() {
    for (const Json& extension : list("extensionsRequired")) {
      if (!extension.is_string()) return fail("extensionsRequired holds " + shown(extension));
      const std::string& word = extension.get_ref<const std::string&>();
      if (isAboutLooks(word)) continue;
      fail(ErrorCode::kFormatUnsupported,
           fmt::format("requires the extension {}, which is not read. {}.", inQuotes(word),
                       remedy(word)));
      return;
    }
  }

  void passNode(const Json& node, std::size_t i, std::int64_t nodes, std::int64_t meshes) {
    const std::string where = fmt::format("node {}", i);
    if (!isObject(node, where)) return;
    // Instancing is usually not required, yet leaving it out loses geometry.
    const auto extensions = node.find("extensions");
    if (extensions != node.end() && extensions->is_object() &&
        extensions->contains("EXT_mesh_gpu_instancing")) {
      return fail(ErrorCode::kFormatUnsupported,
                  where +
                      " uses the extension EXT_mesh_gpu_instancing, which is not read. Export its "
                      "instances as nodes.");
    }
    Json plain = Json::object();
    plain["children"] = indices(node, "children", where, nodes);
    if (node.contains("mesh"))
      plain["mesh"] = integer(node, "mesh", where, 0, meshes - 1, std::nullopt);
    passNumbers(node, plain, "matrix", 16, where);
    passNumbers(node, plain, "translation", 3, where);
    passNumbers(node, plain, "rotation", 4, where);
    passNumbers(node, plain, "scale", 3, where);
    out_.json["nodes"].push_back(std::move(plain));
  }

  void passMesh(const Json& mesh, std::size_t i) {
    const std::string where = fmt::format("mesh {}", i);
    if (!isObject(mesh, where)) return;
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array())
      return fail(where + " has no primitives");
    Json plain = Json::object();
    plain["primitives"] = Json::array();
    for (std::size_t p = 0; p < primitives->size() && !error; ++p) {
      passPrimitive((*primitives)[p], fmt::format("{}, primitive {}", where, p),
                    plain["primitives"]);
    }
    out_.json["meshes"].push_back(std::move(plain));
  }

  void passPrimitive(const Json& primitive, const std::string& where, Json& primitives) {
    if (!isObject(primitive, where)) return;
    const std::int64_t mode = integer(primitive, "mode", where, 0, 6, TINYGLTF_MODE_TRIANGLES);
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
        mode != TINYGLTF_MODE_TRIANGLE_FAN) {
      return;  // points and lines
    }
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) {
      return fail(where + " has no attributes");
    }
    if (!attributes->contains("POSITION")) return;  // the specification lets a client skip these
    Json plain = Json::object();
    plain["mode"] = mode;
    plain["attributes"]["POSITION"] = passAccessor(*attributes, "POSITION", where);
    if (primitive.contains("indices")) plain["indices"] = passAccessor(primitive, "indices", where);
    if (!error) primitives.push_back(std::move(plain));
  }

  /// Passes the accessor that member `key` names; its new index.
  std::int64_t passAccessor(const Json& user, const char* key, const std::string& userWhere) {
    const Json& accessors = list("accessors");
    const std::int64_t index = integer(user, key, userWhere, 0, count(accessors) - 1, std::nullopt);
    if (error) return 0;
    const bool positions = std::string_view(key) == "POSITION";
    const std::string where = fmt::format("accessor {} ({} of {})", index, key, userWhere);
    const Json& accessor = accessors[static_cast<std::size_t>(index)];
    if (!isObject(accessor, where)) return 0;
    if (accessor.contains("sparse")) {
      fail(ErrorCode::kFormatUnsupported,
           where + " is sparse, which is not read. Export it without sparse accessors.");
      return 0;
    }
    if (!accessor.contains("bufferView")) {
      fail(ErrorCode::kFormatUnsupported,
           where +
               " has no bufferView: compressed or empty meshes are not read. Export it without "
               "mesh compression.");
      return 0;
    }
    const std::int64_t component =
        integer(accessor, "componentType", where, 5120, 5130, std::nullopt);
    const std::string type = accessor.contains("type") && accessor["type"].is_string()
                                 ? accessor["type"].get<std::string>()
                                 : std::string("missing");
    if (error) return 0;
    if (positions && component >= TINYGLTF_COMPONENT_TYPE_BYTE &&
        component <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
      fail(ErrorCode::kFormatUnsupported,
           fmt::format(
               "{} holds integers (componentType {}): the extension KHR_mesh_quantization is "
               "not read. Export positions as float.",
               where, component));
      return 0;
    }
    const bool fits =
        positions ? type == "VEC3" && component == TINYGLTF_COMPONENT_TYPE_FLOAT
                  : type == "SCALAR" && (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                         component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                         component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    if (!fits) {
      fail(fmt::format("{} has type {} and componentType {}, {} is needed", where, inQuotes(type),
                       component,
                       positions ? "VEC3 of float (5126)"
                                 : "SCALAR of unsigned byte, short or int (5121, 5123, 5125)"));
      return 0;
    }
    if (const auto known = accessors_.find(index); known != accessors_.end()) return known->second;
    Json plain = Json::object();
    plain["componentType"] = component;
    plain["type"] = type;
    plain["count"] = integer(accessor, "count", where, 1, kIntMost, std::nullopt);
    plain["byteOffset"] = integer(accessor, "byteOffset", where, 0, kBytesMost, 0);
    plain["bufferView"] = passBufferView(accessor, where);
    return add("accessors", std::move(plain), index, accessors_);
  }

  std::int64_t passBufferView(const Json& accessor, const std::string& accessorWhere) {
    const Json& views = list("bufferViews");
    const std::int64_t index =
        integer(accessor, "bufferView", accessorWhere, 0, count(views) - 1, std::nullopt);
    if (error) return 0;
    if (const auto known = views_.find(index); known != views_.end()) return known->second;
    const std::string where = fmt::format("bufferView {}", index);
    const Json& view = views[static_cast<std::size_t>(index)];
    if (!isObject(view, where)) return 0;
    Json plain = Json::object();
    plain["byteOffset"] = integer(view, "byteOffset", where, 0, kBytesMost, 0);
    plain["byteLength"] = integer(view, "byteLength", where, 1, kBytesMost, std::nullopt);
    if (view.contains("byteStride")) {
      const std::int64_t stride = integer(view, "byteStride", where, 4, 252, std::nullopt);
      if (stride % 4 != 0)
        fail(fmt::format("{} has byteStride {}, a multiple of 4 is needed", where, stride));
      plain["byteStride"] = stride;
    }
    plain["buffer"] = passBuffer(view, where);
    return add("bufferViews", std::move(plain), index, views_);
  }

  std::int64_t passBuffer(const Json& view, const std::string& viewWhere) {
    const Json& buffers = list("buffers");
    const std::int64_t index =
        integer(view, "buffer", viewWhere, 0, count(buffers) - 1, std::nullopt);
    if (error) return 0;
    if (const auto known = buffers_.find(index); known != buffers_.end()) return known->second;
    const std::string where = fmt::format("buffer {}", index);
    const Json& buffer = buffers[static_cast<std::size_t>(index)];
    if (!isObject(buffer, where)) return 0;
    Json plain = Json::object();
    const std::int64_t length = integer(buffer, "byteLength", where, 1, kBytesMost, std::nullopt);
    plain["byteLength"] = length;
    const auto uri = buffer.find("uri");
    if (error) return 0;
    if (uri == buffer.end()) {
      if (index != 0 || out_.bin.empty()) {
        fail(where + " has no uri, and there is no binary chunk for it");
      } else if (static_cast<std::uint64_t>(length) > out_.bin.size()) {
        fail(fmt::format("{} has byteLength {}, the binary chunk has {} bytes", where, length,
                         out_.bin.size()));
      }
    } else if (!uri->is_string()) {
      fail(fmt::format("{} has uri {}, a text is needed", where, shown(*uri)));
    } else if (uri->get_ref<const std::string&>().starts_with("data:")) {
      plain["uri"] = *uri;
    } else {
      plain["uri"] =
          readOutside(uri->get_ref<const std::string&>(), static_cast<std::size_t>(length), where);
    }
    return add("buffers", std::move(plain), index, buffers_);
  }

  /// Reads the file beside the .gltf that `uri` names; the name tinygltf will ask for.
  std::string readOutside(const std::string& uri, std::size_t length, const std::string& where) {
    if (!folder_) {
      fail(ErrorCode::kFormatUnsupported,
           fmt::format(
               "{} lies in the file {}, which bytes in memory cannot name. Import the file, or "
               "export a .glb.",
               where, inQuotes(uri)));
      return {};
    }
    std::string decoded;
    for (std::size_t i = 0; i < uri.size(); ++i) {
      const auto digit = [&](std::size_t at) {
        const char c = at < uri.size() ? uri[at] : '\0';
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
      };
      if (uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0) {
        decoded += static_cast<char>(digit(i + 1) * 16 + digit(i + 2));
        i += 2;
      } else {
        decoded += uri[i];
      }
    }
    const std::filesystem::path relative = std::filesystem::path(decoded).lexically_normal();
    const bool inside = !decoded.empty() && relative.is_relative() &&
                        decoded.find_first_of(std::string_view(":\\\0", 3)) == std::string::npos &&
                        *relative.begin() != "..";
    if (!inside) {
      fail(ErrorCode::kFormatUnsupported,
           fmt::format(
               "{} names {}, only files in the folder of the .gltf are read. Put it beside the "
               ".gltf.",
               where, inQuotes(uri)));
      return {};
    }
    auto bytes = readBytes(*folder_ / relative);
    if (!bytes) {
      fail(bytes.error().code, fmt::format("{}: {}", where, bytes.error().message));
      return {};
    }
    if (bytes->size() < length) {
      fail(fmt::format("{} has byteLength {}, {} ends after {} bytes", where, length, inQuotes(uri),
                       bytes->size()));
      return {};
    }
    bytes->resize(length);
    out_.outside.push_back(std::move(*bytes));
    return fmt::format("outside{}", out_.outside.size() - 1);
  }

  std::int64_t add(const char* key, Json plain, std::int64_t index,
                   std::map<std::int64_t, std::int64_t>& known) {
    Json& array = out_.json[key];
    array.push_back(std::move(plain));
    return known[index] = count(array) - 1;
  }

  const Json& file_;
  const std::string& name_;
  const std::optional<std::filesystem::path>& folder_;
  PlainGltf& out_;
  std::map<std::int64_t, std::int64_t> accessors_, views_, buffers_;  ///< theirs to ours
};

// ---------------------------------------------------------------------------------------------------
// GLB's chunks.

std::uint32_t loadLittle(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  }
  return value;
}

void storeLittle(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffu);
}

struct Chunks {
  std::string_view json;
  std::string_view bin;
};

constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinChunk = 0x004e4942;

tl::expected<Chunks, Error> splitGlb(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kHeader = 12;
  constexpr std::size_t kChunkHeader = 8;
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
  Chunks chunks;
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

/// The sieved file as the bytes of a .glb.
std::string joinGlb(const PlainGltf& plain) {
  std::string json = plain.json.dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::size_t padding = (4 - plain.bin.size() % 4) % 4;
  const std::size_t binSize = plain.bin.empty() ? 0 : 8 + plain.bin.size() + padding;
  std::string glb = "glTF";
  glb.reserve(20 + json.size() + binSize);
  storeLittle(glb, 2);
  storeLittle(glb, static_cast<std::uint32_t>(20 + json.size() + binSize));
  storeLittle(glb, static_cast<std::uint32_t>(json.size()));
  storeLittle(glb, kJsonChunk);
  glb += json;
  if (binSize > 0) {
    storeLittle(glb, static_cast<std::uint32_t>(plain.bin.size() + padding));
    storeLittle(glb, kBinChunk);
    glb += plain.bin;
    glb.append(padding, '\0');
  }
  return glb;
}

// ---------------------------------------------------------------------------------------------------
// tinygltf's file system: the buffers that the sieve has read.

bool outsideExists(const std::string& file, void*) { return file.starts_with("outside"); }

std::string expandOutside(const std::string& file, void*) { return file; }

bool readOutside(std::vector<unsigned char>* bytes, std::string*, const std::string& file,
                 void* user) {
  auto& outside = *static_cast<std::vector<std::vector<std::byte>>*>(user);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    if (file != fmt::format("outside{}", i)) continue;
    bytes->resize(outside[i].size());
    std::memcpy(bytes->data(), outside[i].data(), outside[i].size());
    return true;
  }
  return false;
}

tl::expected<tinygltf::Model, Error> parse(PlainGltf& plain, const std::string& name) {
  std::string glb = joinGlb(plain);
  if (glb.size() > std::numeric_limits<std::uint32_t>::max()) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} bytes, a .glb holds at most {}. Split the scene.", name,
                              glb.size(), std::numeric_limits<std::uint32_t>::max()));
  }
  tinygltf::TinyGLTF reader;
  tinygltf::FsCallbacks files{};
  files.FileExists = outsideExists;
  files.ExpandFilePath = expandOutside;
  files.ReadWholeFile = readOutside;
  files.user_data = &plain.outside;
  reader.SetFsCallbacks(files);
  tinygltf::Model model;
  std::string wrong;
  std::string warnings;
  bool read = false;
  try {
    read = reader.LoadBinaryFromMemory(
        &model, &wrong, &warnings, reinterpret_cast<const unsigned char*>(glb.data()),
        static_cast<unsigned int>(glb.size()), "", tinygltf::NO_REQUIRE);
  } catch (const std::exception& thrown) {
    wrong = thrown.what();
  }
  if (!read) {
    return damaged(fmt::format("{}: tinygltf says {}. Export it again.", name, inQuotes(wrong)));
  }
  return model;
}

// ---------------------------------------------------------------------------------------------------
// From nodes to triangles.

/// The bytes of an accessor, known to lie in their buffer.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
  int component = 0;

  std::uint32_t index(std::size_t i) const {
    const unsigned char* at = first + i * stride;
    std::uint32_t value = 0;
    const std::size_t size = component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                             : component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                                                                                   : 4;
    for (std::size_t b = 0; b < size; ++b) value |= std::uint32_t{at[b]} << (8 * b);
    return value;
  }
  glm::vec3 position(std::size_t i) const {
    glm::vec3 result;
    for (int axis = 0; axis < 3; ++axis) {
      std::uint32_t bits = 0;
      const unsigned char* at = first + i * stride + 4 * static_cast<std::size_t>(axis);
      for (std::size_t b = 0; b < 4; ++b) bits |= std::uint32_t{at[b]} << (8 * b);
      std::memcpy(&result[axis], &bits, sizeof bits);
    }
    return result;
  }
};

tl::expected<Elements, Error> elementsOf(const tinygltf::Model& model, int index,
                                         std::size_t elementSize, const std::string& where) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const tinygltf::BufferView& view =
      model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const tinygltf::Buffer& buffer = model.buffers[static_cast<std::size_t>(view.buffer)];
  const std::size_t stride = view.byteStride == 0 ? elementSize : view.byteStride;
  const std::uint64_t viewEnd = std::uint64_t{view.byteOffset} + view.byteLength;
  if (viewEnd > buffer.data.size()) {
    return damaged(
        fmt::format("{}: its bufferView ends at byte {}, its buffer at {}. Export it again.", where,
                    viewEnd, buffer.data.size()));
  }
  const std::uint64_t end = std::uint64_t{accessor.byteOffset} +
                            std::uint64_t{stride} * (accessor.count - 1) + elementSize;
  if (stride < elementSize || end > view.byteLength) {
    return damaged(fmt::format(
        "{}: {} elements of {} bytes, {} apart from byte {}, need {} bytes, their "
        "bufferView has {}. Export it again.",
        where, accessor.count, elementSize, stride, accessor.byteOffset, end, view.byteLength));
  }
  return Elements{buffer.data.data() + view.byteOffset + accessor.byteOffset, stride,
                  accessor.count, accessor.componentType};
}

glm::dmat4 localTransform(const tinygltf::Node& node) {
  glm::dmat4 result(1.0);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return result;
  }
  if (node.rotation.size() == 4) {
    const glm::dquat turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = glm::length(turn);
    if (length > 0.0) result = glm::mat4_cast(turn / length);
  }
  if (node.scale.size() == 3) {
    for (int i = 0; i < 3; ++i) result[i] *= node.scale[static_cast<std::size_t>(i)];
  }
  if (node.translation.size() == 3) {
    result[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
  }
  return result;
}

/// The roots of the scene that is shown: the default, else the first, else every node without
/// parent.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  if (!model.scenes.empty()) {
    return model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))].nodes;
  }
  std::vector<bool> isChild(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) isChild[static_cast<std::size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (!isChild[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

/// Appends the triangles of one mesh, seen from its node.
tl::expected<void, Error> appendMesh(const tinygltf::Model& model, std::size_t meshIndex,
                                     std::size_t nodeIndex, const glm::dmat4& toScene,
                                     Scene& scene) {
  const bool mirrored = glm::determinant(glm::dmat3(toScene)) < 0.0;
  std::map<int, std::uint32_t> firstVertex;  // primitives often share their positions
  const tinygltf::Mesh& mesh = model.meshes[meshIndex];
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const tinygltf::Primitive& primitive = mesh.primitives[p];
    // The sieve leaves out primitives, so the number is that among the triangles.
    const std::string where = fmt::format("{}: mesh {} of node {}, triangle primitive {}",
                                          scene.name, meshIndex, nodeIndex, p);
    const int positionIndex = primitive.attributes.at("POSITION");
    const auto positions = elementsOf(model, positionIndex, 12, where + ", POSITION");
    if (!positions) return tl::unexpected(positions.error());
    Elements order;
    if (primitive.indices >= 0) {
      const int component =
          model.accessors[static_cast<std::size_t>(primitive.indices)].componentType;
      const std::size_t size = component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                               : component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                                                                                     : 4;
      const auto indices = elementsOf(model, primitive.indices, size, where + ", indices");
      if (!indices) return tl::unexpected(indices.error());
      order = *indices;
    }
    const std::size_t corners = primitive.indices >= 0 ? order.count : positions->count;
    const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    if (corners < 3 || (list && corners % 3 != 0)) {
      return damaged(fmt::format("{} has {} corners, {} is needed. Export it again.", where,
                                 corners, list ? "a multiple of 3" : "3 or more"));
    }
    const std::uint64_t triangles = list ? corners / 3 : corners - 2;
    if ((scene.triangles.size() + triangles) * 3 > kCornersMost ||
        scene.vertices.size() + positions->count > kCornersMost) {
      return refuse(ErrorCode::kTooLarge,
                    fmt::format("{}: the scene exceeds {} triangle corners or vertices. Split it.",
                                where, kCornersMost));
    }
    const auto [known, isNew] =
        firstVertex.emplace(positionIndex, static_cast<std::uint32_t>(scene.vertices.size()));
    for (std::size_t i = 0; isNew && i < positions->count; ++i) {
      const glm::vec3 read = positions->position(i);
      const glm::dvec3 placed(toScene * glm::dvec4(glm::dvec3(read), 1.0));
      const glm::dvec3 size = glm::abs(placed);
      constexpr double kMost = std::numeric_limits<float>::max();
      if (!(size.x <= kMost && size.y <= kMost && size.z <= kMost)) {
        return damaged(
            fmt::format("{}, POSITION {} is ({}, {}, {}), in the scene ({}, {}, {}): finite "
                        "numbers are needed. Export it again.",
                        where, i, read.x, read.y, read.z, placed.x, placed.y, placed.z));
      }
      scene.vertices.emplace_back(placed);
    }
    const auto vertexAt = [&](std::size_t corner) {
      return primitive.indices >= 0 ? order.index(corner) : static_cast<std::uint32_t>(corner);
    };
    for (std::size_t i = 0; i < corners; ++i) {
      if (vertexAt(i) >= positions->count) {
        return damaged(fmt::format("{}: index {} names vertex {}, there are {}. Export it again.",
                                   where, i, vertexAt(i), positions->count));
      }
    }
    for (std::size_t i = 0; i < triangles; ++i) {
      const std::size_t odd = i % 2;
      glm::uvec3 triangle =
          list ? glm::uvec3(vertexAt(3 * i), vertexAt(3 * i + 1), vertexAt(3 * i + 2))
          : primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP
              ? glm::uvec3(vertexAt(i), vertexAt(i + 1 + odd), vertexAt(i + 2 - odd))
              : glm::uvec3(vertexAt(i + 1), vertexAt(i + 2), vertexAt(0));
      if (mirrored) std::swap(triangle.y, triangle.z);
      scene.triangles.push_back(triangle + known->second);
    }
  }
  return {};
}

tl::expected<Scene, Error> collect(const tinygltf::Model& model, const std::string& name) {
  Scene scene;
  scene.name = name;
  struct Visit {
    int node;
    glm::dmat4 parentToScene;
  };
  std::vector<Visit> open;
  std::vector<int> roots = rootsOf(model);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root)
    open.push_back({*root, glm::dmat4(1.0)});
  if (roots.empty() && !model.nodes.empty() && model.scenes.empty()) {
    return damaged(
        fmt::format("{}: every node is a child of another, so none is the root. Export it "
                    "again.",
                    name));
  }
  std::vector<bool> seen(model.nodes.size(), false);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const auto index = static_cast<std::size_t>(visit.node);
    if (seen[index]) {
      return damaged(fmt::format(
          "{}: node {} is reached twice, nodes must form trees. Export it again.", name, index));
    }
    seen[index] = true;
    const tinygltf::Node& node = model.nodes[index];
    const glm::dmat4 toScene = visit.parentToScene * localTransform(node);
    if (node.mesh >= 0) {
      auto appended = appendMesh(model, static_cast<std::size_t>(node.mesh), index, toScene, scene);
      if (!appended) return tl::unexpected(appended.error());
    }
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      open.push_back({*child, toScene});
    }
  }
  return scene;
}

}  // namespace

tl::expected<Scene, Error> readGltf(std::span<const std::byte> bytes, SceneFormat format,
                                    const std::string& name,
                                    const std::optional<std::filesystem::path>& folder) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Chunks chunks{text, {}};
  if (format == SceneFormat::kGlb) {
    const auto split = splitGlb(text, name);
    if (!split) return tl::unexpected(split.error());
    chunks = *split;
  }
  Json file;
  try {
    file = Json::parse(chunks.json);
  } catch (const Json::exception& wrong) {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: ..." says where.
    const std::string_view what = wrong.what();
    const std::size_t start = what.find("] ");
    std::string said(what.substr(start == what.npos ? 0 : start + 2).substr(0, 160));
    for (char& c : said) c = c >= ' ' && c <= '~' ? c : '?';
    return damaged(fmt::format("{}: {}. Export it again.", name, said));
  }
  PlainGltf plain;
  plain.bin = chunks.bin;
  Sieve sieve(file, name, folder, plain);
  sieve.run();
  if (sieve.error) return tl::unexpected(*sieve.error);
  file = Json();  // its data URIs may be most of the memory
  const auto model = parse(plain, name);
  if (!model) return tl::unexpected(model.error());
  return collect(*model, name);
}

}  // namespace forewalk::navmesh
