#include "products/map_products.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/gis/geotiff.h"
#include "core/scene/map_heights.h"
#include "products/height_shift.h"
#include "products/map_area.h"
#include "products/map_cells.h"
#include "products/map_preview.h"
#include "products/place_metadata.h"
#include "products/preview_files.h"

namespace skyquilt::products {
namespace {

constexpr double kFinerThanScene = 0.8;  // cells up to this share of the scene's detail are not all rendered

gis::GeoTiffSpec DsmSpec(const scene::SceneInfo& info, const scene::MapHeights& heights, const gis::MapGrid& grid) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.type = gis::PixelType::kFloat32;
  spec.nodata = static_cast<double>(kNoHeight);
  spec.band_names = {!grid.georeferenced                                       ? "local height"
                     : heights.reference() == geo::HeightReference::kEllipsoid ? "ellipsoidal height"
                                                                               : "height"};
  spec.unit = "m";
  spec.heights = heights.reference();
  spec.metadata = PlaceMetadata(info, "Digital surface model");
  spec.metadata.merge(heights.Metadata());
  spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
  return spec;
}

// How well the cells of the products' grid are filled.
void Count(const RenderedCells& counts, MapProducts* products) {
  products->rays = counts.rays;
  products->filled = counts.inside > 0 ? static_cast<double>(counts.filled) / static_cast<double>(counts.inside) : 0.0;
}

// Heights of rows as the surface model has them.
class DsmWriter {
 public:
  DsmWriter(const scene::SceneInfo& info, const gis::MapGrid& grid, const ProductOptions& options, const std::filesystem::path& file)
      : heights_(info, geo::VerticalNamed(options.vertical)), shift_(heights_, grid), writer_(file, DsmSpec(info, heights_, grid)) {
    if (!heights_.Caution().empty()) base::LogWarning("{}", heights_.Caution());
  }
  // Consecutive rows from the first on; kNoHeight without data. Changes them.
  void WriteRows(int first_row, int n_rows, std::vector<float>* height_m) {
    shift_.AddTo(first_row, kNoHeight, *height_m);
    writer_.WriteRows(first_row, n_rows, std::span<const float>(*height_m));
  }
  void Close() { writer_.Close(); }

