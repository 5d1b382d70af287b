#include "evaluate/ortho/height_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/gis/read_maps.h"

namespace skyquilt::evaluate::ortho {

HeightMap::HeightMap(const std::filesystem::path& dsm_tif) {
  constexpr double kMostCells = 32.0 * (1 << 20);
  constexpr size_t kMedianOf = 100000;
  const gis::MapReader reader(dsm_tif);
  grid_ = reader.grid();
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(grid_.size()) / kMostCells))));
  height_m_ = image::ImageF((grid_.width + step - 1) / step, (grid_.height + step - 1) / step, 1);
  for (int y = 0; y < height_m_.height; ++y) {
    const image::ImageF row = reader.Read(0, y * step, grid_.width, 1);
    for (int x = 0; x < height_m_.width; ++x) *height_m_.At(x, y) = *row.At(x * step, 0);
  }
  grid_.resolution_m *= step;
  // Cells that stand for others are those in their north-western corners.
  grid_.left -= 0.5 * grid_.resolution_m * (step - 1) / step;
  grid_.top += 0.5 * grid_.resolution_m * (step - 1) / step;
  grid_.width = height_m_.width;
  grid_.height = height_m_.height;
  std::vector<double> some;
  for (size_t i = 0; i < height_m_.data.size(); i += 1 + height_m_.data.size() / kMedianOf) {
    if (std::isfinite(height_m_.data[i])) some.push_back(static_cast<double>(height_m_.data[i]));
  }
  median_m_ = base::Median(std::move(some));
}

double HeightMap::At(const Eigen::Vector2d& easting_northing) const {
  const Eigen::Vector2d cell = grid_.CellOf(easting_northing).array().round();
  const bool inside = cell.x() >= 0.0 && cell.x() < grid_.width && cell.y() >= 0.0 && cell.y() < grid_.height;
  return inside ? static_cast<double>(*height_m_.At(static_cast<int>(cell.x()), static_cast<int>(cell.y())))
                : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace skyquilt::evaluate::ortho
