#include "products/preview_files.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/gis/geotiff.h"
#include "products/map_preview.h"
#include "products/map_rays.h"
#include "products/place_metadata.h"

namespace skyquilt::products {
namespace {

constexpr const char* kPreviewTif = "preview_ortho.tif";
constexpr const char* kPreviewPng = "preview_ortho.png";
constexpr const char* kPreviewJson = "preview_ortho.json";

// 0.123 to 0.13.
double RoundUpToTwoDigits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / unit - 1e-9) * unit;
}

}  // namespace

gis::MapGrid PlanPreviewGrid(const scene::SceneInfo& info, double finest_m, double max_cells) {
  SKYQUILT_CHECK(max_cells >= 16.0, "edges at multiples of the resolution can need four cells");
  const Eigen::Vector2d size = (info.max_enu - info.min_enu).head<2>();
  ProductOptions options;
  options.max_pixels = 1e11;  // the limit is kept here, without a message
  double resolution_m = std::max(finest_m, std::sqrt(size.prod() / max_cells));
  for (;;) {
    options.resolution_m = RoundUpToTwoDigits(resolution_m);
    const gis::MapGrid grid = PlanMapGrid(info, options);
    // A box that is not parallel to the map's axes has more cells around it than in it.
    const double excess = static_cast<double>(grid.width) * grid.height / max_cells;
    if (excess <= 1.0) return grid;
    resolution_m = options.resolution_m * std::max(1.02, std::sqrt(excess));
  }
}

double PreviewMap::Filled() const {
  size_t filled = 0;
  for (size_t i = 3; i < rgba.size(); i += 4) filled += rgba[i] != 0 ? 1 : 0;
  return rgba.empty() ? 0.0 : static_cast<double>(4 * filled) / static_cast<double>(rgba.size());
}

std::filesystem::path WritePreview(const scene::SceneInfo& info, const PreviewMap& map, const std::string& made_from,
                                   const std::filesystem::path& folder, int png_width) {
  base::RequireWritableFolder(folder);
  gis::GeoTiffSpec spec = OrthophotoSpec(info, map.grid, "Preview of the orthophoto, made from the " + made_from);
  spec.metadata["PREVIEW"] = made_from;
  gis::GeoTiffWriter tif(folder / kPreviewTif, spec);
  tif.WriteRows(0, map.grid.height, std::span<const uint8_t>(map.rgba));
  tif.Close();
  WriteOrthophotoPicture(info, map.grid, folder / kPreviewTif, folder / kPreviewPng, png_width, true);
  WriteMapBounds(info, map.grid, folder / kPreviewJson, made_from);
  return folder / kPreviewPng;
}

std::optional<FoundPreview> FindPreview(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder / kPreviewPng, ignored) || !std::filesystem::is_regular_file(folder / kPreviewTif, ignored) ||
      !std::filesystem::is_regular_file(folder / kPreviewJson, ignored)) {
    return std::nullopt;
  }
  const auto json = nlohmann::json::parse(base::ReadFile(folder / kPreviewJson), nullptr, false);
  if (!json.is_object() || !json.contains("preview") || !json["preview"].is_string()) return std::nullopt;
  return FoundPreview{folder / kPreviewPng, json["preview"].get<std::string>()};
}

void RemovePreview(const std::filesystem::path& folder) {
  for (const char* name : {kPreviewJson, kPreviewPng, kPreviewTif}) {
    std::error_code error;
    std::filesystem::remove(folder / name, error);
    if (error) throw base::InputError(folder / name, "cannot be removed: " + error.message(), "Check the permissions of the folder");
  }
}

bool HasOrthophoto(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / "orthophoto.tif", ignored);
}

}  // namespace skyquilt::products