 private:
  scene::MapHeights heights_;
  HeightShift shift_;
  gis::GeoTiffWriter writer_;
};

// Both maps as the scene shows them, some rows in memory at a time.
void RenderToFiles(const scene::SceneInfo& info, const MapCasting& casting, const std::optional<gis::Boundary>& boundary,
                   const ProductOptions& options, MapProducts* products) {
  std::optional<gis::GeoTiffWriter> ortho;
  std::optional<DsmWriter> dsm;
  if (options.ortho) ortho.emplace(products->orthophoto, OrthophotoSpec(info, products->grid, "Orthophoto"));
  if (options.dsm) dsm.emplace(info, products->grid, options, products->dsm);
  const MapRowSink write = [&](int first_row, int n_rows, PaintedCells& band) {
    if (ortho) ortho->WriteRows(first_row, n_rows, std::span<const uint8_t>(band.rgba));
    if (dsm) dsm->WriteRows(first_row, n_rows, &band.place);
  };
  Count(RenderMapCells(info, products->grid, casting, boundary, options.ortho ? "orthophoto" : "surface model", write), products);
  if (ortho) ortho->Close();
  if (dsm) dsm->Close();
}

void WriteFieldOrthophoto(const scene::SceneInfo& info, const FieldMap& field, const std::filesystem::path& file) {
  gis::GeoTiffWriter ortho(file, OrthophotoSpec(info, field.grid, "Orthophoto"));
  for (int first_row = 0; first_row < field.grid.height; first_row += gis::GeoTiffWriter::kTile) {
    const int n_rows = std::min(gis::GeoTiffWriter::kTile, field.grid.height - first_row);
    ortho.WriteRows(first_row, n_rows, std::span(field.rgba).subspan(4 * field.grid.Index(0, first_row), 4 * field.grid.Index(0, n_rows)));
  }
  ortho.Close();
}

// Height of one cell of the surface model, of those of finer cells within it (changed): the upper middle one, so that a cell on the edge of a roof
// has the height of the roof or of the ground and none between; kNoHeight if most have none.
float HeightOfCell(std::vector<float>* finite, size_t cells) {
  if (2 * finite->size() < cells || finite->empty()) return kNoHeight;
  const auto middle = finite->begin() + static_cast<std::ptrdiff_t>(finite->size() / 2);
  std::nth_element(finite->begin(), middle, finite->end());
  return *middle;
}

// The surface in cells of the given grid, which are as large as the field's or larger. Cells outside one of the boundaries have no data.
void WriteFieldDsm(const scene::SceneInfo& info, const FieldMap& field, const gis::MapGrid& grid, std::span<const gis::Boundary> boundaries,
                   const ProductOptions& options, const std::filesystem::path& file) {
  DsmWriter dsm(info, grid, options, file);
  std::vector<uint8_t> inside(grid.size(), 1);
  for (const gis::Boundary& boundary : boundaries) {
    const std::vector<uint8_t> mask = boundary.Mask(grid);
    for (size_t cell = 0; cell < inside.size(); ++cell) inside[cell] &= mask[cell];
  }
  const double scale = grid.resolution_m / field.grid.resolution_m;
  const double column_offset = (grid.left - field.grid.left) / field.grid.resolution_m;
  const double row_offset = (field.grid.top - grid.top) / field.grid.resolution_m;
  const auto bound = [scale](double offset, int index, int limit) {
    return std::clamp(static_cast<int>(std::lround(offset + scale * index)), 0, limit);
  };
  std::vector<float> rows;
  std::vector<float> finite;
  for (int first_row = 0; first_row < grid.height; first_row += gis::GeoTiffWriter::kTile) {
    const int n_rows = std::min(gis::GeoTiffWriter::kTile, grid.height - first_row);
    rows.assign(grid.Index(0, n_rows), kNoHeight);
    for (int row = first_row; row < first_row + n_rows; ++row) {
      const int begin_row = bound(row_offset, row, field.grid.height);
      const int end_row = bound(row_offset, row + 1, field.grid.height);
      for (int column = 0; column < grid.width; ++column) {
        if (inside[grid.Index(column, row)] == 0) continue;
        const int begin_column = bound(column_offset, column, field.grid.width);
        const int end_column = bound(column_offset, column + 1, field.grid.width);
        finite.clear();
        for (int y = begin_row; y < end_row; ++y) {
          for (int x = begin_column; x < end_column; ++x) {
            if (const float height_m = field.height_m[field.grid.Index(x, y)]; std::isfinite(height_m)) finite.push_back(height_m);
          }
        }
        const auto cells = static_cast<size_t>(end_row - begin_row) * static_cast<size_t>(end_column - begin_column);
        rows[grid.Index(column, row - first_row)] = HeightOfCell(&finite, cells);
      }
    }
    dsm.WriteRows(first_row, n_rows, &rows);
  }
  dsm.Close();
}

// The scene as it is seen straight down is the surface that the photos are laid on, so it is kept in memory. The surface model has cells of
// dsm_grid, those of the other maps of heights.
void PaintFromPhotos(const scene::SceneInfo& info, MapCasting casting, const std::optional<gis::Boundary>& boundary, const gis::MapGrid& dsm_grid,
                     const ProductOptions& options, const MapPhotos& photos, const std::filesystem::path& folder, MapProducts* products) {
  const gis::MapGrid& grid = products->grid;
  FieldMap field{grid, std::vector<uint8_t>(4 * grid.size()), std::vector<float>(grid.size())};
  const MapRowSink keep = [&](int first_row, int /*n_rows*/, PaintedCells& band) {
    const auto begin = static_cast<std::ptrdiff_t>(grid.Index(0, first_row));
    std::copy(band.rgba.begin(), band.rgba.end(), field.rgba.begin() + 4 * begin);
    std::transform(band.place.begin(), band.place.end(), field.height_m.begin() + begin,
                   [](float height_m) { return height_m == kNoHeight ? std::numeric_limits<float>::quiet_NaN() : height_m; });
  };
  casting.every_second = grid.resolution_m <= kFinerThanScene * info.gsd_m;
  Count(RenderMapCells(info, grid, casting, boundary, "surface model", keep), products);
  products->painted = WritePhotoOrthophoto(info, photos, field, options, boundary, folder);
  if (!products->painted) WriteFieldOrthophoto(info, field, products->orthophoto);
  if (!options.dsm) return;
  std::vector<gis::Boundary> boundaries;
  if (boundary) boundaries.push_back(*boundary);
  if (products->painted) boundaries.push_back(products->painted->cutline);
  WriteFieldDsm(info, field, dsm_grid, boundaries, options, products->dsm);
}

}  // namespace

