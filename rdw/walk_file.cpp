#include "rdw/walk_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <locale>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <string_view>

#include "navmesh/file_text.h"
#include "rdw/walk_limits.h"

namespace forewalk::rdw {
namespace {

constexpr double kJump = 0.5;              // metres; shorter steps are jitter, however quick
constexpr double kFastest = 12.0;          // m/s; nobody runs faster
constexpr double kHeadingWindow = 0.25;    // seconds to either side
constexpr double kHeadingDistance = 0.05;  // metres walked within the window that count as walking

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

void splitFields(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

/// Reads decimal numbers whatever the program's locale is.
class NumberReader {
 public:
  NumberReader() { stream_.imbue(std::locale::classic()); }

  std::optional<double> read(std::string_view text) {
    stream_.clear();
    stream_.str(std::string(text));
    double value = 0.0;
    if (!(stream_ >> value) || stream_.peek() != std::istringstream::traits_type::eof()) {
      return std::nullopt;
    }
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }

 private:
  std::istringstream stream_;
};

constexpr std::size_t kColumnCount = 4;
constexpr std::array<std::string_view, kColumnCount> kColumnNames{"t", "x", "z", "walker_id"};
enum Column : std::size_t { kT, kX, kZ, kWalkerId };
constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
using Columns = std::array<std::size_t, kColumnCount>;  // field of each column, or kAbsent

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

tl::expected<Columns, Error> readHeader(const std::vector<std::string_view>& fields,
                                        const std::string& name, std::size_t line,
                                        WalkTimes times) {
  Columns columns;
  columns.fill(kAbsent);
  for (std::size_t column = 0; column < kColumnCount; ++column) {
    for (std::size_t field = 0; field < fields.size(); ++field) {
      if (fields[field] != kColumnNames[column]) continue;
      if (columns[column] != kAbsent) {
        return damaged(fmt::format("{}:{}: the column {} is named twice; remove one.", name, line,
                                   kColumnNames[column]));
      }
      columns[column] = field;
    }
    const bool optional = column == kWalkerId || (column == kT && times == WalkTimes::kOptional);
    if (columns[column] == kAbsent && !optional) {
      return damaged(fmt::format(
          "{}:{}: the first line has no column {}; a walk has the columns walker_id,t,x,z or {} "
          "(seconds and metres).",
          name, line, kColumnNames[column], times == WalkTimes::kOptional ? "x,z" : "t,x,z"));
    }
  }
  return columns;
}

double turnBetween(double from, double to) {  // the shorter way, in [-pi, pi]
  return std::remainder(to - from, 2.0 * std::numbers::pi);
}

}  // namespace

std::optional<std::string> tooFast(const WalkSample& before, const WalkSample& sample) {
  const double moved = glm::distance(sample.plan, before.plan);
  const double elapsed = sample.seconds - before.seconds;
  if (!(moved > kJump && moved > kFastest * elapsed)) return std::nullopt;
  return fmt::format("moves {:.3g} m in {:.3g} s, faster than {} m/s; cut the recording there.",
                     moved, elapsed, kFastest);
}

tl::expected<std::vector<Walk>, Error> parseWalks(std::span<const std::byte> bytes,
                                                  const std::string& name, WalkTimes times) {
  Lines lines(withoutByteOrderMark({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  std::string_view line;
  std::vector<std::string_view> fields;
  do {
    if (!lines.next(line)) {
      return tl::unexpected(
          Error{ErrorCode::kSceneEmpty, fmt::format("{} is empty: no walk in it.", name)});
    }
  } while (trimmed(line).empty());
  splitFields(line, fields);
  const tl::expected<Columns, Error> columns = readHeader(fields, name, lines.number(), times);
  if (!columns) return tl::unexpected(columns.error());
  std::size_t fieldsNeeded = 0;
  for (const std::size_t field : *columns) {
    if (field != kAbsent) fieldsNeeded = std::max(fieldsNeeded, field + 1);
  }
  const bool timed = (*columns)[kT] != kAbsent;

  std::vector<Walk> walks;
  std::vector<std::size_t> lastLine;  // of each walk
  std::map<std::string, std::size_t, std::less<>> walkOf;
  NumberReader numbers;
  while (lines.next(line)) {
    if (trimmed(line).empty()) continue;
    splitFields(line, fields);
    if (fields.size() < fieldsNeeded) {
      return damaged(
          fmt::format("{}:{}: the row has {} fields, {} are needed; the file may end early.", name,
                      lines.number(), fields.size(), fieldsNeeded));
    }
    std::array<double, 3> values{};
    for (const Column column : {kT, kX, kZ}) {
      if (column == kT && !timed) continue;
      const std::string_view field = fields[(*columns)[column]];
      const std::optional<double> value = numbers.read(field);
      if (!value) {
        return damaged(fmt::format("{}:{}: {} is {}, not a finite number.", name, lines.number(),
                                   kColumnNames[column], inQuotes(field)));
      }
      if (column != kT && std::abs(*value) > kFarthestSample) {
        return damaged(fmt::format("{}:{}: {} is {} m, farther out than {} m; are these metres?",
                                   name, lines.number(), kColumnNames[column], *value,
                                   kFarthestSample));
      }
      values[column] = *value;
    }

    const std::string_view walker =
        (*columns)[kWalkerId] == kAbsent ? std::string_view{} : fields[(*columns)[kWalkerId]];
    auto found = walkOf.find(walker);
    if (found == walkOf.end()) {
      found = walkOf.emplace(std::string(walker), walks.size()).first;
      walks.push_back({std::string(walker), {}});
      lastLine.push_back(lines.number());
    }
    Walk& walk = walks[found->second];
    const double seconds = timed ? values[kT] : static_cast<double>(walk.samples.size());
    const WalkSample sample{seconds, {values[kX], -values[kZ]}};
    if (timed && !walk.samples.empty()) {
      const WalkSample& before = walk.samples.back();
      if (!(sample.seconds > before.seconds)) {
        return damaged(
            fmt::format("{}:{}: t is {} s, not after {} s in line {} of walker {}; sort the rows "
                        "by time and remove "
                        "repeated ones.",
                        name, lines.number(), sample.seconds, before.seconds,
                        lastLine[found->second], inQuotes(walker)));
      }
      if (sample.seconds - walk.samples.front().seconds > kLongestWalk) {
        return damaged(fmt::format(
            "{}:{}: t is {} s, {:.6g} s after walker {} began; a walk is {} s long at "
            "most: are these "
            "seconds?",
            name, lines.number(), sample.seconds, sample.seconds - walk.samples.front().seconds,
            inQuotes(walker), kLongestWalk));
      }
      if (const auto problem = tooFast(before, sample)) {
        return damaged(
            fmt::format("{}:{}: walker {} {}", name, lines.number(), inQuotes(walker), *problem));
      }
    }
    walk.samples.push_back(sample);
    lastLine[found->second] = lines.number();
  }

  if (walks.empty()) {
    return tl::unexpected(Error{ErrorCode::kSceneEmpty,
                                fmt::format("{} has a header and no row: no walk in it.", name)});
  }
  for (std::size_t i = 0; i < walks.size(); ++i) {
    if (walks[i].samples.size() < 2) {
      return damaged(fmt::format("{}:{}: walker {} has one row only; a walk needs two.", name,
                                 lastLine[i], inQuotes(walks[i].walker)));
    }
  }
  return walks;
}

std::vector<WalkFrame> resample(const Walk& walk, double rate) {
  assert(walk.samples.size() >= 2 && rate > 0.0);
  const std::vector<WalkSample>& samples = walk.samples;
  const double first = samples.front().seconds;
  const double duration = samples.back().seconds - first;
  // A hair is added so that the frame at the very end survives rounding.
  const std::size_t count = 1 + static_cast<std::size_t>(std::floor(duration * rate + 1e-6));

  std::vector<WalkFrame> frames(count);
  std::size_t next = 1;  // the first sample that is not before the frame
  for (std::size_t k = 0; k < count; ++k) {
    const double seconds = first + static_cast<double>(k) / rate;
    while (next + 1 < samples.size() && samples[next].seconds < seconds) ++next;
    const WalkSample& a = samples[next - 1];
    const WalkSample& b = samples[next];
    const double along = std::clamp((seconds - a.seconds) / (b.seconds - a.seconds), 0.0, 1.0);
    frames[k] = {a.plan + along * (b.plan - a.plan), 0.0};
  }

  const std::size_t window =
      static_cast<std::size_t>(std::max(1.0, std::round(kHeadingWindow * rate)));
  std::size_t known = count;  // the last frame whose motion gave a heading; count: none yet
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dvec2 moved =
        frames[std::min(k + window, count - 1)].plan - frames[k - std::min(k, window)].plan;
    if (glm::length(moved) < kHeadingDistance) continue;
    frames[k].heading = std::atan2(-moved.x, moved.y);
    const std::size_t gapStart = known == count ? 0 : known + 1;
    const double from = known == count ? frames[k].heading : frames[known].heading;
    const double turn = turnBetween(from, frames[k].heading);
    for (std::size_t i = gapStart; i < k; ++i) {
      const double part =
          static_cast<double>(i - gapStart + 1) / static_cast<double>(k - gapStart + 1);
      frames[i].heading = turnBetween(0.0, from + part * turn);
    }
    known = k;
  }
  if (known < count) {
    for (std::size_t i = known + 1; i < count; ++i) frames[i].heading = frames[known].heading;
  }
  return frames;
}

}  // namespace forewalk::rdw
