#include "buildings/candidates/top_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace skyquilt::buildings {
namespace {

constexpr double kMostRasterCells = 30e6;
constexpr double kNearTop_m = 0.5;    // points that count for the colour
constexpr double kGapSpacings = 1.2;  // widest gaps between points that are closed
constexpr size_t kLeastAround = 3;    // cells with a height, of eight
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

// Closes gaps by one cell from each side.
void CloseGaps(TopRaster* raster) {
  std::vector<float> top_z = raster->top_z, green = raster->green;
  std::array<std::pair<float, float>, 8> around;
  for (int row = 0; row < raster->rows; ++row) {
    for (int column = 0; column < raster->columns; ++column) {
      const size_t cell = raster->Index(column, row);
      if (!std::isnan(raster->top_z[cell])) continue;
      size_t n = 0;
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, raster->rows - 1); ++r) {
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, raster->columns - 1); ++c) {
          const size_t other = raster->Index(c, r);
          if (!std::isnan(raster->top_z[other])) around[n++] = {raster->top_z[other], raster->green[other]};
        }
      }
      if (n < kLeastAround) continue;
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>((n - 1) / 2);
      std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(n));
      std::tie(top_z[cell], green[cell]) = *middle;
    }
  }
  raster->top_z = std::move(top_z);
  raster->green = std::move(green);
}

}  // namespace

double ExcessGreen(const SurfacePoint& point) {
  const double sum = point.rgb[0] + point.rgb[1] + point.rgb[2];
  return sum > 0.0 ? (2.0 * point.rgb[1] - point.rgb[0] - point.rgb[2]) / sum : 0.0;
}

TopRaster RasteriseTop(const PointCloud& cloud, const PlanIndex& points, const Eigen::AlignedBox2d& box, double cell_m) {
  TopRaster raster;
  raster.cell_m = std::max(cell_m, std::sqrt(box.sizes().prod() / kMostRasterCells));
  // At whole multiples of the cell, so that the outline of a building does not depend on what else is near.
  raster.origin = (box.min() / raster.cell_m).array().floor() * raster.cell_m;
  raster.columns = 1 + static_cast<int>((box.max().x() - raster.origin.x()) / raster.cell_m);
  raster.rows = 1 + static_cast<int>((box.max().y() - raster.origin.y()) / raster.cell_m);
  raster.top_z.assign(raster.size(), kNoValue);
  raster.green.assign(raster.size(), kNoValue);
  const auto for_each = [&](const auto& use) {
    points.ForEachIn(box, [&](uint32_t i) {
      if (cloud.points[i].filled != 0) return;
      const Eigen::Vector3d at = cloud.At(i);
      // A cell is as high as any point in it: walls, whose points stand on its border, would make it too large by half a cell.
      const Eigen::Vector2d inwards = -0.5 * raster.cell_m * cloud.points[i].normal.head<2>().cast<double>();
      const int64_t cell = raster.CellAt(at.head<2>() + inwards);
      if (cell >= 0) use(static_cast<size_t>(cell), static_cast<float>(at.z()), cloud.points[i]);
    });
  };
  for_each([&](size_t cell, float z, const SurfacePoint&) {
    if (!(raster.top_z[cell] >= z)) raster.top_z[cell] = z;
  });
  std::vector<float> n(raster.top_z.size(), 0.0F);
  for_each([&](size_t cell, float z, const SurfacePoint& point) {
    if (static_cast<double>(z) < static_cast<double>(raster.top_z[cell]) - kNearTop_m) return;
    raster.green[cell] = (n[cell] > 0.0F ? raster.green[cell] : 0.0F) + static_cast<float>(ExcessGreen(point));
    n[cell] += 1.0F;
  });
  for (size_t cell = 0; cell < n.size(); ++cell) {
    if (n[cell] > 0.0F) raster.green[cell] /= n[cell];
  }
  const auto rounds = static_cast<int>(std::ceil(0.5 * kGapSpacings * cloud.spacing_m / raster.cell_m));
  for (int round = 0; round < rounds; ++round) CloseGaps(&raster);
  return raster;
}

}  // namespace skyquilt::buildings