size_t PictureMemory(double limit_bytes) {
  return static_cast<size_t>(std::clamp(0.25 * limit_bytes, 64e6, 1.5e9));
}

void LogMaps(const MapProducts& made, const std::filesystem::path& folder) {
  if (!made.painted) {
    base::LogInfo("map of {} x {} cells of {:.3g} m, {:.0f} % filled: {}", made.grid.width, made.grid.height, made.grid.resolution_m,
                  100.0 * made.filled, folder.string());
    return;
  }
  const double field_share = static_cast<double>(made.painted->field_cells) / static_cast<double>(std::max<int64_t>(made.painted->cells, 1));
  base::LogInfo("orthophoto of {} x {} cells of {:.3g} m from {} photos, {:.2g} % of it from the trained scene where no photo sees the surface: {}",
                made.grid.width, made.grid.height, made.grid.resolution_m, made.painted->photos, 100.0 * field_share, made.orthophoto.string());
}

MapProducts MakeMapProducts(const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options, const std::filesystem::path& folder,
                            const MapPhotos* photos, size_t rays_per_call) {
  const MapCasting casting{caster, rays_per_call, options.min_opacity};
  MapProducts products;
  const bool from_photos = options.ortho && photos != nullptr && options.ortho_source == "photos";
  products.grid = from_photos ? PlanPhotoSurfaceGrid(info, options) : PlanMapGrid(info, options);
  gis::MapGrid dsm_grid = from_photos ? PlanHeightGrid(info, options) : products.grid;
  if (!options.ortho && !options.dsm) return products;
  const std::optional<gis::Boundary> boundary = BoundaryOf(products.grid, options);
  if (boundary) {
    products.grid = CropTo(products.grid, *boundary);
    dsm_grid = CropTo(dsm_grid, *boundary);
  }
  base::RequireWritableFolder(folder);
  if (!products.grid.georeferenced)
    base::LogWarning(
        "the survey has no geo-reference, so orthophoto and surface model are in local coordinates without CRS; use photos with GPS tags");
  if (options.ortho) products.orthophoto = folder / "orthophoto.tif";
  if (options.dsm) products.dsm = folder / "dsm.tif";
  if (from_photos) {
    PaintFromPhotos(info, casting, boundary, dsm_grid, options, *photos, folder, &products);
  } else {
    RenderToFiles(info, casting, boundary, options, &products);
  }
  if (products.painted) {
    products.grid = products.painted->grid;
  } else if (options.ortho) {
    // Files that only an orthophoto from photos has, of an earlier run.
    for (const char* name : {"ortho_sources.tif", "ortho_sources.json", "cutline.gpkg"}) std::filesystem::remove(folder / name);
  }
  WriteMapPreviews(info, products.grid, products.orthophoto, dsm_grid, products.dsm, folder, kPreviewWidth);
  if (options.ortho) RemovePreviews(folder);
  return products;
}

MapProducts MakeMapProducts(const scene::Scene& scene, const ProductOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads,
                            const MapPhotos* photos) {
  return MakeMapProducts(scene.info(), CasterOf(scene, AppearanceOf(options.exposure, scene.info()), threads), options, folder, photos,
                         RaysPerCall(scene.statistics().ranks));
}

}  // namespace skyquilt::products
