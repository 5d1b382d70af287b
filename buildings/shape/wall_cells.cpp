#include "buildings/shape/wall_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "buildings/shape/cell_pieces.h"
#include "buildings/shape/graph_cut.h"

namespace skyquilt::buildings {
namespace {

constexpr double kBorderCost_m = 0.5;   // square metres per metre of border without evidence
constexpr double kEvidenceShare = 0.9;  // of that cost which full evidence saves
constexpr double kBorderEdge_m = 0.8;   // roofs overhang walls
constexpr double kBorderWall_m = 0.6;
constexpr double kFullWall_m = 2.0;  // of wall points for full evidence

class Cutter {
 public:
  Cutter(const AxisPoints& points, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges, WallCells cells)
      : points_(points), raster_(raster), edges_(edges), cells_(std::move(cells)), covered_(CoveredArea(cells_, raster)) {}

  WallCells Cut() {
    const int columns = cells_.Columns(), rows = cells_.Rows();
    GraphCut cut(covered_.size());
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const size_t cell = cells_.Index(column, row);
        cut.AddNode(cell, cells_.AreaOf(column, row) - covered_[cell], covered_[cell]);
        if (column == 0) cut.AddNode(cell, BorderCost(0, 0, row), 0.0);
        if (row == 0) cut.AddNode(cell, BorderCost(1, 0, column), 0.0);
        const double right = BorderCost(0, column + 1, row), top = BorderCost(1, row + 1, column);
        // Beyond the last lines all is outside.
        if (column + 1 < columns) {
          cut.AddPair(cell, cells_.Index(column + 1, row), right);
        } else {
          cut.AddNode(cell, right, 0.0);
        }
        if (row + 1 < rows) {
          cut.AddPair(cell, cells_.Index(column, row + 1), top);
        } else {
          cut.AddNode(cell, top, 0.0);
        }
      }
    }
    cells_.inside = cut.Solve();
    KeepLargestPiece();
    PartCorners();
    KeepLargestPiece();
    return cells_;
  }

 private:
  // Of the piece of line number `line` of an axis beside cell `along` of the other.
  double BorderCost(int axis, int line, int along) const {
    const double at = cells_.Position(axis, line);
    const double from = cells_.Position(1 - axis, along), to = cells_.Position(1 - axis, along + 1);
    double wall_m2 = 0.0;
    for (const AxisPoint& point : points_.steep) {
      if (std::abs(point.at[axis] - at) < kBorderWall_m && point.at[1 - axis] > from && point.at[1 - axis] < to &&
          std::abs(point.normal[axis]) > std::abs(point.normal[1 - axis])) {
        wall_m2 += points_.spacing_m * points_.spacing_m;
      }
    }
    const double wall = std::min(1.0, wall_m2 / (kFullWall_m * (to - from)));
    const double edge = ShareWithEdge(raster_, edges_[static_cast<size_t>(axis)], axis, at, from, to, kBorderEdge_m);
    return kBorderCost_m * (to - from) * (1.0 - kEvidenceShare * std::max(wall, edge));
  }

  void KeepLargestPiece() {
    const std::vector<int> piece = LabelPieces(cells_.inside, cells_.Columns(), cells_.Rows());
    std::vector<double> area(piece.size(), 0.0);
    for (int row = 0; row < cells_.Rows(); ++row) {
      for (int column = 0; column < cells_.Columns(); ++column) {
        const int label = piece[cells_.Index(column, row)];
        if (label >= 0) area[static_cast<size_t>(label)] += cells_.AreaOf(column, row);
      }
    }
    const auto largest = static_cast<int>(std::max_element(area.begin(), area.end()) - area.begin());
    for (size_t cell = 0; cell < piece.size(); ++cell) cells_.inside[cell] = piece[cell] == largest ? 1 : 0;
  }

  // Changes the cheapest of the four cells around each corner where two inside cells touch across. Ends, because every cell changes at most once.
  void PartCorners() {
    std::vector<uint8_t> changed(cells_.inside.size(), 0);
    for (bool again = true; again;) {
      again = false;
      for (int row = 0; row + 1 < cells_.Rows(); ++row) {
        for (int column = 0; column + 1 < cells_.Columns(); ++column) {
          const std::array<std::pair<int, int>, 4> around = {{{column, row}, {column + 1, row}, {column, row + 1}, {column + 1, row + 1}}};
          const auto is_inside = [&](size_t i) { return cells_.inside[cells_.Index(around[i].first, around[i].second)] != 0; };
          if (is_inside(0) != is_inside(3) || is_inside(1) != is_inside(2) || is_inside(0) == is_inside(1)) continue;
          int best = -1;
          double least = 0.0;
          for (int i = 0; i < 4; ++i) {
            const auto [c, r] = around[static_cast<size_t>(i)];
            const size_t cell = cells_.Index(c, r);
            if (changed[cell] != 0) continue;
            const double loss = cells_.inside[cell] != 0 ? covered_[cell] : cells_.AreaOf(c, r) - covered_[cell];
            if (best < 0 || loss < least) {
              best = static_cast<int>(cell);
              least = loss;
            }
          }
          if (best < 0) continue;
          cells_.inside[static_cast<size_t>(best)] ^= 1U;
          changed[static_cast<size_t>(best)] = 1;
          again = true;
        }
      }
    }
  }

  const AxisPoints& points_;
  const RoofRaster& raster_;
  const std::array<EdgesAcross, 2>& edges_;
  WallCells cells_;
  std::vector<double> covered_;
};

}  // namespace

std::vector<double> CoveredArea(const WallCells& cells, const RoofRaster& raster) {
  std::vector<double> area(static_cast<size_t>(cells.Columns()) * static_cast<size_t>(cells.Rows()), 0.0);
  for (int row = 0; row < cells.Rows(); ++row) {
    const RoofRaster::Range rows = raster.Between(1, cells.Position(1, row), cells.Position(1, row + 1));
    for (int column = 0; column < cells.Columns(); ++column) {
      const RoofRaster::Range columns = raster.Between(0, cells.Position(0, column), cells.Position(0, column + 1));
      int count = 0;
      for (int r = rows.first; r < rows.last; ++r) {
        for (int c = columns.first; c < columns.last; ++c) count += raster.covered[raster.Index(c, r)];
      }
      // Centres may be a few more or fewer than the area says.
      const int all = (rows.last - rows.first) * (columns.last - columns.first);
      if (all > 0) area[cells.Index(column, row)] = cells.AreaOf(column, row) * count / all;
    }
  }
  return area;
}

WallCells CutCells(const WallLines& lines, const AxisPoints& points, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges) {
  WallCells cells;
  for (size_t axis = 0; axis < 2; ++axis) {
    for (const WallLine& line : lines[axis]) cells.line[axis].push_back(line.at);
  }
  cells.inside.assign(static_cast<size_t>(cells.Columns()) * static_cast<size_t>(cells.Rows()), 0);
  return Cutter(points, raster, edges, std::move(cells)).Cut();
}

}  // namespace skyquilt::buildings
