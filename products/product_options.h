// What is made of a finished scene: [products] in the configuration.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::products {

struct ProductOptions {
  bool ortho = true;
  bool dsm = true;
  double resolution_m = 0.0;        // cell of the orthophoto and surface model; 0: ground sampling distance rounded to 1, 2 or 5 times a power of ten
  double max_pixels = 25e6;         // cells of one map product: a larger resolution_m = 0 map is coarsened, a larger requested one refused
  double min_opacity = 0.5;         // cells whose ray stays more transparent have no data, (0, 1)
  int preview_width = 1600;         // pixels of the PNG previews
  std::string exposure = "normal";  // or stops above it, or a photo's name; for pictures, video and orthophoto
  std::string video_path = "orbit";  // "orbit" or "flyover"
  double video_seconds = 5.0;        // 0: no video
  int video_fps = 12;
  int video_width = 480;  // pixels; even, as H.264 asks
  int video_height = 270;

  static std::vector<config::Field<ProductOptions>> Fields();
  // Throws base::UsageError naming the option, its value and the rule it breaks.
  void Check() const;
};

}  // namespace skyquilt::products
