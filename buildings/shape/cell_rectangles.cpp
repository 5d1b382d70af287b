#include "buildings/shape/cell_rectangles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "buildings/shape/cell_pieces.h"
#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kRegionEdge_m = 0.8;  // roofs overhang walls
constexpr double kJumpShare = 0.4;     // of a border with steps, so that it separates regions

// Number of set cells in rectangles of a mask.
class Counts {
 public:
  Counts(const std::vector<uint8_t>& mask, int columns, int rows)
      : columns_(columns), sum_((static_cast<size_t>(columns) + 1) * (static_cast<size_t>(rows) + 1), 0) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        Sum(c + 1, r + 1) = Sum(c, r + 1) + Sum(c + 1, r) - Sum(c, r) +
                            (mask[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)] != 0 ? 1 : 0);
      }
    }
  }
  bool IsFull(const CellRectangle& r) {
    return Sum(r.u1, r.v1) - Sum(r.u0, r.v1) - Sum(r.u1, r.v0) + Sum(r.u0, r.v0) == (r.u1 - r.u0) * (r.v1 - r.v0);
  }

 private:
  int& Sum(int c, int r) { return sum_[static_cast<size_t>(r) * (static_cast<size_t>(columns_) + 1) + static_cast<size_t>(c)]; }
  int columns_;
  std::vector<int> sum_;
};

// Median height of each region.
std::map<int, double> RegionHeights(const WallCells& cells, const RoofRaster& raster, const std::vector<int>& region) {
  std::map<int, std::vector<float>> heights;
  for (int row = 0; row < cells.Rows(); ++row) {
    const RoofRaster::Range rows = raster.Between(1, cells.Position(1, row), cells.Position(1, row + 1));
    for (int column = 0; column < cells.Columns(); ++column) {
      const int label = region[cells.Index(column, row)];
      if (label < 0) continue;
      const RoofRaster::Range columns = raster.Between(0, cells.Position(0, column), cells.Position(0, column + 1));
      for (int r = rows.first; r < rows.last; ++r) {
        for (int c = columns.first; c < columns.last; ++c) {
          const float height = raster.height[raster.Index(c, r)];
          if (std::isfinite(height)) heights[label].push_back(height);
        }
      }
    }
  }
  std::map<int, double> median;
  for (auto& [label, values] : heights) median[label] = static_cast<double>(base::UpperMedian(values));
  return median;
}

// Gives the smallest region that is too small to its neighbour; false when there is none.
bool MergeSmallest(const WallCells& cells, double least_m2, std::vector<int>* region) {
  std::map<int, double> area;
  std::map<std::pair<int, int>, double> border;
  for (int row = 0; row < cells.Rows(); ++row) {
    for (int column = 0; column < cells.Columns(); ++column) {
      const int here = (*region)[cells.Index(column, row)];
      if (here < 0) continue;
      area[here] += cells.AreaOf(column, row);
      for (const int axis : {0, 1}) {
        const int c = column + (axis == 0 ? 1 : 0), r = row + (axis == 1 ? 1 : 0);
        if (c >= cells.Columns() || r >= cells.Rows()) continue;
        const int there = (*region)[cells.Index(c, r)];
        if (there < 0 || there == here) continue;
        const double length =
            axis == 0 ? cells.Position(1, row + 1) - cells.Position(1, row) : cells.Position(0, column + 1) - cells.Position(0, column);
        border[{here, there}] += length;
        border[{there, here}] += length;
      }
    }
  }
  int smallest = -1;
  for (const auto& [label, own] : area) {
    if (own < least_m2 && (smallest < 0 || own < area[smallest])) smallest = label;
  }
  if (smallest < 0 || area.size() < 2) return false;
  int neighbour = -1;
  double longest = 0.0;
  for (const auto& [pair, length] : border) {
    if (pair.first != smallest || !(length > longest)) continue;
    longest = length;
    neighbour = pair.second;
  }
  if (neighbour < 0) return false;
  std::replace(region->begin(), region->end(), smallest, neighbour);
  return true;
}

}  // namespace

