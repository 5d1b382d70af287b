#include <algorithm>
#include <cmath>
#include <vector>

#include "buildings/fit/fit_points.h"
#include "buildings/fit/fit_shape.h"
#include "buildings/fit/wall_strips.h"

namespace skyquilt::buildings {
namespace {

constexpr double kPiece_m = 0.5;
constexpr double kLeastWallShare_m = 0.3;
constexpr double kLeastViews = 3.0;

// Steep points near the line of a wall, along it and in height.
std::vector<Eigen::Vector2d> PointsNear(const Shape& shape, const WallPiece& wall, const std::vector<FitPoint>& points, double reach_m) {
  const Eigen::Vector2d out = wall.side * (wall.axis == 0 ? shape.AxisU() : shape.AxisV());
  std::vector<Eigen::Vector2d> near;
  for (const FitPoint& point : points) {
    if (point.views < kLeastViews || point.normal.head<2>().dot(out) <= 0.0) continue;
    const Eigen::Vector2d uv = InAxes(shape, point.place);
    if (std::abs(InFront(shape, wall, uv)) <= reach_m) near.emplace_back(uv[1 - wall.axis], point.z);
  }
  std::sort(near.begin(), near.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x(); });
  return near;
}

// Whether one of the points, sorted along the wall, is within reach_m of a rectangle around the place.
bool IsSeen(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& place, const Eigen::Vector2d& half, double reach_m) {
  const auto first = std::lower_bound(points.begin(), points.end(), place.x() - half.x() - reach_m,
                                      [](const Eigen::Vector2d& point, double along) { return point.x() < along; });
  for (auto point = first; point != points.end() && point->x() <= place.x() + half.x() + reach_m; ++point) {
    if (((*point - place).cwiseAbs() - half).cwiseMax(0.0).norm() <= reach_m) return true;
  }
  return false;
}

}  // namespace

double ShareOfWallSeen(const Shape& shape, const Candidate& candidate, const PointCloud& cloud, double gsd_m) {
  const FitPoints points = PointsFor(shape, candidate, cloud);
  double area = 0.0, seen = 0.0;
  for (const WallPiece& wall : WallPieces(shape, kLeastWallShare_m)) {
    if (!wall.outer) continue;
    const std::vector<Eigen::Vector2d> near = PointsNear(shape, wall, points.steep, 2.0 * gsd_m);
    const auto columns = std::max(1, static_cast<int>(std::ceil((wall.to - wall.from) / kPiece_m)));
    const double width = (wall.to - wall.from) / columns;
    for (int i = 0; i < columns; ++i) {
      const double along = wall.from + (i + 0.5) * width;
      const WallHeights heights = HeightsAt(shape, wall, along);
      const double height = heights.top - heights.bottom;
      if (!(height > 0.0)) continue;
      const auto rows = std::max(1, static_cast<int>(std::ceil(height / kPiece_m)));
      const Eigen::Vector2d half(0.5 * width, 0.5 * height / rows);
      for (int k = 0; k < rows; ++k) {
        area += width * height / rows;
        const Eigen::Vector2d place(along, heights.bottom + (k + 0.5) * height / rows);
        if (IsSeen(near, place, half, 2.0 * gsd_m)) seen += width * height / rows;
      }
    }
  }
  return area > 0.0 ? seen / area : 0.0;
}

}  // namespace skyquilt::buildings
