#include "buildings/candidates/roof_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kTolerance_m = 0.5;
constexpr double kLeastEdge_m = 0.4, kMostEdge_m = 1.0;  // the surface of a roof's edge is rounded over some pixels: half of its fall is the edge
constexpr double kEdgeShare = 0.4;                       // but not of more than this share of the height
constexpr double kBite_m = 1.2;                          // half the width of bites that are closed
constexpr double kReach_m = 0.7;                         // of a roof beyond its planar points
constexpr double kNarrowest_m = 1.0;                     // strips of an outline
constexpr double kHighestOnTop_m = 1.3;                  // parapets beside the planar part of a roof; higher things there are trees
constexpr double kFilledHole_m2 = 30.0;                  // holes over which something stands higher than the roof
constexpr double kLeastCourtyard_m2 = 4.0;

double HeightOf(const RoofPlane& plane, const Eigen::Vector2d& enu) {
  return plane.middle.z() - plane.normal.head<2>().dot(enu - plane.middle.head<2>()) / plane.normal.z();
}

// Cells where the surface continues the roof: near its planar points, and in bites of that, where boxes stand or errors bend it.
CellMask CellsOfRoof(const TopRaster& top, const RoofLevels& levels, std::span<const PlanePiece> pieces, double max_green, double edge_m,
                     double reach_m) {
  CellMask near(top), possible(top);
  for (size_t cell = 0; cell < top.size(); ++cell) {
    if (levels.piece[cell] < 0) continue;
    const PlanePiece& piece = pieces[static_cast<size_t>(levels.piece[cell])];
    const double above = static_cast<double>(top.top_z[cell]) - static_cast<double>(levels.z[cell]);
    const bool green = static_cast<double>(top.green[cell]) > max_green && !piece.green;
    possible.value[cell] = above >= -std::min(edge_m, kEdgeShare * piece.height_m) && !green ? 1 : 0;
    // Something over a point of the roof does not take it away.
    const bool seen = levels.distance_m[cell] == 0.0F;
    const bool beside = possible.value[cell] != 0 && static_cast<double>(levels.distance_m[cell]) <= reach_m && above <= kHighestOnTop_m;
    near.value[cell] = seen || beside ? 1 : 0;
  }
  const double radius = kBite_m / top.cell_m;
  const CellMask closed = Eroded(Dilated(near, radius), radius);
  for (size_t cell = 0; cell < top.size(); ++cell)
    near.value[cell] = near.value[cell] != 0 || (closed.value[cell] != 0 && possible.value[cell] != 0) ? 1 : 0;
  return near;
}

// Holes are filled in place: of any size where the surface inside is about as high as the roof (it was only not planar), up to kFilledHole_m2 where
// it is higher, and tiny ones.
void FillHoles(const TopRaster& top, const RoofLevels& levels, double tolerance_m, CellMask* mask) {
  CellMask outside(mask->columns, mask->rows);
  for (size_t i = 0; i < mask->value.size(); ++i) outside.value[i] = mask->value[i] == 0 ? 1 : 0;
  const double cell_m2 = top.cell_m * top.cell_m;
  for (const std::vector<uint32_t>& part : ConnectedParts(outside)) {
    const auto width = static_cast<uint32_t>(mask->columns);
    const bool open = std::any_of(part.begin(), part.end(), [&](uint32_t cell) {
      const auto column = static_cast<int>(cell % width), row = static_cast<int>(cell / width);
      return column == 0 || row == 0 || column == mask->columns - 1 || row == mask->rows - 1;
    });
    if (open) continue;
    std::vector<double> above;
    for (const uint32_t cell : part) {
      const double difference = static_cast<double>(top.top_z[cell]) - static_cast<double>(levels.z[cell]);
      if (!std::isnan(difference)) above.push_back(difference);
    }
    const double area_m2 = cell_m2 * static_cast<double>(part.size());
    const double middle = base::Median(std::move(above));
    const bool standing = area_m2 < kFilledHole_m2 && middle >= -tolerance_m;
    const bool rough = std::abs(middle) <= tolerance_m;
    if (area_m2 >= kLeastCourtyard_m2 && !standing && !rough) continue;
    for (const uint32_t cell : part) mask->value[cell] = 1;
  }
}

}  // namespace

