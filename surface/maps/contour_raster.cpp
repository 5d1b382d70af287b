#include "surface/maps/contour_raster.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "surface/maps/low_outliers.h"

namespace skyquilt::surface {
namespace {

constexpr double kMostLevels = 40.0;
constexpr double kSmallestInterval_m = 0.1;
constexpr double kNoiseMultiple = 4.0;
constexpr int kSmoothingPasses = 2;

// Means of factor x factor cells; cells of which more than half are missing are left out. What is left over at the eastern and southern edge is
// dropped.
base::Grid<float> BlockMeans(const HeightRaster& terrain, const std::vector<uint8_t>& mask, int factor) {
  base::Grid<float> means(terrain.grid.width / factor, terrain.grid.height / factor, kNoHeight);
  for (int row = 0; row < means.rows; ++row) {
    base::ThrowIfCancelled();
    for (int column = 0; column < means.columns; ++column) {
      double sum = 0.0;
      int n = 0;
      for (int y = row * factor; y < (row + 1) * factor; ++y) {
        for (int x = column * factor; x < (column + 1) * factor; ++x) {
          const size_t cell = terrain.grid.Index(x, y);
          if (!std::isfinite(terrain.height_m[cell]) || (!mask.empty() && mask[cell] == 0)) continue;
          sum += static_cast<double>(terrain.height_m[cell]);
          ++n;
        }
      }
      if (2 * n >= factor * factor) means.value[means.Index(column, row)] = static_cast<float>(sum / n);
    }
  }
  return means;
}

// One pass of the binomial filter 1 2 1 along rows or columns; missing neighbours are replaced by the cell itself, so that edges stay in place.
void Smooth(base::Grid<float>* grid, int step_column, int step_row) {
  const base::Grid<float> before = *grid;
  for (int row = 0; row < grid->rows; ++row) {
    for (int column = 0; column < grid->columns; ++column) {
      const float own = before.At(column, row);
      if (std::isnan(own)) continue;
      const int west = column - step_column, north = row - step_row, east = column + step_column, south = row + step_row;
      if (west < 0 || north < 0 || east >= grid->columns || south >= grid->rows) continue;
      const float sum = before.At(west, north) + before.At(east, south);
      if (!std::isnan(sum)) grid->value[grid->Index(column, row)] = 0.5F * own + 0.25F * sum;
    }
  }
}

double Relief(const base::Grid<float>& grid) {
  std::vector<float> heights;
  std::copy_if(grid.value.begin(), grid.value.end(), std::back_inserter(heights), [](float height) { return !std::isnan(height); });
  if (heights.empty()) return 0.0;
  const auto low = static_cast<double>(base::NearestRankQuantile(heights, 0.005));
  return static_cast<double>(base::NearestRankQuantile(heights, 0.995)) - low;
}

}  // namespace

double NiceNumberAbove(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value)));
  for (int e = exponent - 1;; ++e) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      // Divided, not multiplied by a negative power: 2 / 10 is the number nearest to 0.2.
      const double nice = e >= 0 ? factor * std::pow(10.0, e) : factor / std::pow(10.0, -e);
      if (nice >= value * (1.0 - 1e-12)) return nice;
    }
  }
}

ContourRaster MakeContourRaster(const HeightRaster& terrain, const std::vector<uint8_t>& mask, double cell_m) {
  const gis::MapGrid& grid = terrain.grid;
  const int least_side = std::max(1, std::min(grid.width, grid.height));
  const int factor = std::clamp(static_cast<int>(std::lround(cell_m / grid.resolution_m)), 1, least_side);
  base::Grid<float> heights = BlockMeans(terrain, mask, factor);
  const double noise_m = NoiseOf(heights);
  for (int pass = 0; pass < kSmoothingPasses; ++pass) {
    Smooth(&heights, 1, 0);
    Smooth(&heights, 0, 1);
  }
  ContourRaster raster;
  raster.interval_m = NiceNumberAbove(std::max({kSmallestInterval_m, kNoiseMultiple * noise_m, Relief(heights) / kMostLevels}));
  raster.heights.grid = grid;
  raster.heights.grid.resolution_m = factor * grid.resolution_m;
  raster.heights.grid.width = heights.columns;
  raster.heights.grid.height = heights.rows;
  raster.heights.height_m = std::move(heights.value);
  return raster;
}

}  // namespace skyquilt::surface
