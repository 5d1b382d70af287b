// The heights of products/dsm.tif, in memory.
#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "core/gis/map_grid.h"
#include "core/image/image.h"

namespace skyquilt::evaluate::ortho {

class HeightMap {
 public:
  // Models of more than 32 million cells are thinned out, so that they take at most 128 MiB. Throws base::InputError.
  explicit HeightMap(const std::filesystem::path& dsm_tif);

  // Metres, of the nearest cell; NaN where there is none.
  double At(const Eigen::Vector2d& easting_northing) const;
  double median_m() const { return median_m_; }  // NaN without heights

 private:
  gis::MapGrid grid_;
  image::ImageF height_m_;
  double median_m_ = 0.0;
};

}  // namespace skyquilt::evaluate::ortho
