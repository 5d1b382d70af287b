#include "buildings/fit/fit_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLooksUp = 0.4;   // normal.z of roofs: up to 66 degrees
constexpr double kIsSteep = 0.55;  // below it: walls and the rounded rims of roofs

}  // namespace

FitPoints PointsFor(const Shape& shape, const Candidate& candidate, const PointCloud& cloud) {
  FitPoints points;
  points.spacing_m = cloud.spacing_m;
  const auto point = [&](uint32_t i) {
    const SurfacePoint& of = cloud.points[i];
    const Eigen::Vector3d at = cloud.At(i);
    return FitPoint{at.head<2>() - shape.origin, at.z(), of.normal.cast<double>(), static_cast<double>(of.views)};
  };
  std::vector<double> views;
  for (const uint32_t i : candidate.roof) {
    if (static_cast<double>(cloud.points[i].normal.z()) < kLooksUp) continue;
    points.roof.push_back(point(i));
    views.push_back(points.roof.back().views);
  }
  points.roof_views = views.empty() ? 0.0 : base::Median(std::move(views));
  // Rims belong to the roof or to the wall, by how the candidate was found.
  std::vector<uint32_t> steep = candidate.wall;
  steep.insert(steep.end(), candidate.roof.begin(), candidate.roof.end());
  std::sort(steep.begin(), steep.end());
  steep.erase(std::unique(steep.begin(), steep.end()), steep.end());
  for (const uint32_t i : steep) {
    if (std::abs(static_cast<double>(cloud.points[i].normal.z())) < kIsSteep) points.steep.push_back(point(i));
  }
  for (const uint32_t i : candidate.ground) points.ground.push_back(point(i));
  return points;
}

}  // namespace skyquilt::buildings
