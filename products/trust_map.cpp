#include "products/trust_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "products/map_preview.h"
#include "products/place_metadata.h"

namespace skyquilt::products {
namespace {

constexpr float kNoData = -1.0F;
constexpr int kPreviewPixels = 2000;

gis::GeoTiffSpec SpecOf(const scene::SceneInfo& info, const gis::MapGrid& grid) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.type = gis::PixelType::kFloat32;
  spec.bands = 2;
  spec.nodata = static_cast<double>(kNoData);
  spec.band_names = {"expected error, root mean square of display values from 0 to 1", "training photos that show the place"};
  spec.metadata = PlaceMetadata(info, "Trust");
  spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
  return spec;
}

// Rows of a map as a picture of rays; cells without a ray show nothing.
class RowPicture {
 public:
  RowPicture(int width, int rows) : width_(static_cast<size_t>(width)) {
    render::RayColor nothing;
    nothing.depth_median = std::numeric_limits<float>::quiet_NaN();
    colors_.assign(width_ * static_cast<size_t>(rows), nothing);
    rays_.resize(colors_.size());
  }
  void Add(int row, const MapRays& of_row, const gis::MapGrid& grid, int first_row, const std::optional<gis::Boundary>& boundary) {
    for (size_t i = 0; i < of_row.rays.size(); ++i) {
      if (boundary && !boundary->Contains(grid.CellCentre(of_row.column[i], first_row + row))) continue;
      cell_.push_back(static_cast<size_t>(row) * width_ + static_cast<size_t>(of_row.column[i]));
      rays_[cell_.back()] = of_row.rays[i];
    }
  }
  // Calls the caster with at most so many rays.
  void Render(const RayCaster& caster, size_t rays_per_call) {
    std::vector<render::Ray> rays;
    std::vector<render::RayColor> colors;
    for (size_t begin = 0; begin < cell_.size(); begin += rays_per_call) {
      const size_t end = std::min(begin + rays_per_call, cell_.size());
      rays.clear();
      for (size_t i = begin; i < end; ++i) rays.push_back(rays_[cell_[i]]);
      colors.assign(rays.size(), {});
      caster(rays, colors);
      for (size_t i = begin; i < end; ++i) colors_[cell_[i]] = colors[i - begin];
    }
  }
  std::span<const render::RayColor> colors() const { return colors_; }
  void CopyRow(int row, std::span<render::Ray> out) const {
    std::copy_n(rays_.begin() + static_cast<std::ptrdiff_t>(static_cast<size_t>(row) * width_), out.size(), out.begin());
  }

 private:
  size_t width_;
  std::vector<render::Ray> rays_;
  std::vector<render::RayColor> colors_;
  std::vector<size_t> cell_;  // that have a ray
};

}  // namespace

std::filesystem::path WriteTrustMap(const trust::Trust& trust, const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options,
                                    const std::filesystem::path& folder, base::ThreadPool& threads) {
  gis::MapGrid grid = PlanMapGrid(info, options);
  const std::optional<gis::Boundary> boundary = BoundaryOf(grid, options);
  if (boundary) grid = CropTo(grid, *boundary);
  base::RequireWritableFolder(folder);
  const std::filesystem::path file = folder / "trust.tif";
  gis::GeoTiffWriter writer(file, SpecOf(info, grid));
  const MapRayGenerator generator(info, grid);
  base::Progress progress("trust map", static_cast<double>(grid.width) * grid.height, "cells");
  MapRays row_rays;
  std::vector<float> values;
  for (int first_row = 0; first_row < grid.height; first_row += gis::GeoTiffWriter::kTile) {
    base::ThrowIfCancelled();
    const int n_rows = std::min(gis::GeoTiffWriter::kTile, grid.height - first_row);
    RowPicture picture(grid.width, n_rows);
    for (int row = 0; row < n_rows; ++row) {
      generator.MakeRow(first_row + row, &row_rays);
      picture.Add(row, row_rays, grid, first_row, boundary);
    }
    picture.Render(caster, RaysPerCall(1));
    const trust::TrustPicture found = trust::TrustOf(
        trust, grid.width, n_rows, picture.colors(), [&](int row, std::span<render::Ray> out) { picture.CopyRow(row, out); }, threads);
    values.clear();
    for (size_t i = 0; i < found.error.data.size(); ++i) {
      const bool known = std::isfinite(found.error.data[i]);
      values.push_back(known ? found.error.data[i] : kNoData);
      values.push_back(known ? found.photos.data[i] : kNoData);
    }
    writer.WriteRows(first_row, n_rows, std::span<const float>(values));
    progress.Update(static_cast<double>(first_row + n_rows) * grid.width);
  }
  writer.Close();
  progress.Finish();
  WriteTrustPicture(info, grid, file, folder / "trust.png", kPreviewPixels);
  return file;
}

}  // namespace skyquilt::products
