#include "worker/robust/photo_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"

namespace skyquilt::worker {
namespace {

constexpr int kDepthCells = 2;            // cells between nodes whose distance is known
constexpr float kLeastOpacity = 0.85F;    // of a ray whose distance counts
constexpr double kSameSurface = 0.03;     // largest difference of two distances to one place, as a part of them
constexpr double kStepOfDistance = 0.05;  // nodes whose distances differ by a larger part are not interpolated

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PhotoViews::PhotoViews(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source, const brightness::Response& response,
                       int cell_px, const DepthCaster& caster, base::ThreadPool& threads)
    : survey_(survey), source_(source), cell_px_(cell_px), views_(survey.photos.size()) {
  threads.ParallelFor(static_cast<int64_t>(views_.size()), [&](int64_t task, int /*thread*/) {
    const auto i = static_cast<size_t>(task);
    const survey::Photo& photo = survey.photos[i];
    if (photo.is_test || base::CancelRequested()) return;
    PhotoView& view = views_[i];
    view.picture = MakeCellPicture(source, pixels, response, static_cast<int>(i), cell_px);
    view.eye = photo.cam_from_enu.OriginInSource();
    view.axis = photo.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  });
  for (size_t i = 0; i < views_.size(); ++i) {
    base::ThrowIfCancelled();
    if (!survey.photos[i].is_test) MeasureDistances(i, caster);
  }
}

void PhotoViews::MeasureDistances(size_t photo, const DepthCaster& caster) {
  PhotoView& view = views_[photo];
  const camera::Camera& camera = source_.CameraOf(static_cast<int>(photo));
  const int step = kDepthCells * cell_px_;
  view.depth_columns = (camera.width + step - 1) / step;
  const int rows = (camera.height + step - 1) / step;
  std::vector<render::Ray> rays(static_cast<size_t>(view.depth_columns) * static_cast<size_t>(rows));
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<size_t>(view.depth_columns)),
               row = static_cast<double>(i / static_cast<size_t>(view.depth_columns));
    const Eigen::Vector2d pixel(std::min((column + 0.5) * step, camera.width - 0.5), std::min((row + 0.5) * step, camera.height - 0.5));
    source_.RayThrough(static_cast<int>(photo), pixel, &rays[i].origin_enu, &rays[i].direction_enu);
    rays[i].pixel_pitch = static_cast<float>(step / camera.FocalX());
  }
  std::vector<render::RayColor> colors(rays.size());
  caster(rays, colors);
  view.distance_m.reserve(colors.size());
  for (const render::RayColor& color : colors) {
    view.distance_m.push_back(color.opacity >= kLeastOpacity ? color.depth_median : std::numeric_limits<float>::quiet_NaN());
  }
}

double PhotoViews::DistanceAt(size_t photo, const Eigen::Vector2d& pixel) const {
  const PhotoView& view = views_[photo];
  const int columns = view.depth_columns, rows = static_cast<int>(view.distance_m.size()) / std::max(1, columns);
  if (columns == 0 || rows == 0) return kNone;
  const Eigen::Vector2d node = pixel / static_cast<double>(kDepthCells * cell_px_) - Eigen::Vector2d::Constant(0.5);
  const auto clamped = [](double value, int n) { return std::clamp(value, 0.0, static_cast<double>(n - 1)); };
  const double x = clamped(node.x(), columns), y = clamped(node.y(), rows);
  const int left = std::min(static_cast<int>(x), std::max(0, columns - 2)), top = std::min(static_cast<int>(y), std::max(0, rows - 2));
  const auto at = [&](int column, int row) {
    return static_cast<double>(view.distance_m[static_cast<size_t>(std::min(row, rows - 1)) * static_cast<size_t>(columns) +
                                               static_cast<size_t>(std::min(column, columns - 1))]);
  };
  const std::array<double, 4> around = {at(left, top), at(left + 1, top), at(left, top + 1), at(left + 1, top + 1)};
  const auto [low, high] = std::ranges::minmax(around);
  const double u = x - left, v = y - top;
  const bool all_known = std::ranges::all_of(around, [](double d) { return std::isfinite(d); });
  // Across an edge there is nothing between the two surfaces.
  if (!all_known || high - low > kStepOfDistance * high) return around[(u < 0.5 ? 0U : 1U) + (v < 0.5 ? 0U : 2U)];
  return (1.0 - v) * ((1.0 - u) * around[0] + u * around[1]) + v * ((1.0 - u) * around[2] + u * around[3]);
}

std::optional<PlaceSighting> PhotoViews::Look(size_t photo, const Eigen::Vector3d& place, const CellPicture::Cell& cell,
                                              const CellPicture::Range& around, bool visible) const {
  const PhotoView& view = views_[photo];
  const std::optional<Eigen::Vector2d> pixel = source_.CameraOf(static_cast<int>(photo)).ImgFromCam(survey_.photos[photo].cam_from_enu * place);
  if (!pixel) return std::nullopt;
  const Eigen::Vector2d in_cells = *pixel / static_cast<double>(cell_px_);
  if (!(in_cells.x() >= 1.0 && in_cells.y() >= 1.0 && in_cells.x() < view.picture.columns - 2 && in_cells.y() < view.picture.rows - 2)) {
    return std::nullopt;
  }
  if (visible) {
    const double distance = (place - view.eye).norm(), seen = DistanceAt(photo, *pixel);
    if (!(std::abs(seen - distance) <= kSameSurface * distance)) return std::nullopt;
  }
  const int column = static_cast<int>(in_cells.x()), row = static_cast<int>(in_cells.y());
  const CellPicture::Range range = view.picture.RangeAround(column, row);
  if (!range.usable) return std::nullopt;
  const CellPicture::Cell& here = view.picture.At(column, row);
  PlaceSighting sighting;
  for (size_t c = 0; c < 3; ++c) sighting.rgb[c] = static_cast<float>(here.rgb[c]) / CellPicture::kUnits;
  sighting.own = static_cast<float>(range.Outside(cell.rgb)) / CellPicture::kUnits;
  sighting.place = static_cast<float>(around.Outside(here.rgb)) / CellPicture::kUnits;
  return sighting;
}

}  // namespace skyquilt::worker
