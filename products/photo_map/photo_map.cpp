#include "products/photo_map/photo_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "products/photo_map/measure_light.h"
#include "products/photo_map/tile_painter.h"

namespace skyquilt::products {
namespace {

constexpr int kTileColumns = 1024;
constexpr double kSmallPixelsPerNode = 1.0;
constexpr double kPixelsPerCell = 1.6;  // along an axis: photos that are finer are reduced

// Photos reduced to about pixels_per_cell pixels per cell of cell_m metres on the ground.
survey::PhotoPictures PicturesFor(const PhotoMapInput& input, double cell_m, double pixels_per_cell) {
  const auto read = [&survey = input.survey, shading = input.shading, ground_z = input.ground_z, cell_m, pixels_per_cell](size_t photo) {
    const survey::Photo& source = survey.photos[photo];
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(source.camera)];
    const double gsd_m = camera::GroundSamplingDistance(camera, std::max(source.cam_from_enu.OriginInSource().z() - ground_z, 1e-6));
    const double width = std::ceil(pixels_per_cell * camera.width * gsd_m / cell_m);
    survey::PhotoPicture picture = survey::ReadPhotoPicture(survey, photo, static_cast<int>(std::min<double>(camera.width, width)));
    brightness::DivideByShading(shading, photo, picture.rgb);
    return picture;
  };
  return {input.survey.photos.size(), read, input.picture_bytes};
}

}  // namespace

PhotoMap::PhotoMap(const PhotoMapInput& input, PhotoLight light, MapNodes nodes)
    : input_(input),
      light_(std::move(light)),
      nodes_(std::move(nodes)),
      pictures_(PicturesFor(input, input.grid.resolution_m, kPixelsPerCell)),
      eyes_map_(EyesOnMap(input.survey, input.projection)) {
  SKYQUILT_CHECK(input.survey.photos.size() <= kMostMapPhotos, std::to_string(input.survey.photos.size()) + " photos");
}

PhotoMap::PhotoMap(const PhotoMapInput& input, base::ThreadPool& threads) : PhotoMap(input, PhotoLight{}, MapNodes{}) {
  survey::PhotoPictures small = PicturesFor(input, kNodeCells * input.grid.resolution_m, kSmallPixelsPerNode);
  light_ = MeasureLight(input_, small, threads);
  nodes_ = ChoosePhotosOfNodes(input_, light_, small, threads);
  failures_ = small.Failures();
}

void PhotoMap::PaintRows(int first_row, int n_rows, base::ThreadPool& threads, PhotoMapRows* rows) {
  SKYQUILT_CHECK(n_rows >= 1 && n_rows <= kRows, std::to_string(n_rows) + " rows");
  const auto width = static_cast<size_t>(input_.grid.width);
  rows->rgba.assign(4 * width * static_cast<size_t>(n_rows), 0);
  rows->sources.assign(width * static_cast<size_t>(n_rows), kNoSource);
  const std::vector<TileArea> tiles = TilesOf(input_.grid, first_row, n_rows);
  threads.ParallelFor(static_cast<int64_t>(tiles.size()), [&](int64_t task, int /*thread*/) {
    const TileArea& tile = tiles[static_cast<size_t>(task)];
    Paint(tile, rows->rgba.data() + 4 * static_cast<size_t>(tile.column), rows->sources.data() + tile.column, width);
  });
}

std::vector<TileArea> PhotoMap::TilesOf(const gis::MapGrid& grid, int first_row, int n_rows) {
  std::vector<TileArea> tiles;
  for (int column = 0; column < grid.width; column += kTileColumns) {
    tiles.push_back({column, first_row, std::min(kTileColumns, grid.width - column), n_rows});
  }
  return tiles;
}

void PhotoMap::PaintTile(const TileArea& tile, PhotoMapRows* cells) {
  cells->rgba.assign(4 * tile.size(), 0);
  cells->sources.assign(tile.size(), kNoSource);
  Paint(tile, cells->rgba.data(), cells->sources.data(), static_cast<size_t>(tile.columns));
}

void PhotoMap::Paint(const TileArea& tile, uint8_t* rgba, uint16_t* sources, size_t row_cells) {
  base::ThrowIfCancelled();
  TilePainter(input_, nodes_, light_, eyes_map_, pictures_, tile).Paint(rgba, sources, row_cells);
}

}  // namespace skyquilt::products
