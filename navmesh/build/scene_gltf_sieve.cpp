#include "navmesh/build/scene_gltf_sieve.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kIntMost = std::numeric_limits<std::int32_t>::max();  // tinygltf's indices
constexpr std::int64_t kBytesMost = std::int64_t{1} << 33;

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

/// The bytes that %20 and its like stand for.
std::string percentDecoded(std::string_view uri) {
  const auto digit = [&](std::size_t at) {
    const char c = at < uri.size() ? uri[at] : '\0';
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string decoded;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0) {
      decoded += static_cast<char>(digit(i + 1) * 16 + digit(i + 2));
      i += 2;
    } else {
      decoded += uri[i];
    }
  }
  return decoded;
}

/// The file that a URI names, relative to the .gltf's folder; none where it would lie elsewhere.
std::optional<std::filesystem::path> pathBeside(std::string_view uri) {
  const std::string decoded = percentDecoded(uri);
  const std::filesystem::path relative = std::filesystem::path(decoded).lexically_normal();
  const bool inside = !decoded.empty() && relative.is_relative() &&
                      decoded.find_first_of(std::string_view(":\\\0", 3)) == std::string::npos &&
                      *relative.begin() != "..";
  if (!inside) return std::nullopt;
  return relative;
}

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
      fail(high < low ? fmt::format("{} has {} {}, there is none", where, key, shown(*found))
                      : fmt::format("{} has {} {}, a whole number from {} to {} is needed", where,
                                    key, shown(*found), low, high));
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
    plain["attributes"]["POSITION"] = passPositions(*attributes, where);
    if (primitive.contains("indices")) plain["indices"] = passIndices(primitive, where);
    if (!error) primitives.push_back(std::move(plain));
  }

  /// Elements of one of the file's lists that something needs, and their new indices.
  struct Passed {
    const char* list;
    const char* noun;
    std::map<std::int64_t, std::int64_t> known = {};
  };

  /// Passes the element that member `key` of `user` names, once; its new index. `copy(element,
  /// index, plain)` fills in what tinygltf gets of it.
  template <typename Copy>
  std::int64_t pass(Passed& passed, const Json& user, const char* key, const std::string& userWhere,
                    const Copy& copy) {
    const Json& elements = list(passed.list);
    const std::int64_t index = integer(user, key, userWhere, 0, count(elements) - 1, std::nullopt);
    if (error) return 0;
    if (const auto known = passed.known.find(index); known != passed.known.end()) {
      return known->second;
    }
    const Json& element = elements[static_cast<std::size_t>(index)];
    const std::string where = fmt::format("{} {}", passed.noun, index);
    if (!isObject(element, where)) return 0;
    Json plain = Json::object();
    copy(element, index, where, plain);
    if (error) return 0;
    Json& array = out_.json[passed.list];
    array.push_back(std::move(plain));
    return passed.known[index] = count(array) - 1;
  }

  std::int64_t passPositions(const Json& attributes, const std::string& userWhere) {
    return passAccessor(positions_, attributes, "POSITION", userWhere);
  }

  std::int64_t passIndices(const Json& primitive, const std::string& userWhere) {
    return passAccessor(indices_, primitive, "indices", userWhere);
  }

  std::int64_t passAccessor(Passed& role, const Json& user, const char* key,
                            const std::string& userWhere) {
    return pass(role, user, key, userWhere,
                [&](const Json& accessor, std::int64_t, const std::string& noun, Json& plain) {
                  const std::string where = fmt::format("{} ({} of {})", noun, key, userWhere);
                  checkStorage(accessor, where);
                  checkType(accessor, where, &role == &positions_, plain);
                  plain["count"] = integer(accessor, "count", where, 1, kIntMost, std::nullopt);
                  plain["byteOffset"] = integer(accessor, "byteOffset", where, 0, kBytesMost, 0);
                  plain["bufferView"] = passBufferView(accessor, where);
                });
  }

  void checkStorage(const Json& accessor, const std::string& where) {
    if (accessor.contains("sparse")) {
      return fail(ErrorCode::kFormatUnsupported,
                  where + " is sparse, which is not read. Export it without sparse accessors.");
    }
    if (!accessor.contains("bufferView")) {
      fail(ErrorCode::kFormatUnsupported,
           where +
               " has no bufferView: compressed or empty meshes are not read. Export it without "
               "mesh compression.");
    }
  }

  void checkType(const Json& accessor, const std::string& where, bool positions, Json& plain) {
    const std::int64_t component =
        integer(accessor, "componentType", where, 5120, 5130, std::nullopt);
    const std::string type = accessor.contains("type") && accessor["type"].is_string()
                                 ? accessor["type"].get<std::string>()
                                 : std::string("missing");
    if (error) return;
    if (positions && component >= TINYGLTF_COMPONENT_TYPE_BYTE &&
        component <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
      return fail(ErrorCode::kFormatUnsupported,
                  fmt::format("{} holds integers (componentType {}): the extension "
                              "KHR_mesh_quantization is not read. Export positions as float.",
                              where, component));
    }
    const bool fits =
        positions ? type == "VEC3" && component == TINYGLTF_COMPONENT_TYPE_FLOAT
                  : type == "SCALAR" && (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                         component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                         component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    if (!fits) {
      return fail(fmt::format(
          "{} has type {} and componentType {}, {} is needed", where, inQuotes(type), component,
          positions ? "VEC3 of float (5126)"
                    : "SCALAR of unsigned byte, short or int (5121, 5123, 5125)"));
    }
    plain["componentType"] = component;
    plain["type"] = type;
  }

  std::int64_t passBufferView(const Json& accessor, const std::string& userWhere) {
    return pass(
        views_, accessor, "bufferView", userWhere,
        [&](const Json& view, std::int64_t, const std::string& where, Json& plain) {
          plain["byteOffset"] = integer(view, "byteOffset", where, 0, kBytesMost, 0);
          plain["byteLength"] = integer(view, "byteLength", where, 1, kBytesMost, std::nullopt);
          if (view.contains("byteStride")) {
            const std::int64_t stride = integer(view, "byteStride", where, 4, 252, std::nullopt);
            if (stride % 4 != 0)
              fail(fmt::format("{} has byteStride {}, a multiple of 4 is needed", where, stride));
            plain["byteStride"] = stride;
          }
          plain["buffer"] = passBuffer(view, where);
        });
  }

  std::int64_t passBuffer(const Json& view, const std::string& userWhere) {
    return pass(buffers_, view, "buffer", userWhere,
                [&](const Json& buffer, std::int64_t index, const std::string& where, Json& plain) {
                  const std::int64_t length =
                      integer(buffer, "byteLength", where, 1, kBytesMost, std::nullopt);
                  plain["byteLength"] = length;
                  const auto uri = buffer.find("uri");
                  if (error) return;
                  if (uri == buffer.end()) {
                    checkBinaryChunk(index, length, where);
                  } else if (!uri->is_string()) {
                    fail(fmt::format("{} has uri {}, a text is needed", where, shown(*uri)));
                  } else if (uri->get_ref<const std::string&>().starts_with("data:")) {
                    plain["uri"] = *uri;
                  } else {
                    plain["uri"] = readOutside(uri->get_ref<const std::string&>(),
                                               static_cast<std::size_t>(length), where);
                  }
                });
  }

  void checkBinaryChunk(std::int64_t buffer, std::int64_t length, const std::string& where) {
    if (buffer != 0 || out_.bin.empty()) {
      return fail(where + " has no uri, and there is no binary chunk for it");
    }
    if (static_cast<std::uint64_t>(length) > out_.bin.size()) {
      fail(fmt::format("{} has byteLength {}, the binary chunk has {} bytes", where, length,
                       out_.bin.size()));
    }
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
    const auto relative = pathBeside(uri);
    if (!relative) {
      fail(ErrorCode::kFormatUnsupported,
           fmt::format(
               "{} names {}, only files in the folder of the .gltf are read. Put it beside the "
               ".gltf.",
               where, inQuotes(uri)));
      return {};
    }
    auto bytes = readBytes(*folder_ / *relative);
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
    return outsideUri(out_.outside.size() - 1);
  }

  const Json& file_;
  const std::string& name_;
  const std::optional<std::filesystem::path>& folder_;
  PlainGltf& out_;
  // An accessor may be named as both, and then is wrong as one of them.
  Passed positions_{"accessors", "accessor"}, indices_{"accessors", "accessor"};
  Passed views_{"bufferViews", "bufferView"}, buffers_{"buffers", "buffer"};
};

}  // namespace

std::string outsideUri(std::size_t i) { return fmt::format("outside{}", i); }

tl::expected<PlainGltf, Error> sieveGltf(const Json& file, std::string_view bin,
                                         const std::string& name,
                                         const std::optional<std::filesystem::path>& folder) {
  PlainGltf plain;
  plain.bin = bin;
  Sieve sieve(file, name, folder, plain);
  sieve.run();
  if (sieve.error) return tl::unexpected(*sieve.error);
  return plain;
}

}  // namespace forewalk::navmesh
