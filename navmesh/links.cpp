#include "navmesh/links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace forewalk::navmesh {
namespace {

tl::unexpected<Error> refused(ErrorCode code, const Link& link, const std::string& what) {
  return tl::unexpected(Error{code, fmt::format("link {}: {}", index(link.id), what)});
}

std::string placeText(glm::vec3 p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

bool isFinite(glm::vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

tl::unexpected<Error> offGround(const Link& link, const char* end, glm::vec3 place) {
  return refused(
      ErrorCode::kPositionOffNavMesh, link,
      fmt::format("its {} {} is more than {:g} m beside walkable ground, or {:g} m above or below "
                  "it. Move it onto the floor.",
                  end, placeText(place), kLinkSnap.distance, kLinkSnap.below));
}

auto orderOf(const LinkWay& way) {
  return std::tuple(way.from, way.entry.x, way.entry.y, way.to, way.exit.x, way.exit.y, way.length,
                    way.link, way.back);
}

LinkWay wayOf(const Link& link, const Location& from, const Location& to, bool back) {
  return {from.polygon, to.polygon,  from.plan, to.plan, from.height,
          to.height,    link.length, link.id,   back};
}

}  // namespace

tl::expected<void, Error> validate(const Link& link) {
  for (const auto& [end, place] : {std::pair("entry", link.entry), std::pair("exit", link.exit)}) {
    if (isFinite(place)) continue;
    return refused(ErrorCode::kDataDamaged, link,
                   fmt::format("its {} is {}, give finite metres.", end, placeText(place)));
  }
  if (!(link.length >= 0.0f && link.length <= kLongestLink)) {
    return refused(ErrorCode::kSettingOutOfRange, link,
                   fmt::format("a length of {:g} m cannot work: give 0 to {:g} m.", link.length,
                               kLongestLink));
  }
  return {};
}

tl::expected<Links, Error> makeLinks(const NavGraph& graph, const LocationIndex& locations,
                                     std::span<const Link> links, std::vector<LinkId>* groundless) {
  std::vector<LinkId> ids;
  Links made;
  for (const Link& link : links) {
    if (auto valid = validate(link); !valid) return tl::unexpected(valid.error());
    ids.push_back(link.id);
    const auto entry = locate(graph, locations, link.entry, kLinkSnap);
    const auto exit = locate(graph, locations, link.exit, kLinkSnap);
    if (!entry || !exit) {
      if (groundless == nullptr) {
        return entry ? offGround(link, "exit", link.exit) : offGround(link, "entry", link.entry);
      }
      groundless->push_back(link.id);
      continue;
    }
    const bool nowhere = entry->polygon == exit->polygon && entry->plan == exit->plan;
    if (!link.open || nowhere) continue;
    made.ways.push_back(wayOf(link, *entry, *exit, false));
    if (link.bothWays) made.ways.push_back(wayOf(link, *exit, *entry, true));
  }
  if (groundless != nullptr) std::sort(groundless->begin(), groundless->end());
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice != ids.end()) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("link {} is given twice. Give each an id of its own.", index(*twice))});
  }
  if (made.ways.empty()) return made;
  std::sort(made.ways.begin(), made.ways.end(),
            [](const LinkWay& a, const LinkWay& b) { return orderOf(a) < orderOf(b); });
  made.wayStart.assign(graph.polygonCount() + 1, 0);
  for (const LinkWay& way : made.ways) ++made.wayStart[index(way.from) + 1];
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    if (made.wayStart[p + 1] > kMostLinkWays) {
      return tl::unexpected(
          Error{ErrorCode::kTooLarge,
                fmt::format("{} ways by links lead out of polygon {}, {} are the limit. Spread "
                            "their ends.",
                            made.wayStart[p + 1], p, kMostLinkWays)});
    }
    made.wayStart[p + 1] += made.wayStart[p];
  }
  return made;
}

}  // namespace forewalk::navmesh