std::vector<CellRectangle> MaximalRectangles(const std::vector<uint8_t>& mask, int columns, int rows) {
  Counts counts(mask, columns, rows);
  std::vector<CellRectangle> found;
  for (int u0 = 0; u0 < columns; ++u0) {
    for (int u1 = u0 + 1; u1 <= columns; ++u1) {
      for (int v0 = 0; v0 < rows; ++v0) {
        for (int v1 = v0 + 1; v1 <= rows; ++v1) {
          if (!counts.IsFull({u0, u1, v0, v1})) break;
          const bool grows = (u0 > 0 && counts.IsFull({u0 - 1, u1, v0, v1})) || (u1 < columns && counts.IsFull({u0, u1 + 1, v0, v1})) ||
                             (v0 > 0 && counts.IsFull({u0, u1, v0 - 1, v1})) || (v1 < rows && counts.IsFull({u0, u1, v0, v1 + 1}));
          if (!grows) found.push_back({u0, u1, v0, v1});
        }
      }
    }
  }
  return found;
}

bool Overlap(const CellRectangle& a, const CellRectangle& b, CellRectangle* both) {
  *both = {std::max(a.u0, b.u0), std::min(a.u1, b.u1), std::max(a.v0, b.v0), std::min(a.v1, b.v1)};
  return both->u0 < both->u1 && both->v0 < both->v1;
}

bool Without(const CellRectangle& a, const CellRectangle& b, CellRectangle* rest) {
  CellRectangle both;
  if (!Overlap(a, b, &both)) return false;
  *rest = a;
  const bool all_u = both.u0 == a.u0 && both.u1 == a.u1, all_v = both.v0 == a.v0 && both.v1 == a.v1;
  if (all_u == all_v) return false;
  if (all_u && both.v0 == a.v0) {
    rest->v0 = both.v1;
  } else if (all_u && both.v1 == a.v1) {
    rest->v1 = both.v0;
  } else if (all_v && both.u0 == a.u0) {
    rest->u0 = both.u1;
  } else if (all_v && both.u1 == a.u1) {
    rest->u1 = both.u0;
  } else {
    return false;
  }
  return true;
}

std::vector<int> RoofRegions(const WallCells& cells, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges, double least_m2) {
  const auto passes = [&](int column, int row, int axis) {
    const double at = axis == 0 ? cells.Position(0, column + 1) : cells.Position(1, row + 1);
    const double from = axis == 0 ? cells.Position(1, row) : cells.Position(0, column);
    const double to = axis == 0 ? cells.Position(1, row + 1) : cells.Position(0, column + 1);
    return ShareWithEdge(raster, edges[static_cast<size_t>(axis)], axis, at, from, to, kRegionEdge_m, RoofEdge::kStep) < kJumpShare;
  };
  std::vector<int> region = LabelPieces(cells.inside, cells.Columns(), cells.Rows(), passes);
  while (MergeSmallest(cells, least_m2, &region)) {
  }
  return region;
}

std::vector<CellRectangle> CandidateRectangles(const WallCells& cells, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges,
                                               double least_m2) {
  const int columns = cells.Columns(), rows = cells.Rows();
  const std::vector<int> region = RoofRegions(cells, raster, edges, least_m2);
  const std::map<int, double> height = RegionHeights(cells, raster, region);
  std::set<CellRectangle> found;
  const auto add = [&](const auto& belongs) {
    std::vector<uint8_t> mask(region.size(), 0);
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = region[i] >= 0 && belongs(region[i]) ? 1 : 0;
    for (const CellRectangle& r : MaximalRectangles(mask, columns, rows)) found.insert(r);
  };
  add([](int) { return true; });
  for (const auto& [label, own_height] : height) {
    const int own = label;
    const double own_z = own_height;
    add([&](int other) { return other == own; });
    add([&](int other) { return other == own || (height.count(other) > 0 && height.at(other) > own_z); });
  }
  const std::vector<CellRectangle> whole(found.begin(), found.end());
  for (const CellRectangle& a : whole) {
    for (const CellRectangle& b : whole) {
      CellRectangle rest;
      if (Without(a, b, &rest)) found.insert(rest);
    }
  }
  std::vector<CellRectangle> result(found.begin(), found.end());
  std::stable_sort(result.begin(), result.end(), [&](const CellRectangle& a, const CellRectangle& b) { return cells.AreaOf(a) > cells.AreaOf(b); });
  if (result.size() > static_cast<size_t>(kMostRectangles)) result.resize(static_cast<size_t>(kMostRectangles));
  return result;
}

}  // namespace skyquilt::buildings
