#include "surface/maps/hillshade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

using Neighbourhood = std::array<std::array<double, 3>, 3>;  // [row from north][column from west]; NaN: missing

// Mean slope per cell along three lines of neighbours, the middle one counting twice. Along each line between its ends, or between the middle and the
// end that is there.
double MeanSlope(const Neighbourhood& lines) {
  double sum = 0.0, weights = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    const auto [first, middle, last] = lines[i];
    double slope = 0.5 * (last - first);
    if (std::isnan(slope)) slope = std::isnan(first) ? last - middle : middle - first;
    if (std::isnan(slope)) continue;
    const double weight = i == 1 ? 2.0 : 1.0;
    sum += weight * slope;
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

Neighbourhood Transposed(const Neighbourhood& lines) {
  Neighbourhood transposed;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) transposed[i][j] = lines[j][i];
  }
  return transposed;
}

}  // namespace

std::vector<uint8_t> Hillshade(const HeightRaster& raster, base::ThreadPool& threads) {
  // Towards the light: east, north, up.
  const Eigen::Vector3d light(-0.5, 0.5, std::sqrt(0.5));
  const int width = raster.grid.width, height = raster.grid.height;
  std::vector<uint8_t> shade(raster.height_m.size(), 0);
  threads.ParallelFor(height, [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto row = static_cast<int>(task);
    const auto at = [&](int x, int y) {
      if (x < 0 || y < 0 || x >= width || y >= height) return std::numeric_limits<double>::quiet_NaN();
      const float z = raster.height_m[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      return std::isfinite(z) ? static_cast<double>(z) : std::numeric_limits<double>::quiet_NaN();
    };
    for (int column = 0; column < width; ++column) {
      if (std::isnan(at(column, row))) continue;
      Neighbourhood near;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) near[static_cast<size_t>(i + 1)][static_cast<size_t>(j + 1)] = at(column + j, row + i);
      }
      const double east = MeanSlope(near) / raster.grid.resolution_m;
      const double north = -MeanSlope(Transposed(near)) / raster.grid.resolution_m;
      const double cosine = Eigen::Vector3d(-east, -north, 1.0).dot(light) / std::sqrt(east * east + north * north + 1.0);
      shade[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)] =
          static_cast<uint8_t>(1 + std::lround(254.0 * std::clamp(cosine, 0.0, 1.0)));
    }
  });
  return shade;
}

}  // namespace skyquilt::surface
