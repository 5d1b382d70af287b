// Writes maps as GeoTIFF, some rows at a time, so that maps larger than memory can be made; reads them at reduced size.
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

#include "core/geo/height_reference.h"
#include "core/gis/map_grid.h"
#include "core/image/image.h"

namespace skyquilt::gis {

enum class PixelType { kUint8, kUint16, kFloat32 };

struct GeoTiffSpec {
  MapGrid grid;  // size, position and zone; without geo-reference no CRS is written
  PixelType type = PixelType::kUint8;
  int bands = 1;                 // four bands of kUint8 are red, green, blue, alpha
  bool labels = false;           // values are names, not amounts: overviews keep one of them instead of the mean
  int jpeg_quality = 0;          // 1 to 100: loses a little of red, green, blue, and a mask (0 where alpha is 0) is stored for alpha; 0: keeps all
  std::optional<double> nodata;  // value of cells without data
  std::vector<std::string> band_names;
  std::string unit;  // of the values, for instance "m"; empty: none
  // What the values are above, when they are heights. EGM96 becomes part of the CRS; ellipsoidal heights do not, because GDAL 3.6 puts a projected
  // CRS of three dimensions into a file beside the GeoTIFF: name them in the metadata.
  geo::HeightReference heights = geo::HeightReference::kUnknown;
  std::map<std::string, std::string> metadata;
};

// A cloud-optimised GeoTIFF (OGC 21-026): in tiles, deflate-compressed, with averaged overviews down to one tile in front of the full resolution, so
// that programs can read parts of it over a network. Rows go to a plain GeoTIFF first, which Close rearranges by parts, so that the disk must hold
// the map twice for a while, but memory never. Both have other names until the file is complete: it is either complete or missing. The same rows give
// the same bytes.
class GeoTiffWriter {
 public:
  // Throws base::InputError when the disk or GDAL refuses, as do the functions below; the message names the file and GDAL's reason.
  GeoTiffWriter(const std::filesystem::path& file, const GeoTiffSpec& spec);
  ~GeoTiffWriter();
  GeoTiffWriter(GeoTiffWriter&&) noexcept;

  // Writes rows [first_row, first_row + n_rows): n_rows * width * bands values, interleaved by pixel. Their type must be spec.type.
  void WriteRows(int first_row, int n_rows, std::span<const uint8_t> values);
  void WriteRows(int first_row, int n_rows, std::span<const uint16_t> values);
  void WriteRows(int first_row, int n_rows, std::span<const float> values);
  // Adds overviews and completes the file. Throws base::Interrupted when cancelled. After an error the writer can only be destroyed.
  void Close();

  static constexpr int kTile = 512;  // rows of a tile: write a multiple of them per call

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct ReducedRaster {
  image::ImageF image;      // all bands interleaved as float, a mask as alpha after red, green, blue; NaN: no data
  double scale = 1.0;       // cells of the file per pixel of the image, horizontally
  double scale_down = 1.0;  // the same, vertically
};
enum class Reduction { kMean, kMaximum };
// The whole file reduced to at most max_width columns: each pixel is the mean, or the maximum, of the known cells that it covers, whole or in part.
// Means are those of the coarsest overview that is fine enough, so that few cells are read of a large map; a maximum needs all cells. Throws
// base::InputError when it cannot be read.
ReducedRaster ReadReduced(const std::filesystem::path& file, int max_width, Reduction reduction = Reduction::kMean);

}  // namespace skyquilt::gis
