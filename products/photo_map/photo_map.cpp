#include "products/photo_map/photo_map.h"

#include <algorithm>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "products/photo_map/measure_light.h"
#include "products/photo_map/tile_painter.h"

namespace skyquilt::products {
namespace {

constexpr int kTileColumns = 1024;
constexpr double kSmallPixelsPerNode = 1.0;
constexpr double kPixelsPerCell = 1.6;  // along an axis: photos that are finer are reduced

}  // namespace

PhotoMap::PhotoMap(const PhotoMapInput& input, base::ThreadPool& threads)
    : input_(input), pictures_(input.survey, input.ground_z, input.grid.resolution_m, kPixelsPerCell, input.picture_bytes) {
  SKYQUILT_CHECK(input.survey.photos.size() <= kMostMapPhotos, std::to_string(input.survey.photos.size()) + " photos");
  PhotoPictures small(input.survey, input.ground_z, kNodeCells * input.grid.resolution_m, kSmallPixelsPerNode, input.picture_bytes);
  light_ = MeasureLight(input_, small, threads);
  nodes_ = ChoosePhotosOfNodes(input_, light_, small, threads);
  failures_ = small.Failures();
}

void PhotoMap::PaintRows(int first_row, int n_rows, base::ThreadPool& threads, PhotoMapRows* rows) {
  SKYQUILT_CHECK(n_rows >= 1 && n_rows <= kRows, std::to_string(n_rows) + " rows");
  const auto width = static_cast<size_t>(input_.grid.width);
  rows->rgba.assign(4 * width * static_cast<size_t>(n_rows), 0);
  rows->sources.assign(width * static_cast<size_t>(n_rows), kNoSource);
  const std::vector<Eigen::Vector3d> eyes_map = EyesOnMap(input_.survey, input_.projection);
  threads.ParallelFor((input_.grid.width + kTileColumns - 1) / kTileColumns, [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const int column = static_cast<int>(task) * kTileColumns;
    const TileArea core{column, first_row, std::min(kTileColumns, input_.grid.width - column), n_rows};
    TilePainter painter(input_, nodes_, light_, eyes_map, pictures_, core);
    painter.Paint(rows->rgba.data() + 4 * static_cast<size_t>(column), rows->sources.data() + column, width);
  });
}

}  // namespace skyquilt::products
