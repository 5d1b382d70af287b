#include "products/preview_files.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/gis/geotiff.h"
#include "products/map_preview.h"
#include "products/map_rays.h"
#include "products/place_metadata.h"

namespace skyquilt::products {
namespace {

struct PreviewFiles {
  std::filesystem::path tif, png, json;
};

PreviewFiles FilesOf(const std::filesystem::path& folder, const std::string& made_from) {
  SKYQUILT_CHECK(made_from == kFromSparsePoints || made_from == kFromContext, made_from);
  const std::string stem = made_from == kFromContext ? "preview_context" : "preview_ortho";
  return {folder / (stem + ".tif"), folder / (stem + ".png"), folder / (stem + ".json")};
}

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
  const PreviewFiles files = FilesOf(folder, made_from);
  gis::GeoTiffSpec spec = OrthophotoSpec(info, map.grid, "Preview of the orthophoto, made from the " + made_from);
  spec.metadata["PREVIEW"] = made_from;
  gis::GeoTiffWriter tif(files.tif, spec);
  tif.WriteRows(0, map.grid.height, std::span<const uint8_t>(map.rgba));
  tif.Close();
  WriteOrthophotoPicture(info, map.grid, files.tif, files.png, png_width);
  WriteMapBounds(info, map.grid, files.json, made_from);
  return files.png;
}

std::optional<FoundPreview> FindPreview(const std::filesystem::path& folder, const std::string& made_from) {
  const PreviewFiles files = FilesOf(folder, made_from);
  for (const std::filesystem::path& file : {files.tif, files.png, files.json}) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  }
  const auto json = base::TryParseJson(base::ReadFile(files.json));
  if (!json.is_object() || !json.contains("preview") || json["preview"] != made_from) return std::nullopt;
  return FoundPreview{files.png, made_from};
}

std::vector<FoundPreview> FindPreviews(const std::filesystem::path& folder) {
  std::vector<FoundPreview> previews;
  for (const char* made_from : {kFromSparsePoints, kFromContext}) {
    if (std::optional<FoundPreview> preview = FindPreview(folder, made_from)) previews.push_back(*std::move(preview));
  }
  return previews;
}

void RemovePreviews(const std::filesystem::path& folder) {
  for (const char* made_from : {kFromSparsePoints, kFromContext}) {
    const PreviewFiles files = FilesOf(folder, made_from);
    for (const std::filesystem::path& file : {files.json, files.png, files.tif}) {
      std::error_code error;
      std::filesystem::remove(file, error);
      if (error) throw base::InputError(file, "cannot be removed: " + error.message(), "Check the permissions of the folder");
    }
  }
}

bool HasOrthophoto(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / "orthophoto.tif", ignored);
}

}  // namespace skyquilt::products
