// Reads back the maps that this program wrote: where a raster lies, a part of it as a picture, and contour lines.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/gis/map_grid.h"
#include "core/image/image.h"

namespace skyquilt::gis {

// Size, place and zone of a GeoTIFF; not geo-referenced when it has no CRS. Throws base::InputError when the file cannot be read, is not north-up
// with square cells, or has a CRS other than a UTM or UPS zone of WGS84, alone or with a vertical CRS.
MapGrid ReadMapGrid(const std::filesystem::path& file);

// How often the undulation of EGM96 was added to the survey's heights for a GeoTIFF of heights: -1, 0 or 1 (geo::kUndulationsItem). Throws
// base::InputError when the file cannot be read, or says something else.
int ReadUndulations(const std::filesystem::path& file);

// All bands, interleaved as float, of a rectangle in map coordinates, whose edges are the outer edges of the result. Averaged when cells are smaller
// than pixels, else interpolated; transparent cells (alpha) do not count. NaN outside the map and where it has no data. width and height must be
// positive, the rectangle not empty. Throws base::InputError.
image::ImageF ReadMapPart(const std::filesystem::path& file, const Eigen::AlignedBox2d& part, int width, int height);

// Reads windows of cells of one GeoTIFF, of any numeric type. For one thread at a time.
class MapReader {
 public:
  // Throws base::InputError as ReadMapGrid.
  explicit MapReader(const std::filesystem::path& file);
  ~MapReader();
  MapReader(MapReader&&) noexcept;

  const MapGrid& grid() const;
  // The cells [column, column + width) x [row, row + height), all bands interleaved as float, as they are in the file, a mask as alpha after
  // red, green, blue. NaN outside the map, where a window may reach, and where it has no data. Throws base::InputError when the file cannot be read.
  image::ImageF Read(int column, int row, int width, int height) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct ContourLine {
  double height_m = 0.0;
  bool index = false;                   // every fifth line
  std::vector<Eigen::Vector2d> map_xy;  // easting and northing, or local metres
};
struct Contours {
  bool georeferenced = false;
  geo::UtmZone zone;    // then
  int undulations = 0;  // as of ReadUndulations
  std::vector<ContourLine> lines;
  bool thinned = false;  // lines were left out
};
// The layer "contours" of contours.gpkg, in its order. At most max_vertices are read: when there are more, only index lines, and of those as many as
// fit. Throws base::InputError when it cannot be read, or has a CRS that is none of ReadMapGrid's.
Contours ReadContours(const std::filesystem::path& gpkg, int64_t max_vertices);

}  // namespace skyquilt::gis
