// Options of section [products] of the configuration: which maps and videos are made from a scene.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::products {

// Of the PNG pictures of maps, pixels at most: a screen's width, so that report and viewer open at once. The maps themselves have every cell.
constexpr int kPreviewWidth = 1600;

// Most cells of maps that are rendered from the scene, unless products.resolution_m states finer ones.
constexpr double kMostRenderedCells = 25e6;

struct ProductOptions {
  std::string kinds = "auto";  // auto, all, or names separated by commas (products/product_kinds.h)
  bool ortho = true;
  bool dsm = true;
  bool preview = true;                  // make previews of the orthophoto before the scene is trained (products/preview_files.h)
  double resolution_m = 0.0;            // metres per cell of the maps; 0: ground sampling distance rounded to 1, 2 or 5 times a power of ten
  double max_pixels = 500e6;            // most cells of the orthophoto; finer requests are refused
  double min_opacity = 0.5;             // map cells with a lower opacity have no data, in (0, 1)
  std::string exposure = "normal";      // or stops above it, or the name of a photo; for images, video and orthophoto
  std::string ortho_source = "photos";  // or "field"
  double crop_m = 0.0;                  // metres cut off the orthophoto all round from where two photos see the ground
  std::string vertical = "as-tagged";   // what heights of maps, surface and buildings are above: as-tagged, ellipsoid or egm96
  std::string boundary;                 // GeoJSON or GeoPackage with polygons that limit all products; empty: the whole scene
  bool plain_surround = true;           // core/scene/surround.h for videos, views along a path, tours and exact frames of the viewer
  std::string video_path = "orbit";     // "orbit", "flyover" or "cameras"
  double video_seconds = 5.0;           // 0: no video
  int video_fps = 12;
  int video_width = 480;  // pixels; even, as H.264 requires
  int video_height = 270;

  static std::vector<config::Field<ProductOptions>> Fields();
  static std::vector<config::FixedOption> Fixed();
  // Most cells of a rendered map whose resolution is automatic.
  double MostAutomaticCells() const { return std::min(max_pixels, kMostRenderedCells); }
  // Throws base::UsageError that names the option, its value and the rule it breaks.
  void Check() const;
};

// The stops that ProductOptions::exposure states; none when it is no number (normal, or the name of a photo). Throws base::UsageError for a number
// outside -10 to 10.
std::optional<double> ExposureStops(const std::string& exposure);

}  // namespace skyquilt::products
