#include "products/photo_map/photo_orthophoto.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/base/text.h"
#include "core/gis/geotiff.h"
#include "products/map_area.h"
#include "products/map_rays.h"
#include "products/photo_map/map_edge.h"
#include "products/photo_map/paint_job.h"
#include "products/photo_map/painted_rows.h"
#include "products/photo_map/photo_map.h"
#include "products/place_metadata.h"

namespace skyquilt::products {
namespace {

constexpr int kFewestViews = 2;     // of the ground inside the cutline
constexpr double kStepCells = 9.0;  // heights of neighbouring cells that differ by more are a step: a roof's edge
constexpr int kHoleCells = 60;      // from a cell without a surface to those with one

// Heights of ground and roof meet in the cells between them, where the field shows neither. Each such cell is given to the nearer of the two, so that
// no wall is drawn as a slope.
std::vector<float> WithSharpSteps(const FieldMap& field, base::ThreadPool& threads) {
  const gis::MapGrid& grid = field.grid;
  const auto step_m = static_cast<float>(kStepCells * grid.resolution_m);
  std::vector<float> sharp = field.height_m;
  threads.ParallelFor(grid.height, [&](int64_t task, int /*thread*/) {
    const int row = static_cast<int>(task);
    for (int column = 0; column < grid.width; ++column) {
      const float here = field.height_m[grid.Index(column, row)];
      if (!std::isfinite(here)) continue;
      float low = here, high = here;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.height - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.width - 1); ++x) {
          const float height = field.height_m[grid.Index(x, y)];
          if (!std::isfinite(height)) continue;
          low = std::min(low, height);
          high = std::max(high, height);
        }
      }
      if (high - low > step_m) sharp[grid.Index(column, row)] = here - low < high - here ? low : high;
    }
  });
  return sharp;
}

// The field has no surface in some cells, as in deep shadow between trees, but photos show what is there. A hole has heights within kHoleCells in all
// four directions, and gets their mean, the nearer the more.
void FillHoles(const gis::MapGrid& grid, std::vector<float>* height_m, base::ThreadPool& threads) {
  const std::vector<float> given = *height_m;
  threads.ParallelFor(grid.height, [&](int64_t task, int /*thread*/) {
    const int row = static_cast<int>(task);
    for (int column = 0; column < grid.width; ++column) {
      if (std::isfinite(given[grid.Index(column, row)])) continue;
      double weights = 0.0, sum = 0.0;
      bool enclosed = true;
      for (const auto& [step_x, step_y] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
        bool found = false;
        for (int n = 1; n <= kHoleCells && !found; ++n) {
          const int x = column + n * step_x, y = row + n * step_y;
          if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) break;
          const auto height = static_cast<double>(given[grid.Index(x, y)]);
          found = std::isfinite(height);
          if (!found) continue;
          sum += height / n;
          weights += 1.0 / n;
        }
        enclosed = enclosed && found;
        if (!enclosed) break;
      }
      if (enclosed) (*height_m)[grid.Index(column, row)] = static_cast<float>(sum / weights);
    }
  });
}

std::vector<double> GroundHeights(const scene::SceneInfo& info, const FieldMap& field) {
  const gis::MapProjection projection(info.origin, field.grid);
  std::vector<double> z;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(field.grid.size()) / 10000.0)));
  for (int row = 0; row < field.grid.height; row += step) {
    for (int column = 0; column < field.grid.width; column += step) {
      const float height_m = field.height_m[field.grid.Index(column, row)];
      if (!std::isfinite(height_m)) continue;
      const gis::MapProjection::VerticalLine line = projection.VerticalLineAt(field.grid.CellCentre(column, row));
      z.push_back((line.start_enu + (projection.start_height_m() - static_cast<double>(height_m)) * line.down_enu).z());
    }
  }
  return z;
}

double FlownHeight(const survey::Survey& survey, double ground_z) {
  std::vector<double> heights;
  for (const survey::Photo& photo : survey.photos) {
    const double height_m = photo.cam_from_enu.OriginInSource().z() - ground_z;
    if (height_m > 0.0) heights.push_back(height_m);
  }
  return base::Median(heights);
}

gis::GeoTiffSpec SourcesSpec(const scene::SceneInfo& info, const gis::MapGrid& grid) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.type = gis::PixelType::kUint16;
  spec.labels = true;
  spec.nodata = kNoSource;
  spec.band_names = {"source: 1 trained field, 2 + i photo i, see ortho_sources.json"};
  spec.metadata = PlaceMetadata(info, "Photo that each cell of the orthophoto comes from");
  spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
  return spec;
}

int RowsOfPart(const gis::MapGrid& grid, int first_row) {
  return std::min(PhotoMap::kRows, grid.height - first_row);
}

