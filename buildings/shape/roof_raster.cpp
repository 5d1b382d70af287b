#include "buildings/shape/roof_raster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kCellSpacings = 1.15;  // so that most cells hold a point
constexpr double kMostCells = 250000.0;
constexpr int kMargin = 3;        // cells
constexpr float kLayer_m = 0.4F;  // points this far below the highest of a cell are of the same roof
constexpr int kWidestGap = 6;     // cells from its edge

// Even-odd rule along the middle of each row; crossings of all rings together.
void Cover(const Polygon& outline, RoofRaster* raster) {
  std::vector<double> crossings;
  for (int row = 0; row < raster->rows; ++row) {
    const double v = raster->Centre(0, row).y();
    crossings.clear();
    const auto cross = [&](const std::vector<Eigen::Vector2d>& ring) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.y() > v) != (b.y() > v)) crossings.push_back(a.x() + (v - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    };
    cross(outline.outer);
    for (const auto& hole : outline.holes) cross(hole);
    std::sort(crossings.begin(), crossings.end());
    for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const RoofRaster::Range inside = raster->Between(0, crossings[i], crossings[i + 1]);
      for (int column = inside.first; column < inside.last; ++column) raster->covered[raster->Index(column, row)] = 1;
    }
  }
}

// Mean height of the highest roof's points in each covered cell.
void PutHeights(const std::vector<AxisPoint>& roof, RoofRaster* raster) {
  std::vector<int64_t> cell_of(roof.size(), -1);
  std::vector<float> top(raster->height.size(), -std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < roof.size(); ++i) {
    const int64_t at = raster->CellAt(roof[i].at.head<2>());
    const auto cell = static_cast<size_t>(at);
    if (at < 0 || raster->covered[cell] == 0) continue;
    cell_of[i] = at;
    top[cell] = std::max(top[cell], static_cast<float>(roof[i].at.z()));
  }
  std::vector<double> sum(raster->height.size());
  std::vector<int> count(raster->height.size());
  for (size_t i = 0; i < roof.size(); ++i) {
    if (cell_of[i] < 0) continue;
    const auto cell = static_cast<size_t>(cell_of[i]);
    if (static_cast<float>(roof[i].at.z()) < top[cell] - kLayer_m) continue;
    sum[cell] += roof[i].at.z();
    ++count[cell];
  }
  for (size_t cell = 0; cell < sum.size(); ++cell) {
    if (count[cell] > 0) raster->height[cell] = static_cast<float>(sum[cell] / count[cell]);
  }
}

// Gaps get the median of their neighbours, from their edge inwards: a median stays on one side of a step.
void CloseGaps(RoofRaster* raster) {
  std::vector<float> around;
  for (int pass = 0; pass < kWidestGap; ++pass) {
    const std::vector<float> before = raster->height;
    bool changed = false;
    for (int row = 1; row + 1 < raster->rows; ++row) {
      for (int column = 1; column + 1 < raster->columns; ++column) {
        const size_t cell = raster->Index(column, row);
        if (raster->covered[cell] == 0 || std::isfinite(before[cell])) continue;
        around.clear();
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const float height = before[raster->Index(column + dc, row + dr)];
            if (std::isfinite(height)) around.push_back(height);
          }
        }
        if (around.empty()) continue;
        raster->height[cell] = base::UpperMedian(around);
        changed = true;
      }
    }
    if (!changed) return;
  }
}

}  // namespace

RoofRaster::Range RoofRaster::Between(int axis, double from, double to) const {
  const int count = axis == 0 ? columns : rows;
  const auto border = [&](double at) {
    const double place = std::ceil((at - origin[axis]) / cell_m - 0.5);
    return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(count)));
  };
  return {border(from), border(to)};
}

RoofRaster MakeRoofRaster(const AxisPoints& points, double gsd_m) {
  RoofRaster raster;
  if (points.outline.outer.size() < 3) return raster;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& uv : points.outline.outer) box.extend(uv);
  if (!(box.sizes().array() > 0.0).all() || !box.sizes().allFinite()) return raster;
  raster.cell_m = std::max({gsd_m, kCellSpacings * points.spacing_m, std::sqrt(box.volume() / kMostCells)});
  raster.origin = box.min() - Eigen::Vector2d::Constant(kMargin * raster.cell_m);
  raster.columns = static_cast<int>(std::ceil(box.sizes().x() / raster.cell_m)) + 2 * kMargin;
  raster.rows = static_cast<int>(std::ceil(box.sizes().y() / raster.cell_m)) + 2 * kMargin;
  raster.height.assign(raster.size(), std::numeric_limits<float>::quiet_NaN());
  raster.covered.assign(raster.size(), 0);
  Cover(points.outline, &raster);
  PutHeights(points.roof, &raster);
  CloseGaps(&raster);
  return raster;
}

}  // namespace skyquilt::buildings
