#include "floor_plan.h"

#include <algorithm>
#include <stdexcept>

namespace forewalk::assets {
namespace {

constexpr int kWindowWidth = 1600, kSill = 900, kWindowHead = 2200, kWindowSpacing = 3000;

struct Stretch {
  int from, to;
};

/// Sorts and joins stretches that touch or overlap.
std::vector<Stretch> joined(std::vector<Stretch> parts) {
  std::sort(parts.begin(), parts.end(), [](Stretch a, Stretch b) { return a.from < b.from; });
  std::vector<Stretch> result;
  for (const Stretch part : parts) {
    if (!result.empty() && part.from <= result.back().to) {
      result.back().to = std::max(result.back().to, part.to);
    } else {
      result.push_back(part);
    }
  }
  return result;
}

}  // namespace

FloorPlan::FloorPlan(int base, int wallHeight, Style style)
    : base_(base), wallHeight_(wallHeight), style_(style) {}

std::size_t FloorPlan::room(const std::string& name, Rect area) {
  rooms_.push_back({name, area, {(area.x0 + area.x1) / 2, base_, (area.z0 + area.z1) / 2}});
  return rooms_.size() - 1;
}

void FloorPlan::probe(std::size_t room, int x, int z) { rooms_[room].probe = {x, base_, z}; }

FloorPlan::Shared FloorPlan::sharedWall(std::size_t a, std::size_t b) const {
  const Rect p = rooms_[a].area, q = rooms_[b].area;
  Shared wall{};
  if (p.x1 == q.x0 || q.x1 == p.x0) {
    wall = {false, p.x1 == q.x0 ? p.x1 : p.x0, std::max(p.z0, q.z0), std::min(p.z1, q.z1)};
  } else {
    wall = {true, p.z1 == q.z0 ? p.z1 : p.z0, std::max(p.x0, q.x0), std::min(p.x1, q.x1)};
  }
  const bool touching = wall.alongX ? (p.z1 == q.z0 || q.z1 == p.z0) : true;
  if (!touching || wall.from >= wall.to) {
    throw std::logic_error(rooms_[a].name + " and " + rooms_[b].name + " share no wall");
  }
  return wall;
}

void FloorPlan::door(std::size_t a, std::size_t b, int at, int width) {
  const Shared wall = sharedWall(a, b);
  const int from = at - width / 2, to = from + width;
  if (from < wall.from + style_.outerWall || to > wall.to - style_.outerWall) {
    throw std::logic_error("the door from " + rooms_[a].name + " to " + rooms_[b].name + " at " +
                           std::to_string(at) + " mm does not lie in their wall");
  }
  passages_.push_back({a, b, wall.alongX, wall.line, from, to, true});
}

void FloorPlan::open(std::size_t a, std::size_t b) {
  const Shared wall = sharedWall(a, b);
  passages_.push_back({a, b, wall.alongX, wall.line, wall.from, wall.to, false});
}

Rect FloorPlan::footprint() const {
  Rect all = rooms_.front().area;
  for (const Room& r : rooms_) {
    all = {std::min(all.x0, r.area.x0), std::min(all.z0, r.area.z0), std::max(all.x1, r.area.x1),
           std::max(all.z1, r.area.z1)};
  }
  const int half = style_.outerWall / 2;
  return {all.x0 - half, all.z0 - half, all.x1 + half, all.z1 + half};
}

int FloorPlan::loops() const {
  return static_cast<int>(passages_.size()) - static_cast<int>(rooms_.size()) + 1 + islands_;
}

void FloorPlan::writeWalls(ObjWriter& out) const {
  const Rect foot = footprint();
  const int half = style_.outerWall / 2;
  const auto isOuter = [&](bool alongX, int line) {
    return alongX ? line == foot.z0 + half || line == foot.z1 - half
                  : line == foot.x0 + half || line == foot.x1 - half;
  };

  // Every edge of a room is a stretch of wall on some line; shared edges are joined.
  std::map<std::pair<bool, int>, std::vector<Stretch>> lines;
  std::map<std::pair<bool, int>, std::vector<Stretch>> windows;
  for (const Room& room : rooms_) {
    const Rect r = room.area;
    for (const bool alongX : {true, false}) {
      const Stretch edge = alongX ? Stretch{r.x0, r.x1} : Stretch{r.z0, r.z1};
      for (const bool first : {true, false}) {
        const int line = alongX ? (first ? r.z0 : r.z1) : (first ? r.x0 : r.x1);
        lines[{alongX, line}].push_back(edge);
        if (!style_.windows || !isOuter(alongX, line)) continue;
        const int count = (edge.to - edge.from) / kWindowSpacing;
        for (int i = 0; i < count; ++i) {
          const int middle = edge.from + (edge.to - edge.from) * (2 * i + 1) / (2 * count);
          windows[{alongX, line}].push_back({middle - kWindowWidth / 2, middle + kWindowWidth / 2});
        }
      }
    }
  }

  const int top = base_ + wallHeight_;
  for (const auto& [key, stretches] : lines) {
    const auto [alongX, line] = key;
    const int thickness = isOuter(alongX, line) ? style_.outerWall : style_.innerWall;
    const auto piece = [&, alongX = alongX, line = line](int from, int to, int y0, int y1) {
      const int a = line - thickness / 2, b = line + thickness / 2;
      out.box(alongX ? Rect{from, a, to, b} : Rect{a, from, b, to}, y0, y1);
    };

    struct Gap {
      int from, to, sill, head;
    };
    std::vector<Gap> gaps;
    for (const Passage& p : passages_) {
      if (p.alongX != alongX || p.line != line) continue;
      gaps.push_back({p.from, p.to, 0, p.head ? style_.doorHead : wallHeight_});
    }
    if (const auto found = windows.find(key); found != windows.end()) {
      for (const Stretch w : found->second) gaps.push_back({w.from, w.to, kSill, kWindowHead});
    }
    std::sort(gaps.begin(), gaps.end(), [](Gap a, Gap b) { return a.from < b.from; });

    for (const Stretch wall : joined(stretches)) {
      // A wall's free end runs on by half its thickness, so that corners are closed.
      int from = wall.from - thickness / 2;
      for (const Gap gap : gaps) {
        if (gap.to <= wall.from || gap.from >= wall.to) continue;
        if (gap.from > from && gap.from > wall.from) piece(from, gap.from, base_, top);
        if (gap.sill > 0) piece(gap.from, gap.to, base_, base_ + gap.sill);
        if (gap.head < wallHeight_) piece(gap.from, gap.to, base_ + gap.head, top);
        from = gap.to;
      }
      if (from < wall.to) piece(from, wall.to + thickness / 2, base_, top);
    }
  }
}

}  // namespace forewalk::assets
