// The true orthophoto of a simulated survey in the cells of another map.
#pragma once

#include <filesystem>

#include "core/gis/read_maps.h"

namespace skyquilt::evaluate::ortho {

// A part of a map: display values in [0,1], three channels, 0 where there is no data; and where there is.
struct MapPart {
  image::ImageF rgb;
  image::Image8 known;  // one channel, 1 or 0
};

// Cells of a window, which may reach beyond the map. Of one or three bands and perhaps alpha.
MapPart ReadPart(const gis::MapReader& reader, int column, int row, int width, int height);

// For one thread at a time.
class TrueMap {
 public:
  // Throws base::InputError when the file cannot be read, or is of another zone than `grid`, or does not overlap it.
  TrueMap(const std::filesystem::path& truth_tif, const gis::MapGrid& grid);

  // Of the cells of `grid`, which lies `shift_m` (east, north) too far: means of light where they are larger than those of the truth, else
  // interpolated display values. Without data where any cell of the truth that takes part has none.
  MapPart Read(int column, int row, int width, int height, const Eigen::Vector2d& shift_m) const;
  double cell_m() const { return reader_.grid().resolution_m; }

 private:
  gis::MapReader reader_;
  gis::MapGrid grid_;
};

}  // namespace skyquilt::evaluate::ortho
