#include "agents/locomotion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace forewalk::agents {
namespace {

constexpr float kSlowestReplay = 0.3f, kFastestReplay = 1.2f;

tl::unexpected<Error> outOfRange(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

// In double precision: products of differences of floats.
struct Point {
  double x, y;
};

Point pointOf(Command motion) {
  return {static_cast<double>(motion.linear), static_cast<double>(motion.angular)};
}

double area(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double distance(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }

std::uint32_t farthestFrom(Point from, std::span<const MotionClip> clips) {
  std::uint32_t farthest = 0;
  for (std::uint32_t c = 1; c < clips.size(); ++c) {
    if (distance(from, pointOf(clips[c].motion)) >
        distance(from, pointOf(clips[farthest].motion))) {
      farthest = c;
    }
  }
  return farthest;
}

std::optional<std::string> fault(std::span<const MotionClip> clips) {
  if (clips.empty()) return "there are no motion clips: give one or more.";
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const Command motion = clips[c].motion;
    if (!std::isfinite(motion.linear) || motion.linear < 0.0f) {
      return fmt::format("motion clip {} (\"{}\") walks at {} m/s: it has to be 0 m/s or more.", c,
                         clips[c].name, motion.linear);
    }
    if (!std::isfinite(motion.angular)) {
      return fmt::format("motion clip {} (\"{}\") turns at {} rad/s: it has to be finite.", c,
                         clips[c].name, motion.angular);
    }
  }
  return std::nullopt;
}

std::optional<std::string> fault(std::span<const MotionClip> clips,
                                 std::span<const ClipTriangle> triangles) {
  for (const ClipTriangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= clips.size()) {
        return fmt::format("a triangle of motion clips names clip {}, there are {}.", corner,
                           clips.size());
      }
    }
    if (area(pointOf(clips[triangle[0]].motion), pointOf(clips[triangle[1]].motion),
             pointOf(clips[triangle[2]].motion)) == 0.0) {
      return fmt::format("motion clips {}, {} and {} are a triangle without area.", triangle[0],
                         triangle[1], triangle[2]);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::vector<std::uint32_t>> chainOf(std::span<const MotionClip> clips) {
  const double tolerance = static_cast<double>(kClipTolerance);
  Point begin = pointOf(clips[farthestFrom(pointOf(clips[0].motion), clips)].motion);
  Point end = pointOf(clips[farthestFrom(begin, clips)].motion);
  // From slow to fast, from right to left.
  if (end.x < begin.x || (end.x == begin.x && end.y < begin.y)) std::swap(begin, end);
  const double length = distance(begin, end);
  if (length <= tolerance) return std::vector<std::uint32_t>{0};
  std::vector<std::pair<double, std::uint32_t>> along;
  for (std::uint32_t c = 0; c < clips.size(); ++c) {
    const Point p = pointOf(clips[c].motion);
    if (std::abs(area(begin, end, p)) > tolerance * length) return std::nullopt;
    along.emplace_back(
        ((p.x - begin.x) * (end.x - begin.x) + (p.y - begin.y) * (end.y - begin.y)) / length, c);
  }
  std::sort(along.begin(), along.end());
  std::vector<std::uint32_t> chain;
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& [place, clip] : along) {
    if (place - last > tolerance) {
      chain.push_back(clip);
      last = place;
    }
  }
  return chain;
}

tl::expected<LocomotionDatabase, Error> LocomotionDatabase::make(
    std::vector<MotionClip> clips, std::vector<ClipTriangle> triangles) {
  if (auto wrong = fault(clips)) return outOfRange(std::move(*wrong));
  if (auto wrong = fault(clips, triangles)) return outOfRange(std::move(*wrong));
  LocomotionDatabase database;
  if (triangles.empty()) {
    auto chain = chainOf(clips);
    if (!chain) {
      return outOfRange(
          fmt::format("{} motion clips have no triangles and do not lie on one line. Triangulate "
                      "them first.",
                      clips.size()));
    }
    database.chain_ = std::move(*chain);
  }
  database.lowest_ = database.highest_ = clips.front().motion;
  for (std::uint32_t c = 0; c < clips.size(); ++c) {
    const Command motion = clips[c].motion;
    database.lowest_.linear = std::min(database.lowest_.linear, motion.linear);
    database.lowest_.angular = std::min(database.lowest_.angular, motion.angular);
    database.highest_.linear = std::max(database.highest_.linear, motion.linear);
    database.highest_.angular = std::max(database.highest_.angular, motion.angular);
    if (distance(pointOf(motion), {0.0, 0.0}) <
        distance(pointOf(clips[database.neutral_].motion), {0.0, 0.0})) {
      database.neutral_ = c;
    }
  }
  // The hull's edges belong to one triangle only.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const ClipTriangle& triangle : triangles) {
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t a = triangle[static_cast<std::size_t>(side)];
      const std::uint32_t b = triangle[static_cast<std::size_t>((side + 1) % 3)];
      edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const bool again =
        (e > 0 && edges[e - 1] == edges[e]) || (e + 1 < edges.size() && edges[e + 1] == edges[e]);
    if (again) continue;
    Edge edge{clips[edges[e].first].motion, clips[edges[e].second].motion};
    // From slow to fast, so that mirrored clips give mirrored limits to the last bit.
    if (edge.low.linear > edge.high.linear) std::swap(edge.low, edge.high);
    database.hull_.push_back(edge);
  }
  database.clips_ = std::move(clips);
  database.triangles_ = std::move(triangles);
  return database;
}

std::pair<float, float> LocomotionDatabase::angularAt(float linear) const {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  const auto add = [&](float angular) {
    low = std::min(low, angular);
    high = std::max(high, angular);
  };
  const auto along = [&](Command a, Command b) {
    if (linear < a.linear || linear > b.linear) return;
    if (a.linear == b.linear) {
      add(a.angular);
      add(b.angular);
      return;
    }
    const float share = (linear - a.linear) / (b.linear - a.linear);
    add(a.angular + share * (b.angular - a.angular));
  };
  for (const Edge& edge : hull_) along(edge.low, edge.high);
  for (std::size_t c = 0; c + 1 < chain_.size(); ++c) {
    Command a = clips_[chain_[c]].motion, b = clips_[chain_[c + 1]].motion;
    if (a.linear > b.linear) std::swap(a, b);
    along(a, b);
  }
  if (chain_.size() == 1) along(clips_[chain_[0]].motion, clips_[chain_[0]].motion);
  return {low, high};
}

Command LocomotionDatabase::alongChain(float share) const {
  const auto motion = [&](std::size_t c) { return clips_[chain_[c]].motion; };
  const Point begin = pointOf(motion(0)), end = pointOf(motion(chain_.size() - 1));
  const double s = static_cast<double>(share);
  return {static_cast<float>(begin.x + s * (end.x - begin.x)),
          static_cast<float>(begin.y + s * (end.y - begin.y))};
}

std::optional<ClipBlend> LocomotionDatabase::blend(Command motion) const {
  const Point p = pointOf(motion);
  const double tolerance = static_cast<double>(kClipTolerance);
  if (chain_.size() == 1) {
    if (distance(p, pointOf(clips_[chain_[0]].motion)) > tolerance) return std::nullopt;
    return ClipBlend{{chain_[0], chain_[0], chain_[0]}, {1.0f, 0.0f, 0.0f}};
  }
  for (std::size_t c = 0; c + 1 < chain_.size(); ++c) {
    const Point a = pointOf(clips_[chain_[c]].motion), b = pointOf(clips_[chain_[c + 1]].motion);
    const double length = distance(a, b);
    const double along = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
    const bool last = c + 2 == chain_.size();
    if (along < -tolerance || (along > length && !last)) continue;
    if (along > length + tolerance || std::abs(area(a, b, p)) > 2.0 * tolerance * length) {
      return std::nullopt;
    }
    const float share = static_cast<float>(std::clamp(along / length, 0.0, 1.0));
    return ClipBlend{{chain_[c], chain_[c + 1], chain_[c]}, {1.0f - share, share, 0.0f}};
  }
  // The triangle that the motion lies deepest in; on a common edge, the first.
  std::optional<ClipBlend> best;
  double deepest = -std::numeric_limits<double>::infinity();
  for (const ClipTriangle& triangle : triangles_) {
    const Point a = pointOf(clips_[triangle[0]].motion), b = pointOf(clips_[triangle[1]].motion),
                c = pointOf(clips_[triangle[2]].motion);
    const double whole = area(a, b, c);
    const double weights[3] = {area(b, c, p) / whole, area(c, a, p) / whole, area(a, b, p) / whole};
    const Point corners[3] = {a, b, c};
    double depth =
        std::numeric_limits<double>::infinity();  // below 0: metres, so to speak, outside
    for (std::size_t w = 0; w < 3; ++w) {
      const double side = distance(corners[(w + 1) % 3], corners[(w + 2) % 3]);
      depth = std::min(depth, weights[w] * std::abs(whole) / side);
    }
    if (depth < -tolerance || depth <= deepest) continue;
    deepest = depth;
    double kept[3], sum = 0.0;
    for (std::size_t w = 0; w < 3; ++w) sum += kept[w] = std::max(0.0, weights[w]);
    best = ClipBlend{triangle, {}};
    for (std::size_t w = 0; w < 3; ++w) best->weight[w] = static_cast<float>(kept[w] / sum);
  }
  return best;
}

Command LocomotionDatabase::motionOf(const ClipBlend& blend) const {
  Command sum;
  for (std::size_t w = 0; w < 3; ++w) {
    sum.linear += blend.weight[w] * clips_[blend.clip[w]].motion.linear;
    sum.angular += blend.weight[w] * clips_[blend.clip[w]].motion.angular;
  }
  return sum;
}

std::shared_ptr<const LocomotionDatabase> builtInClips() {
  static const std::shared_ptr<const LocomotionDatabase> database = [] {
    std::vector<MotionClip> clips = {
        {"stand", {0.0f, 0.0f}},
        {"turn left", {0.0f, 2.0f}},
        {"turn right", {0.0f, -2.0f}},
        {"stroll", {0.7f, 0.0f}},
        {"stroll left", {0.7f, 1.8f}},
        {"stroll right", {0.7f, -1.8f}},
        {"walk", {1.3f, 0.0f}},
        {"walk left", {1.3f, 1.3f}},
        {"walk right", {1.3f, -1.3f}},
        {"walk fast", {2.0f, 0.0f}},
        {"walk fast left", {2.0f, 0.9f}},
        {"walk fast right", {2.0f, -0.9f}},
        {"jog", {3.0f, 0.0f}},
        {"jog left", {3.0f, 0.5f}},
        {"jog right", {3.0f, -0.5f}},
    };
    // As clip_triangulation.h makes them, which a test compares.
    std::vector<ClipTriangle> triangles = {
        {0, 2, 5},  {0, 3, 4},  {0, 4, 1},   {0, 5, 3},   {3, 5, 8},   {3, 6, 7},   {3, 7, 4},
        {3, 8, 6},  {4, 7, 10}, {4, 10, 13}, {5, 11, 8},  {5, 14, 11}, {6, 8, 11},  {6, 9, 10},
        {6, 10, 7}, {6, 11, 9}, {9, 11, 14}, {9, 12, 13}, {9, 13, 10}, {9, 14, 12},
    };
    return std::make_shared<const LocomotionDatabase>(
        LocomotionDatabase::make(std::move(clips), std::move(triangles)).value());
  }();
  return database;
}

float replayRatio(float speed, float blendSpeed) {
  if (!(blendSpeed > 1e-3f) || !std::isfinite(speed)) return 1.0f;
  return std::clamp(speed / blendSpeed, kSlowestReplay, kFastestReplay);
}

}  // namespace forewalk::agents
