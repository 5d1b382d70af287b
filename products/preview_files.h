// Previews of the orthophoto: pictures of the survey, made long before its scene is trained. There are two, in files named preview_ortho (photos on
// the sparse points) and preview_context (the context). The second has no detail, so it does not replace the first; the orthophoto replaces both.
//   .tif   GeoTIFF like orthophoto.tif (products/map_products.h); item PREVIEW of its metadata says what it was made from
//   .png   north of the local frame up, transparent where there is no data
//   .json  like orthophoto.json, and "preview": what it was made from
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/gis/map_grid.h"
#include "core/scene/scene.h"

namespace skyquilt::products {

// What a preview was made from.
inline constexpr const char* kFromSparsePoints = "sparse points";
inline constexpr const char* kFromContext = "context";

// A map grid over the scene's box: cells of `finest_m` metres, or larger ones, so that there are at most max_cells (at least 16); rounded up to two
// digits.
gis::MapGrid PlanPreviewGrid(const scene::SceneInfo& info, double finest_m, double max_cells);

struct PreviewMap {
  gis::MapGrid grid;
  std::vector<uint8_t> rgba;  // grid.width * grid.height cells, row-major from the north: display values, and alpha 0 or 255
  double Filled() const;      // share of the cells with data
};

// made_from: one of the two above. Writes its three files, the .json last; each is complete or as it was. The .png has at most png_width columns.
// Returns its path. Throws base::InputError.
std::filesystem::path WritePreview(const scene::SceneInfo& info, const PreviewMap& map, const std::string& made_from,
                                   const std::filesystem::path& folder, int png_width);

struct FoundPreview {
  std::filesystem::path picture;  // the .png
  std::string made_from;
};
// Nothing when a file is missing or damaged.
std::optional<FoundPreview> FindPreview(const std::filesystem::path& folder, const std::string& made_from);
// All of them, the most detailed first.
std::vector<FoundPreview> FindPreviews(const std::filesystem::path& folder);
// Where nothing is to be removed, nothing is done. Throws base::InputError.
void RemovePreviews(const std::filesystem::path& folder);
// Whether the folder has an orthophoto, which previews must not stand beside.
bool HasOrthophoto(const std::filesystem::path& folder);

}  // namespace skyquilt::products
