// Writing and reading of GeoTIFF, row band by row band.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/gis/map_grid.h"
#include "core/image/image.h"

namespace skyquilt::gis {

enum class PixelType { kUint8, kFloat32 };

struct GeoTiffSpec {
  MapGrid grid;  // size, place and zone; without geo-reference no CRS is written
  PixelType type = PixelType::kUint8;
  int bands = 1;  // four bands of bytes are red, green, blue, alpha
  std::optional<double> nodata;
  std::vector<std::string> band_names;
  std::string unit;  // of the values, "" for none
  std::map<std::string, std::string> metadata;
};

// Tiled, deflate-compressed, with overviews down to 256 pixels. Written beside and renamed by Close: the file is whole or absent.
class GeoTiffWriter {
 public:
  // Throws base::InputError here and below when the disk or GDAL refuses; the message names the file and GDAL's reason.
  GeoTiffWriter(const std::filesystem::path& file, const GeoTiffSpec& spec);
  ~GeoTiffWriter();
  GeoTiffWriter(GeoTiffWriter&&) noexcept;

  // Rows [first_row, first_row + n_rows), interleaved by pixel: n_rows * width * bands values. The type must be the spec's.
  void WriteRows(int first_row, int n_rows, std::span<const uint8_t> values);
  void WriteRows(int first_row, int n_rows, std::span<const float> values);
  void Close();

  static constexpr int kTile = 256;  // rows per call that compress best

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The whole file reduced to at most max_width columns (averages), all bands interleaved as float; no-data cells are NaN.
struct ReducedRaster {
  image::ImageF image;
  double scale = 1.0;  // cells of the file per pixel of the image, across
  double scale_down = 1.0;
};
ReducedRaster ReadReduced(const std::filesystem::path& file, int max_width);

}  // namespace skyquilt::gis
