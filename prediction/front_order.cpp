#include "prediction/front_order.h"

#include "navmesh/plan.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::cross;

namespace {

/// Whether direction a lies before b, counter-clockwise from `base` on.
bool isBefore(dvec2 base, dvec2 a, dvec2 b) {
  const auto isBeyondHalf = [base](dvec2 direction) {
    const double side = cross(base, direction);
    return side < 0.0 || (side == 0.0 && glm::dot(base, direction) < 0.0);
  };
  const bool farA = isBeyondHalf(a);
  const bool farB = isBeyondHalf(b);
  return farA != farB ? farB : cross(a, b) > 0.0;
}

}  // namespace

void FrontOrder::reserve(std::size_t roots, std::size_t stretches) {
  sectors_.reserve(roots + stretches);
  rootOf_.reserve(roots + stretches);
  firstOf_.reserve(roots);
  base_.reserve(roots);
  endAt_.reserve(stretches);
}

void FrontOrder::start(std::size_t roots, std::size_t stretches) {
  sectors_.clear();
  rootOf_.clear();
  firstOf_.assign(roots, kNone);
  base_.resize(roots);
  endAt_.assign(stretches, kNone);
  const std::uint32_t all = addSector(0, dvec2(1.0, 0.0));
  sectors_[all].left = sectors_[all].right = all;
  uncut_ = true;
}

std::uint32_t FrontOrder::addSector(std::uint32_t root, dvec2 from) {
  const auto sector = static_cast<std::uint32_t>(sectors_.size());
  if (firstOf_[root] == kNone) base_[root] = from;
  Sector& added = sectors_.emplace_back();
  added.left = added.right = added.leftEnd = kNone;
  added.next = firstOf_[root];
  added.from = from;
  rootOf_.push_back(root);
  return firstOf_[root] = sector;
}

void FrontOrder::putAtEnd(std::uint32_t sector, std::uint32_t stretch) {
  const std::uint32_t end = endAt_[stretch];
  Sector& added = sectors_[sector];
  if (stretch % 2 == 0) {
    added.right = end;
    added.leftEnd = stretch;
    sectors_[end].left = sector;
  } else {
    added.left = end;
    sectors_[end].right = sector;
  }
  endAt_[stretch] = sector;
}

bool FrontOrder::add(std::uint32_t root, dvec2 arrival, std::uint32_t stretch) {
  if (endAt_[stretch] == kNone || firstOf_[root] != kNone) return false;
  putAtEnd(addSector(root, -arrival), stretch);
  return true;
}

bool FrontOrder::addBetween(std::uint32_t root, dvec2 arrival, std::uint32_t leftEnd,
                            std::uint32_t rightEnd) {
  if (endAt_[leftEnd] == kNone || endAt_[rightEnd] == kNone || firstOf_[root] != kNone) {
    return false;
  }
  // Who turns right about it comes to lie at the right end of the piece that passes it on the left.
  putAtEnd(addSector(root, -arrival), rightEnd);
  putAtEnd(addSector(root, arrival), leftEnd);
  return true;
}

std::uint32_t FrontOrder::sectorOf(std::uint32_t root, dvec2 direction) const {
  std::uint32_t found = firstOf_[root];
  if (found == kNone || sectors_[found].next == kNone) return found;
  found = kNone;
  const dvec2 base = base_[root];
  for (std::uint32_t s = firstOf_[root]; s != kNone; s = sectors_[s].next) {
    const dvec2 from = sectors_[s].from;
    if (isBefore(base, direction, from)) continue;
    if (found == kNone || isBefore(base, sectors_[found].from, from)) found = s;
  }
  return found;
}

std::uint32_t FrontOrder::leftEndOf(std::uint32_t sector) const {
  const std::uint32_t start = sector;
  while (sectors_[sector].left != kNone) {
    sector = sectors_[sector].left;
    if (sector == start) return kNone;
  }
  return sectors_[sector].leftEnd;
}

/// Parts a sector in two, which are neighbours no more.
FrontOrder::Cut FrontOrder::cut(std::uint32_t sector, dvec2 direction) {
  if (uncut_ && sector == 0) {
    uncut_ = false;
    base_[rootOf_[0]] = sectors_[0].from = direction;
    sectors_[0].left = sectors_[0].right = kNone;
    return {0, 0};
  }
  const std::uint32_t added = addSector(rootOf_[sector], direction);
  Sector& left = sectors_[added];
  Sector& right = sectors_[sector];
  left.left = right.left;
  left.leftEnd = right.leftEnd;
  if (left.left == sector) {
    right.right = added;  // it was all of a closed piece
  } else if (left.left != kNone) {
    sectors_[left.left].right = added;
  } else if (left.leftEnd != kNone) {
    endAt_[left.leftEnd] = added;
  }
  right.left = right.leftEnd = kNone;
  return {added, sector};
}

void FrontOrder::split(std::uint32_t sector, dvec2 direction, std::uint32_t leftEnd,
                       std::uint32_t rightEnd) {
  const Cut parts = cut(sector, direction);
  sectors_[parts.right].leftEnd = leftEnd;
  endAt_[leftEnd] = parts.right;
  endAt_[rightEnd] = parts.left;
}

bool FrontOrder::join(std::uint32_t rightEnd, std::uint32_t leftEnd) {
  const std::uint32_t a = endAt_[rightEnd];
  const std::uint32_t b = endAt_[leftEnd];
  if (a == kNone || b == kNone) return false;
  sectors_[a].right = b;
  sectors_[b].left = a;
  return true;
}

void FrontOrder::meet(std::uint32_t sectorA, dvec2 directionA, std::uint32_t sectorB,
                      dvec2 directionB) {
  const Cut a = cut(sectorA, directionA);
  const Cut b = cut(sectorB, directionB);
  sectors_[a.left].right = b.right;
  sectors_[b.right].left = a.left;
  sectors_[b.left].right = a.right;
  sectors_[a.right].left = b.left;
}

}  // namespace forewalk::prediction
