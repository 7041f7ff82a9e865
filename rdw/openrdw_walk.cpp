#include "rdw/openrdw_walk.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "navmesh/file_text.h"
#include "rdw/openrdw_text.h"
#include "rdw/walk_limits.h"

namespace forewalk::rdw {
namespace {

tl::unexpected<Error> damaged(const std::string& name, std::size_t line, std::string_view what) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, fmt::format("{}:{}: {}", name, line, what)});
}

std::string_view textOf(std::span<const std::byte> bytes) {
  return withoutByteOrderMark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Of a value and the line it stands in.
template <typename Value>
struct Lined {
  Value value;
  std::size_t line;
};

tl::expected<std::vector<Lined<glm::dvec2>>, Error> readPoints(std::span<const std::byte> bytes,
                                                               const std::string& name) {
  std::vector<Lined<glm::dvec2>> points;
  Lines lines(textOf(bytes));
  std::string_view line;
  while (lines.next(line)) {
    if (isBlank(line)) continue;
    const auto point = readPoint(line);
    if (!point) {
      return damaged(name, lines.number(),
                     fmt::format("{} is no point, write x,y in metres.", inQuotes(line)));
    }
    if (std::max(std::abs(point->x), std::abs(point->y)) > kFarthestSample) {
      return damaged(name, lines.number(),
                     fmt::format("({}, {}) m lies farther out than {} m; are these metres?",
                                 point->x, point->y, kFarthestSample));
    }
    points.push_back({*point, lines.number()});
  }
  if (points.empty()) {
    return tl::unexpected(
        Error{ErrorCode::kSceneEmpty, name + ": no point in it, write a line x,y for each."});
  }
  return points;
}

tl::expected<std::vector<Lined<double>>, Error> readIntervals(std::span<const std::byte> bytes,
                                                              const std::string& name) {
  std::vector<Lined<double>> intervals;
  Lines lines(textOf(bytes));
  std::string_view line;
  while (lines.next(line)) {
    if (isBlank(line)) continue;
    const auto seconds = readNumber(line);
    // The first one leads to no point.
    if (!seconds || !(*seconds > 0.0 || intervals.empty())) {
      return damaged(name, lines.number(),
                     fmt::format("{} is no interval, write seconds above 0.", inQuotes(line)));
    }
    intervals.push_back({*seconds, lines.number()});
  }
  return intervals;
}

}  // namespace

tl::expected<std::vector<glm::dvec2>, Error> parseOpenRdwPath(std::span<const std::byte> bytes,
                                                              const std::string& name) {
  const auto points = readPoints(bytes, name);
  if (!points) return tl::unexpected(points.error());
  std::vector<glm::dvec2> path;
  path.reserve(points->size());
  for (const auto& point : *points) path.push_back(point.value);
  return path;
}

tl::expected<Walk, Error> parseOpenRdwWalk(std::span<const std::byte> path,
                                           const std::string& pathName,
                                           std::span<const std::byte> intervals,
                                           const std::string& timesName) {
  const auto points = readPoints(path, pathName);
  if (!points) return tl::unexpected(points.error());
  const auto steps = readIntervals(intervals, timesName);
  if (!steps) return tl::unexpected(steps.error());
  if (points->size() != steps->size() || points->size() < 2) {
    return tl::unexpected(Error{
        ErrorCode::kDataDamaged,
        fmt::format("{}: {} intervals for the {} points of {}; a walk has two or more points and "
                    "as many intervals.",
                    timesName, steps->size(), points->size(), pathName)});
  }
  Walk walk;
  walk.samples.reserve(points->size());
  double seconds = 0.0;
  for (std::size_t i = 0; i < points->size(); ++i) {
    const double before = seconds;
    if (i > 0) seconds += (*steps)[i].value;
    const WalkSample sample{seconds, (*points)[i].value};
    if (i > 0) {
      if (!(seconds > before) || seconds > kLongestWalk) {
        return damaged(timesName, (*steps)[i].line,
                       fmt::format("after {:.6g} s this walk is {:.6g} s long; time has to go on, "
                                   "for {} s at most: are these seconds?",
                                   before, seconds, kLongestWalk));
      }
      if (const auto problem = tooFast(walk.samples.back(), sample)) {
        return damaged(pathName, (*points)[i].line, "the walker " + *problem);
      }
    }
    walk.samples.push_back(sample);
  }
  return walk;
}

}  // namespace forewalk::rdw
