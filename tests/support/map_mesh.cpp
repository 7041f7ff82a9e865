#include "tests/support/map_mesh.h"

#include <cassert>
#include <map>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::testing {
namespace {

using navmesh::PolygonMesh;

class MapMeshMaker {
 public:
  MapMeshMaker(std::span<const std::string_view> rows, float cell, Cutting cutting)
      : rows_(rows), parts_(cutting == Cutting::kFine ? 2 : 1), cell_(cell), cutting_(cutting) {}

  PolygonMesh make() {
    const int height = static_cast<int>(rows_.size()) * parts_;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width(y); ++x) {
        if (walkable(x, y)) addSquare(x, y);
      }
    }
    return std::move(mesh_);
  }

 private:
  std::string_view rowAt(int y) const {
    const int row = static_cast<int>(rows_.size()) - 1 - y / parts_;
    return row < 0 || y < 0 ? std::string_view() : rows_[static_cast<std::size_t>(row)];
  }
  int width(int y) const { return static_cast<int>(rowAt(y).size()) * parts_; }
  bool walkable(int x, int y) const {
    return x >= 0 && x < width(y) && rowAt(y)[static_cast<std::size_t>(x / parts_)] != ' ';
  }

  void addSquare(int x, int y) {
    const std::uint32_t a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1),
                        d = corner(x, y + 1);
    if (cutting_ != Cutting::kTriangles) {
      addRing({a, b, c, d});
    } else if ((x + y) % 2 == 0) {
      addRing({a, b, c});
      addRing({a, c, d});
    } else {
      addRing({a, b, d});
      addRing({b, c, d});
    }
  }

  void addRing(std::initializer_list<std::uint32_t> ring) {
    mesh_.ring.insert(mesh_.ring.end(), ring);
    mesh_.ringStart.push_back(static_cast<std::uint32_t>(mesh_.ring.size()));
  }

  std::uint32_t corner(int x, int y) {
    const auto [it, isNew] =
        index_.try_emplace({x, y}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (!isNew) return it->second;
    glm::vec2 plan = glm::vec2(x, y) * (cell_ / static_cast<float>(parts_));
    const bool inside =
        walkable(x, y) && walkable(x - 1, y) && walkable(x, y - 1) && walkable(x - 1, y - 1);
    if (cutting_ == Cutting::kUneven && inside) {
      plan += 0.11f * cell_ * glm::vec2((x * 7 + y * 3) % 5 - 2, (x * 3 + y * 11) % 5 - 2);
    }
    mesh_.vertices.push_back(navmesh::toSpace(plan, 0.0f));
    return it->second;
  }

  std::span<const std::string_view> rows_;
  int parts_;
  float cell_;
  Cutting cutting_;
  PolygonMesh mesh_;
  std::map<std::pair<int, int>, std::uint32_t> index_;
};

}  // namespace

PolygonMesh mapMesh(std::span<const std::string_view> rows, float cell, Cutting cutting) {
  return MapMeshMaker(rows, cell, cutting).make();
}

glm::vec2 markIn(std::span<const std::string_view> rows, float cell, char mark) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::size_t column = rows[row].find(mark);
    if (column == std::string_view::npos) continue;
    const float y = static_cast<float>(rows.size() - 1 - row) + 0.5f;
    return cell * glm::vec2(static_cast<float>(column) + 0.5f, y);
  }
  assert(false);
  return glm::vec2(0.0f);
}

}  // namespace forewalk::testing
