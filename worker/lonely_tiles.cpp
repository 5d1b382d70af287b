#include "worker/lonely_tiles.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr double kPointsPerCell = 16.0;
constexpr int kMostCells = 256;    // along an axis
constexpr double kStrays = 0.002;  // share of points on each side that does not stretch the grid

double QuantileOf(const std::vector<survey::SparsePoint>& points, int axis, double share) {
  std::vector<double> values;
  for (const survey::SparsePoint& point : points) values.push_back(point.x_in_enu[axis]);
  const auto at = values.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

render::PlanSurface SurfaceOfPoints(const survey::Survey& survey) {
  if (survey.points.empty()) return {};
  Eigen::Vector2d low, high;
  for (int axis = 0; axis < 2; ++axis) {
    low[axis] = QuantileOf(survey.points, axis, kStrays);
    high[axis] = QuantileOf(survey.points, axis, 1.0 - kStrays);
  }
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
  const double cell_m = std::max(std::sqrt(kPointsPerCell * size.prod() / static_cast<double>(survey.points.size())), size.maxCoeff() / kMostCells);
  const int columns = static_cast<int>(size.x() / cell_m) + 1, rows = static_cast<int>(size.y() / cell_m) + 1;
  std::vector<std::vector<double>> in_cell(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (const survey::SparsePoint& point : survey.points) {
    const Eigen::Vector2d at = (point.x_in_enu.head<2>() - low) / cell_m;
    if (!(at.minCoeff() >= 0.0 && at.x() < columns && at.y() < rows)) continue;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    in_cell[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)].push_back(point.x_in_enu.z());
  }
  std::vector<double> heights(in_cell.size(), 0.0), known(in_cell.size(), 0.0);
  for (size_t i = 0; i < in_cell.size(); ++i) {
    std::vector<double>& z = in_cell[i];
    if (z.empty()) continue;
    const auto middle = z.begin() + static_cast<ptrdiff_t>(z.size() / 2);
    std::nth_element(z.begin(), middle, z.end());
    heights[i] = *middle;
    known[i] = 1.0;
  }
  render::FillFromSurroundings(columns, rows, 1, &heights, std::move(known));
  return {low.x(), low.y(), cell_m, columns, rows, std::move(heights)};
}

int CountViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const Eigen::Vector3d& x_in_enu,
               double radius_m, int enough) {
  int views = 0;
  for (const int photo : photos) {
    if (views >= enough) break;
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    const camera::Camera& camera = source.CameraOf(photo);
    const Eigen::Vector3d in_cam = survey.photos[static_cast<size_t>(photo)].cam_from_enu * x_in_enu;
    if (in_cam.z() < -radius_m || (radius_m <= 0.0 && in_cam.z() <= 0.0)) continue;
    if (in_cam.z() <= radius_m) {
      views += in_cam.norm() < 4.0 * radius_m ? 1 : 0;  // the ball surrounds the camera or nearly so
    } else if (const auto pixel = camera.ImgFromCam(in_cam)) {
      const double slack = camera.FocalX() * radius_m / in_cam.z();
      views += pixel->x() >= -slack && pixel->x() < camera.width + slack && pixel->y() >= -slack && pixel->y() < camera.height + slack ? 1 : 0;
    }
  }
  return views;
}

std::vector<Tile> TilesInCompany(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                 const render::PlanSurface& surface, int min_views) {
  std::vector<Tile> all = TrainingTiles(survey, photos);
  if (surface.Empty() || min_views < 2) return all;
  std::vector<Tile> kept;
  for (const Tile& tile : all) {
    Eigen::Vector3d origin, direction, x;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!surface.Meet(origin, direction, &x) || CountViews(source, survey, photos, x, 0.0, min_views) >= min_views) kept.push_back(tile);
  }
  return kept.empty() ? all : kept;
}

}  // namespace skyquilt::worker