RoofLevels FindRoofLevels(const TopRaster& top, std::span<const PlanePiece> pieces, const PointCloud& cloud, double max_green) {
  RoofLevels levels;
  CellMask seeds(top);
  std::vector<int32_t> piece_at(top.size(), -1);
  for (size_t p = 0; p < pieces.size(); ++p) {
    if (pieces[p].kind == PieceKind::kNone) continue;
    for (const uint32_t i : pieces[p].plane.points) {
      const int64_t at = top.CellAt(cloud.At(i).head<2>());
      // Growth leaks into the crowns of trees that touch a roof at its height.
      if (at < 0 || (!pieces[p].green && ExcessGreen(cloud.points[i]) > max_green)) continue;
      const auto cell = static_cast<size_t>(at);
      seeds.value[cell] = 1;
      int32_t& of_cell = piece_at[cell];
      const Eigen::Vector2d centre = top.CentreOf(cell);
      if (of_cell < 0 || HeightOf(pieces[p].plane, centre) > HeightOf(pieces[static_cast<size_t>(of_cell)].plane, centre))
        of_cell = static_cast<int32_t>(p);
    }
  }
  const std::vector<int32_t> nearest = NearestCells(seeds);
  levels.z.assign(top.size(), std::numeric_limits<float>::quiet_NaN());
  levels.piece.assign(top.size(), -1);
  levels.distance_m.assign(top.size(), std::numeric_limits<float>::infinity());
  for (size_t cell = 0; cell < top.size(); ++cell) {
    if (nearest[cell] < 0) continue;
    levels.piece[cell] = piece_at[static_cast<size_t>(nearest[cell])];
    levels.z[cell] = static_cast<float>(HeightOf(pieces[static_cast<size_t>(levels.piece[cell])].plane, top.CentreOf(cell)));
    levels.distance_m[cell] = static_cast<float>(top.cell_m * CellDistance(seeds, cell, nearest[cell]));
  }
  return levels;
}

RoofArea CutOut(const TopRaster& top, const RoofLevels& levels, const std::vector<uint32_t>& cells) {
  const auto width = static_cast<uint32_t>(top.columns);
  int left = top.columns, right = -1, low = top.rows, high = -1;
  for (const uint32_t cell : cells) {
    left = std::min(left, static_cast<int>(cell % width));
    right = std::max(right, static_cast<int>(cell % width));
    low = std::min(low, static_cast<int>(cell / width));
    high = std::max(high, static_cast<int>(cell / width));
  }
  const auto around = static_cast<int>(std::ceil(kAround_m / top.cell_m));
  left = std::max(left - around, 0);
  low = std::max(low - around, 0);
  right = std::min(right + around, top.columns - 1);
  high = std::min(high + around, top.rows - 1);
  RoofArea area{{top.origin + top.cell_m * Eigen::Vector2d(left, low), top.cell_m, right - left + 1, high - low + 1}, {}, {}, {}};
  area.mask = CellMask(area);
  for (const uint32_t cell : cells) area.mask.value[area.Index(static_cast<int>(cell % width) - left, static_cast<int>(cell / width) - low)] = 1;
  for (int row = low; row <= high; ++row) {
    for (int column = left; column <= right; ++column) {
      area.roof_z.push_back(levels.z[top.Index(column, row)]);
      area.piece.push_back(levels.piece[top.Index(column, row)]);
    }
  }
  return area;
}

std::vector<RoofArea> FindRoofAreas(const TopRaster& top, const RoofLevels& levels, std::span<const PlanePiece> pieces,
                                    const BuildingsOptions& options, double gsd_m, double spacing_m) {
  const double tolerance_m = RoofTolerance(gsd_m), edge_m = std::clamp(5.0 * gsd_m, kLeastEdge_m, kMostEdge_m);
  CellMask all = CellsOfRoof(top, levels, pieces, options.max_green, edge_m, std::max(kReach_m, 2.5 * spacing_m));
  FillHoles(top, levels, tolerance_m, &all);
  all = Opened(all, 0.5 * kNarrowest_m / top.cell_m);
  FillHoles(top, levels, tolerance_m, &all);
  std::vector<RoofArea> areas;
  for (const std::vector<uint32_t>& part : ConnectedParts(all)) {
    if (static_cast<double>(part.size()) * top.cell_m * top.cell_m < options.min_area_m2) continue;
    const bool roof = std::any_of(part.begin(), part.end(), [&](uint32_t cell) {
      return levels.distance_m[cell] == 0.0F && pieces[static_cast<size_t>(levels.piece[cell])].kind == PieceKind::kRoof;
    });
    if (roof) areas.push_back(CutOut(top, levels, part));
  }
  return areas;
}

double RoofTolerance(double gsd_m) {
  return std::max(kTolerance_m, 3.0 * gsd_m);
}

}  // namespace skyquilt::buildings
