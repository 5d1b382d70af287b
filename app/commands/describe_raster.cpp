#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/commands/describe.h"
#include "core/base/file.h"
#include "core/gis/geotiff.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

Json DescribeRaster(const std::filesystem::path& file) {
  // Ranges come from a reduced copy of averaged cells, which is fast for large rasters; single extreme cells may exceed them.
  const gis::ReducedRaster raster = gis::ReadReduced(file, 512);
  const image::ImageF& image = raster.image;
  Json bands = Json::array();
  for (int band = 0; band < image.channels; ++band) {
    double low = kInfinity;
    double high = -kInfinity;
    size_t n_valid = 0;
    for (size_t i = static_cast<size_t>(band); i < image.data.size(); i += static_cast<size_t>(image.channels)) {
      const double value = static_cast<double>(image.data[i]);
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
      ++n_valid;
    }
    const double n = static_cast<double>(image.width) * image.height;
    bands.push_back({{"band", band + 1},
                     {"min", n_valid > 0 ? Json(low) : Json(nullptr)},
                     {"max", n_valid > 0 ? Json(high) : Json(nullptr)},
                     {"filled", n > 0 ? static_cast<double>(n_valid) / n : 0.0}});
  }
  Json json = {{"what", "raster"},
               {"bytes", std::filesystem::file_size(file)},
               {"width", std::lround(image.width * raster.scale)},
               {"height", std::lround(image.height * raster.scale_down)},
               {"bands", bands}};
  const std::string stem = file.stem().string();
  const bool is_preview = stem == "preview_ortho" || stem == "preview_context";
  const std::filesystem::path beside = file.parent_path() / (is_preview ? stem + ".json" : "orthophoto.json");
  if ((stem == "orthophoto" || stem == "dsm" || is_preview) && std::filesystem::exists(beside)) {
    const Json map = Json::parse(base::ReadFile(beside), nullptr, false);
    if (!map.is_discarded()) json["map"] = map;
  }
  return json;
}

}  // namespace skyquilt::app