// Paints all parts that are missing. Those that are not complete at an interruption are lost.
void PaintElsewhere(const PhotoMapInput& input, const geo::Geodetic& origin, const PhotoMap& map, const std::filesystem::path& parts_folder,
                    TileService& service, PaintedRows& painted) {
  const gis::MapGrid& grid = input.grid;
  std::vector<TileArea> tiles;
  for (int first_row = 0; first_row < grid.height; first_row += PhotoMap::kRows) {
    if (painted.Stands(first_row)) continue;
    const std::vector<TileArea> more = PhotoMap::TilesOf(grid, first_row, RowsOfPart(grid, first_row));
    tiles.insert(tiles.end(), more.begin(), more.end());
  }
  if (tiles.empty()) return;
  struct Part {
    PhotoMapRows rows;
    int columns = 0;  // that are painted
  };
  std::map<int, Part> open;  // by first row
  base::Progress progress("painting", static_cast<double>(grid.width) * grid.height, "cells");
  double done = 0.0;
  const std::filesystem::path job = parts_folder / "job";
  WritePaintJob(input, origin, map, job);
  service.Paint(job, tiles, [&](size_t index, PhotoMapRows cells) {
    const TileArea& tile = tiles[index];
    SKYQUILT_CHECK(cells.rgba.size() == 4 * tile.size() && cells.sources.size() == tile.size(), "a tile comes back whole");
    Part& part = open[tile.row];
    part.rows.rgba.resize(4 * grid.Index(0, tile.rows));
    part.rows.sources.resize(grid.Index(0, tile.rows));
    for (int row = 0; row < tile.rows; ++row) {
      const auto from = static_cast<std::ptrdiff_t>(tile.columns) * row;
      const auto to = static_cast<std::ptrdiff_t>(grid.Index(tile.column, row));
      std::copy_n(cells.rgba.begin() + 4 * from, 4 * tile.columns, part.rows.rgba.begin() + 4 * to);
      std::copy_n(cells.sources.begin() + from, tile.columns, part.rows.sources.begin() + to);
    }
    part.columns += tile.columns;
    if (part.columns == grid.width) {
      painted.Write(tile.row, part.rows);
      open.erase(tile.row);
    }
    progress.Update(done += static_cast<double>(tile.size()));
  });
  std::filesystem::remove(job);
  progress.Finish();
}

void WriteSources(const survey::Survey& survey, const PhotoOrthophoto& made, const std::vector<int64_t>& cells_of,
                  const std::filesystem::path& file) {
  nlohmann::ordered_json photos = nlohmann::ordered_json::object();
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const int64_t cells = cells_of[kFirstPhotoSource + i];
    if (cells > 0) photos[survey.photos[i].name] = {{"value", kFirstPhotoSource + i}, {"cells", cells}};
  }
  const nlohmann::ordered_json sources = {
      {"cell_m", made.grid.resolution_m}, {"cells", made.cells}, {"field_cells", made.field_cells}, {"photos", photos}};
  base::WriteFileAtomically(file, base::JsonText(sources, 1) + "\n");
}

}  // namespace

double PhotoResolution(const survey::Survey& survey, double ground_z) {
  std::vector<double> gsd_m;
  for (const survey::Photo& photo : survey.photos) {
    const double height_m = photo.cam_from_enu.OriginInSource().z() - ground_z;
    if (height_m > 0.0) gsd_m.push_back(camera::GroundSamplingDistance(survey.cameras[static_cast<size_t>(photo.camera)], height_m));
  }
  return gsd_m.empty() ? std::numeric_limits<double>::quiet_NaN() : NiceResolution(base::Median(gsd_m));
}

