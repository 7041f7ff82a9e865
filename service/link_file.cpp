#include "service/link_file.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "navmesh/file_text.h"
#include "rdw/json_text.h"
#include "service/files.h"

namespace forewalk::service {
namespace {

using Json = nlohmann::json;
using navmesh::Link;

constexpr std::string_view kFormat = "forewalk.links/1";
constexpr std::size_t kMostLinks = 100000;

tl::unexpected<Error> refused(ErrorCode code, std::string_view name, const std::string& what) {
  return tl::unexpected(Error{code, fmt::format("{}: {}", name, what)});
}

bool readPlace(const Json& json, glm::vec3& place) {
  if (!json.is_array() || json.size() != 3) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const Json& number = json[static_cast<std::size_t>(axis)];
    if (!number.is_number()) return false;
    place[axis] = number.get<float>();
  }
  return true;
}

/// Puts one field where it belongs. What it must be, where it is not; empty where all is well.
std::string readField(const std::string& field, const Json& value, Link& link) {
  if (field == "id") {
    if (!value.is_number_unsigned() ||
        value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
      return "\"id\" must be a whole number from 0 to 4294967295";
    }
    link.id = navmesh::LinkId{value.get<std::uint32_t>()};
  } else if (field == "entry" || field == "exit") {
    if (!readPlace(value, field == "entry" ? link.entry : link.exit)) {
      return fmt::format("\"{}\" must be three numbers [x, y, z], in metres", field);
    }
  } else if (field == "length") {
    if (!value.is_number()) return "\"length\" must be a number, in metres";
    link.length = value.get<float>();
  } else if (field == "both_ways" || field == "open") {
    if (!value.is_boolean()) return fmt::format("\"{}\" must be true or false", field);
    (field == "open" ? link.open : link.bothWays) = value.get<bool>();
  } else if (field == "name") {
    if (!value.is_string()) return "\"name\" must be text";
  } else {
    return fmt::format("there is no field {}; remove it or correct its name", inQuotes(field));
  }
  return "";
}

}  // namespace

tl::expected<std::vector<Link>, Error> parseLinks(std::string_view text, std::string_view name) {
  const auto json = rdw::parseJson(text, name);
  if (!json) return tl::unexpected(json.error());
  if (!json->is_object() || !json->contains("format") || (*json)["format"] != kFormat) {
    return refused(ErrorCode::kFormatUnsupported, name,
                   fmt::format("this is no object with \"format\": \"{}\".", kFormat));
  }
  for (const auto& [field, value] : json->items()) {
    if (field == "format" || field == "links") continue;
    return refused(
        ErrorCode::kDataDamaged, name,
        fmt::format("there is no field {}; remove it or correct its name.", inQuotes(field)));
  }
  const auto list = json->find("links");
  if (list == json->end() || !list->is_array()) {
    return refused(ErrorCode::kDataDamaged, name, "\"links\" must be a list.");
  }
  if (list->size() > kMostLinks) {
    return refused(ErrorCode::kTooLarge, name,
                   fmt::format("{} links, {} are the limit.", list->size(), kMostLinks));
  }
  std::vector<Link> links;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Json& one = (*list)[i];
    if (!one.is_object()) {
      return refused(ErrorCode::kDataDamaged, name, fmt::format("links[{}] is no object.", i));
    }
    Link link;
    for (const auto& [field, value] : one.items()) {
      if (const std::string wrong = readField(field, value, link); !wrong.empty()) {
        return refused(ErrorCode::kDataDamaged, name, fmt::format("links[{}]: {}.", i, wrong));
      }
    }
    for (const char* needed : {"id", "entry", "exit", "length"}) {
      if (one.contains(needed)) continue;
      return refused(ErrorCode::kDataDamaged, name,
                     fmt::format("links[{}] has no \"{}\".", i, needed));
    }
    if (auto valid = navmesh::validate(link); !valid) {
      return refused(valid.error().code, name, valid.error().message);
    }
    links.push_back(link);
  }
  return links;
}

tl::expected<std::vector<Link>, Error> readLinks(const std::filesystem::path& file) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return parseLinks({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file.string());
}

}  // namespace forewalk::service
