// Outlines of masks, along the borders of cells.
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

// East, north, west, south.
constexpr std::array<int, 4> kColumnStep = {1, 0, -1, 0}, kRowStep = {0, 1, 0, -1};

class MaskTracer {
 public:
  MaskTracer(std::span<const uint8_t> mask, int columns, int rows)
      : mask_(mask), columns_(columns), rows_(rows), part_(mask.size(), -1), traced_((Corner(columns, rows) + 1) * 4, false) {
    FindParts();
  }

  // Rings of each part along the cells' corners, one of them the outer one.
  std::vector<std::vector<std::vector<uint32_t>>> Rings() {
    std::vector<std::vector<std::vector<uint32_t>>> rings(static_cast<size_t>(n_parts_));
    // Every ring runs east somewhere, with its part to the north.
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const int part = PartAt(column, row);
        if (part < 0) continue;
        if (PartAt(column, row - 1) < 0) Trace(column, row, 0, &rings[static_cast<size_t>(part)]);
      }
    }
    return rings;
  }

  Eigen::Vector2d Place(uint32_t corner) const {
    const uint32_t width = static_cast<uint32_t>(columns_) + 1;
    return {static_cast<double>(corner % width), static_cast<double>(corner / width)};
  }

 private:
  size_t Cell(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column); }
  size_t Corner(int column, int row) const { return static_cast<size_t>(row) * (static_cast<size_t>(columns_) + 1) + static_cast<size_t>(column); }
  int PartAt(int column, int row) const { return column < 0 || row < 0 || column >= columns_ || row >= rows_ ? -1 : part_[Cell(column, row)]; }

  void FindParts() {
    std::vector<std::pair<int, int>> open;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (mask_[Cell(column, row)] == 0 || part_[Cell(column, row)] >= 0) continue;
        part_[Cell(column, row)] = n_parts_;
        open.emplace_back(column, row);
        while (!open.empty()) {
          const auto [c, r] = open.back();
          open.pop_back();
          for (size_t d = 0; d < 4; ++d) {
            const int to_c = c + kColumnStep[d], to_r = r + kRowStep[d];
            if (to_c < 0 || to_r < 0 || to_c >= columns_ || to_r >= rows_) continue;
            if (mask_[Cell(to_c, to_r)] == 0 || part_[Cell(to_c, to_r)] >= 0) continue;
            part_[Cell(to_c, to_r)] = n_parts_;
            open.emplace_back(to_c, to_r);
          }
        }
        ++n_parts_;
      }
    }
  }

  // Walks along a border with the part on the left, from a corner in a direction; adds its rings unless it was walked before.
  void Trace(int column, int row, size_t direction, std::vector<std::vector<uint32_t>>* rings) {
    std::vector<uint32_t> ring;
    while (true) {
      const size_t here = Corner(column, row) * 4 + direction;
      if (traced_[here]) break;
      traced_[here] = true;
      column += kColumnStep[direction];
      row += kRowStep[direction];
      // Where two cells touch at a corner only, the walk stays with its cell: parts are connected by edges.
      const size_t before = direction;
      if (!Ahead(column, row, direction, true)) {
        direction = (direction + 1) % 4;
      } else if (Ahead(column, row, direction, false)) {
        direction = (direction + 3) % 4;
      }
      if (direction != before) ring.push_back(static_cast<uint32_t>(Corner(column, row)));
    }
    for (auto& simple : SplitAtRepeats(ring)) rings->push_back(std::move(simple));
  }

  // Whether the cell ahead to the left or right of a walk that has come to a corner is inside.
  bool Ahead(int column, int row, size_t direction, bool left) const {
    const bool east = direction == 0 || (direction == 1 && !left) || (direction == 3 && left);
    const bool north = direction == 1 || (direction == 0 && left) || (direction == 2 && !left);
    return PartAt(east ? column : column - 1, north ? row : row - 1) >= 0;
  }

  std::span<const uint8_t> mask_;
  int columns_, rows_;
  std::vector<int> part_;     // of each cell; -1: outside
  std::vector<bool> traced_;  // borders by the corner where they begin and their direction
  int n_parts_ = 0;
};

}  // namespace

std::vector<Polygon> OutlinesOf(std::span<const uint8_t> mask, int columns, int rows, const Eigen::Vector2d& origin, double cell_m) {
  MaskTracer tracer(mask, columns, rows);
  std::vector<std::pair<double, Polygon>> found;
  for (const auto& rings : tracer.Rings()) {
    Polygon polygon;
    for (const std::vector<uint32_t>& corners : rings) {
      Ring ring;
      for (const uint32_t corner : corners) ring.push_back(origin + cell_m * tracer.Place(corner));
      if (SignedArea(ring) > 0.0) {
        polygon.outer = std::move(ring);
      } else {
        polygon.holes.push_back(std::move(ring));
      }
    }
    const double area = Area(polygon);
    found.emplace_back(area, std::move(polygon));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Polygon> outlines;
  for (auto& [area, polygon] : found) outlines.push_back(std::move(polygon));
  return outlines;
}

}  // namespace skyquilt::buildings
