// The two files that a tracked space is read from: ours, and OpenRDW's text.
#include "rdw/tracked_space_file.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "navmesh/file_text.h"
#include "rdw/json_text.h"
#include "rdw/openrdw_text.h"
#include "rdw/room_shapes.h"

namespace forewalk::rdw {
namespace {

using Json = nlohmann::json;
using Ring = std::vector<glm::dvec2>;

constexpr std::string_view kName = "tracked space";
constexpr std::string_view kFormat = "forewalk.space/1";

tl::unexpected<Error> refused(ErrorCode code, std::string_view what) {
  return tl::unexpected(Error{code, fmt::format("{}: {}", kName, what)});
}

tl::unexpected<Error> refusedAt(std::size_t line, ErrorCode code, std::string_view what) {
  return tl::unexpected(Error{code, fmt::format("{}:{}: {}", kName, line, what)});
}

// ---- JSON

tl::unexpected<Error> otherFormat(std::string_view found) {
  return refused(ErrorCode::kFormatUnsupported,
                 fmt::format("its \"format\" is {}, \"{}\" is read.", found, kFormat));
}

tl::unexpected<Error> wrongShape(std::string_view field, std::string_view shape) {
  return refused(ErrorCode::kDataDamaged,
                 fmt::format("\"{}\" must be {}, in metres.", field, shape));
}

bool readPair(const Json& json, glm::dvec2& pair) {
  if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
    return false;
  pair = {json[0].get<double>(), json[1].get<double>()};
  return true;
}

tl::expected<Ring, Error> readRing(const Json& json, std::string_view field) {
  if (!json.is_array()) return wrongShape(field, "a list of corners [x, z]");
  if (json.size() > TrackedSpace::kMostCorners) {
    return refused(ErrorCode::kTooLarge,
                   fmt::format("\"{}\" has {} corners, {} are the limit.", field, json.size(),
                               TrackedSpace::kMostCorners));
  }
  Ring ring;
  for (std::size_t i = 0; i < json.size(); ++i) {
    glm::dvec2 xz;
    if (!readPair(json[i], xz)) {
      return refused(
          ErrorCode::kDataDamaged,
          fmt::format("corner {} of \"{}\" must be two numbers [x, z], in metres.", i, field));
    }
    ring.push_back({xz.x, -xz.y});
  }
  return ring;
}

tl::expected<TrackedSpace, Error> polygonFromJson(const Json& border, const Json* holes) {
  const auto outer = readRing(border, "polygon");
  if (!outer) return tl::unexpected(outer.error());
  std::vector<Ring> inner;
  if (holes != nullptr) {
    constexpr std::size_t kMostHoles = TrackedSpace::kMostCorners / 3;
    if (!holes->is_array() || holes->size() > kMostHoles) {
      return wrongShape("holes", fmt::format("a list of at most {} rings", kMostHoles));
    }
    for (const Json& hole : *holes) {
      auto ring = readRing(hole, "holes");
      if (!ring) return tl::unexpected(ring.error());
      inner.push_back(std::move(*ring));
    }
  }
  return TrackedSpace::polygon(*outer, inner);
}

// ---- OpenRDW's text

/// A room of OpenRDW 2: what stands between two of its separators.
bool isSeparator(std::string_view line, std::size_t length) {
  const std::size_t first = line.find_first_not_of(" \t\r\v\f");
  if (first == std::string_view::npos) return false;
  const std::size_t last = line.find_last_not_of(" \t\r\v\f");
  return last - first + 1 == length && line.find(',') == std::string_view::npos;
}

/// The lines of the first physical room of OpenRDW 2's text, which begins with a number of users:
/// the virtual space and its obstacles, a line of two characters, the room and its obstacles, a
/// line of one, the users. Moves `lines` to the room; false where there is none.
bool skipToRoom(Lines& lines) {
  std::string_view line;
  while (lines.next(line)) {
    if (isSeparator(line, 2)) return true;
  }
  return false;
}

}  // namespace

tl::expected<TrackedSpace, Error> spaceFromJson(const Json& json) {
  const auto find = [&](const char* field) {
    const auto found = json.find(field);
    return found == json.end() ? nullptr : &*found;
  };
  const Json* format = find("format");
  if (format != nullptr && *format != kFormat) {
    return otherFormat(format->is_string() ? inQuotes(format->get_ref<const std::string&>())
                                           : "no text");
  }
  const Json* rectangle = find("rectangle");
  const Json* circle = find("circle");
  const Json* polygon = find("polygon");
  const Json* holes = find("holes");
  const Json* shape = find("shape");
  const Json* area = find("area_m2");
  const int shapes =
      (rectangle != nullptr) + (circle != nullptr) + (polygon != nullptr) + (shape != nullptr);
  if (shapes != 1) {
    return refused(
        ErrorCode::kDataDamaged,
        fmt::format("names {} shapes, give one of \"rectangle\", \"circle\", \"polygon\", "
                    "\"shape\".",
                    shapes));
  }
  if (holes != nullptr && polygon == nullptr) {
    return refused(ErrorCode::kDataDamaged,
                   "\"holes\" needs \"polygon\": give the border as corners.");
  }
  if (area != nullptr && shape == nullptr) {
    return refused(ErrorCode::kDataDamaged, "\"area_m2\" needs \"shape\": name one.");
  }
  if (polygon != nullptr) return polygonFromJson(*polygon, holes);
  if (shape != nullptr) {
    if (!shape->is_string()) return wrongShape("shape", "a name");
    if (area == nullptr || !area->is_number())
      return wrongShape("area_m2", "a number, the floor of the shape");
    return roomShape(shape->get_ref<const std::string&>(), area->get<double>());
  }
  if (circle != nullptr) {
    if (!circle->is_number()) return wrongShape("circle", "a number, its radius");
    return TrackedSpace::circle(circle->get<double>());
  }
  glm::dvec2 sides;
  if (!readPair(*rectangle, sides)) return wrongShape("rectangle", "two numbers [width, depth]");
  return TrackedSpace::rectangle(sides.x, sides.y);
}

tl::expected<TrackedSpace, Error> TrackedSpace::fromJson(std::string_view text) {
  const auto json = parseJson(text, kName);
  if (!json) return tl::unexpected(json.error());
  if (!json->is_object()) {
    return refused(ErrorCode::kFormatUnknown,
                   fmt::format("expected an object {{\"format\": \"{}\", ...}}.", kFormat));
  }
  if (!json->contains("format")) return otherFormat("missing");
  return spaceFromJson(*json);
}

tl::expected<TrackedSpace, Error> TrackedSpace::fromOpenRdw(std::string_view text) {
  std::vector<Ring> rings(1);
  std::size_t corners = 0;
  Lines lines(withoutByteOrderMark(text));
  std::string_view line;
  bool isFirst = true, isSecondForm = false;
  while (lines.next(line)) {
    if (isBlank(line)) {
      if (!rings.back().empty()) rings.emplace_back();
      continue;
    }
    if (std::exchange(isFirst, false) && readNumber(line)) {
      isSecondForm = true;
      if (!skipToRoom(lines)) {
        return refused(ErrorCode::kDataDamaged,
                       "begins with a number of users, as OpenRDW 2's do, but no line of two "
                       "characters, such as //, begins a room after it.");
      }
      continue;
    }
    if (isSecondForm && (isSeparator(line, 1) || isSeparator(line, 2))) break;
    const auto corner = readPoint(line);
    if (!corner) {
      return refusedAt(lines.number(), ErrorCode::kDataDamaged,
                       fmt::format("{} is not a corner, write x,y in metres.", inQuotes(line)));
    }
    if (++corners > kMostCorners) {
      return refusedAt(lines.number(), ErrorCode::kTooLarge,
                       fmt::format("more than {} corners. Simplify its border.", kMostCorners));
    }
    rings.back().push_back(*corner);
  }
  if (rings.back().empty()) rings.pop_back();
  if (rings.empty()) {
    return refused(ErrorCode::kDataDamaged, "no corner in the text, write a line x,y for each.");
  }
  return polygon(rings[0], std::span<const Ring>(rings).subspan(1));
}

tl::expected<TrackedSpace, Error> TrackedSpace::read(std::string_view text) {
  text = withoutByteOrderMark(text);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{' ? fromJson(text) : fromOpenRdw(text);
}

}  // namespace forewalk::rdw