std::optional<PhotoOrthophoto> WritePhotoOrthophoto(const scene::SceneInfo& info, const MapPhotos& photos, const FieldMap& field,
                                                    const ProductOptions& options, const std::optional<gis::Boundary>& boundary,
                                                    const std::filesystem::path& folder) {
  const survey::Survey& survey = photos.survey;
  base::ThreadPool& threads = photos.threads;
  const std::vector<double> ground = GroundHeights(info, field);
  const double ground_z = ground.empty() ? std::numeric_limits<double>::quiet_NaN() : base::Median(ground);
  const double photo_resolution_m = PhotoResolution(survey, ground_z);
  if (!std::isfinite(photo_resolution_m)) {
    base::LogWarning("no photo looks down on the ground, so the orthophoto is drawn from the trained scene");
    return std::nullopt;
  }
  std::vector<char> usable;
  for (const survey::Photo& photo : survey.photos) usable.push_back(photo.is_test ? 0 : 1);
  const auto n_usable = static_cast<size_t>(std::count(usable.begin(), usable.end(), 1));

  PhotoOrthophoto made{.cutline = gis::Boundary({})};
  ProductOptions fine = options;
  if (fine.resolution_m <= 0.0) fine.resolution_m = std::min(photo_resolution_m, field.grid.resolution_m);
  made.grid = PlanMapGrid(info, fine);
  if (boundary) made.grid = CropTo(made.grid, *boundary);
  const gis::MapGrid& grid = made.grid;
  const gis::MapProjection projection(info.origin, grid);
  std::vector<float> heights = WithSharpSteps(field, threads);
  FillHoles(field.grid, &heights, threads);
  const HeightGrid surface(field.grid, std::move(heights));
  const std::vector<float> slack_m = SightSlack(surface, threads);
  const PhotoMapInput input{.survey = survey,
                            .usable = usable,
                            .grid = grid,
                            .projection = projection,
                            .surface = surface,
                            .slack_m = slack_m,
                            .field_rgba = field.rgba,
                            .ground_z = ground_z,
                            .flown_height_m = FlownHeight(survey, ground_z),
                            .picture_bytes = photos.memory,
                            .shading = brightness::PhotoShading::Of(info.response)};
  PhotoMap map(input, threads);
  survey::WarnOfUnreadPhotos("the orthophoto", map.failures(), n_usable);
  made.unreadable = static_cast<int>(map.failures().size());
  if (map.failures().size() == n_usable) {
    base::LogWarning("no photo can be read, so the orthophoto is drawn from the trained scene. Put the photos back to {}, then run this again",
                     survey.photo_root.string());
    return std::nullopt;
  }
  const MapNodes& nodes = map.nodes();
  const gis::Boundary& cutline = made.cutline = gis::Boundary(CutlineOf({nodes.GridOf(grid), nodes.seen}, kFewestViews, options.crop_m));
  if (cutline.rings().empty()) {
    base::LogWarning("no ground is left that at least {} photos see{}, so the orthophoto is drawn from the trained scene", kFewestViews,
                     options.crop_m > 0.0 ? " when products.crop_m is cut off all round" : "");
    return std::nullopt;
  }

  std::optional<PaintedRows> painted;
  if (grid.height > PhotoMap::kRows) painted.emplace(folder / "orthophoto.parts", PaintKey(input));
  if (const int parts = painted ? painted->Count() : 0; parts > 0) {
    base::LogInfo("goes on with the orthophoto that was interrupted: {} of {} parts are painted", parts,
                  (grid.height + PhotoMap::kRows - 1) / PhotoMap::kRows);
  }
  const auto began = std::chrono::steady_clock::now();
  if (photos.elsewhere != nullptr && painted) PaintElsewhere(input, info.origin, map, folder / "orthophoto.parts", *photos.elsewhere, *painted);
  gis::GeoTiffWriter ortho(folder / "orthophoto.tif", OrthophotoSpec(info, grid, "Orthophoto"));
  gis::GeoTiffWriter sources(folder / "ortho_sources.tif", SourcesSpec(info, grid));
  base::Progress progress("orthophoto", static_cast<double>(grid.width) * grid.height, "cells");
  std::vector<int64_t> cells_of(kFirstPhotoSource + survey.photos.size(), 0);
  PhotoMapRows rows;
  for (int first_row = 0; first_row < grid.height; first_row += PhotoMap::kRows) {
    const int n_rows = RowsOfPart(grid, first_row);
    if (!painted || !painted->Read(first_row, grid.Index(0, n_rows), &rows)) {
      map.PaintRows(first_row, n_rows, threads, &rows);
      if (painted) painted->Write(first_row, rows);
    }
    gis::MapGrid part = grid;
    part.top -= first_row * grid.resolution_m;
    part.height = n_rows;
    std::vector<uint8_t> inside = cutline.Mask(part);
    if (boundary) {
      const std::vector<uint8_t> wanted = boundary->Mask(part);
      std::transform(inside.begin(), inside.end(), wanted.begin(), inside.begin(), [](uint8_t a, uint8_t b) { return static_cast<uint8_t>(a & b); });
    }
    for (size_t cell = 0; cell < rows.sources.size(); ++cell) {
      if (inside[cell] == 0) {
        rows.sources[cell] = kNoSource;
        std::fill_n(rows.rgba.begin() + static_cast<std::ptrdiff_t>(4 * cell), 4, uint8_t{0});
      }
      ++cells_of[rows.sources[cell]];
    }
    ortho.WriteRows(first_row, n_rows, std::span<const uint8_t>(rows.rgba));
    sources.WriteRows(first_row, n_rows, std::span<const uint16_t>(rows.sources));
    progress.Update(static_cast<double>(first_row + n_rows) * grid.width);
  }
  ortho.Close();
  sources.Close();
  progress.Finish();
  made.painting_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  for (size_t i = kFromField; i < cells_of.size(); ++i) {
    made.cells += cells_of[i];
    if (i >= kFirstPhotoSource && cells_of[i] > 0) ++made.photos;
  }
  made.field_cells = cells_of[kFromField];
  WriteSources(survey, made, cells_of, folder / "ortho_sources.json");
  WriteCutline(cutline.rings(), grid, folder / "cutline.gpkg");
  if (painted) painted->Remove();
  return made;
}

}  // namespace skyquilt::products
