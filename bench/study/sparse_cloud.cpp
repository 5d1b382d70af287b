#include "bench/study/sparse_cloud.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "buildings/planes/point_grid.h"
#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"

namespace skyquilt::bench {
namespace {

using buildings::PointCloud;
using buildings::PointGrid;
using buildings::SurfacePoint;

constexpr size_t kNeighbours = 16;
constexpr size_t kLeastNeighbours = 3;    // for a plane
constexpr double kReachInSpacings = 6.0;  // a disc of this radius has about 110 points on an even surface

// Mean direction towards the photos of a track; up when they are unknown.
Eigen::Vector3d TowardsPhotos(const Eigen::Vector3d& x, std::span<const int32_t> photos, const survey::Survey& survey) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int32_t photo : photos) sum += (survey.photos[static_cast<size_t>(photo)].cam_from_enu.OriginInSource() - x).normalized();
  return photos.empty() ? Eigen::Vector3d::UnitZ() : sum;
}

// The normal of the plane through the points; nothing else is known of its side.
Eigen::Vector3f PlaneNormal(const PointCloud& cloud, std::span<const PointGrid::Found> near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PointGrid::Found& one : near) mean += cloud.points[one.place].position.cast<double>();
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const PointGrid::Found& one : near) {
    const Eigen::Vector3d from_mean = cloud.points[one.place].position.cast<double>() - mean;
    spread += from_mean * from_mean.transpose();
  }
  return linear::SymmetricEigen(spread).vectors.col(0).cast<float>();
}

}  // namespace

PointCloud SparseCloud(const survey::Survey& survey, base::ThreadPool& threads) {
  std::vector<size_t> all;  // indices into Survey::points
  for (size_t i = 0; i < survey.points.size(); ++i) {
    if (survey.points[i].x_in_enu.allFinite()) all.push_back(i);
  }
  if (all.empty()) throw base::InputError(survey.photo_root, "has no sparse points", "Give a survey whose model has points");
  Eigen::Vector3d low = survey.points[all.front()].x_in_enu, high = low;
  for (const size_t i : all) {
    low = low.cwiseMin(survey.points[i].x_in_enu);
    high = high.cwiseMax(survey.points[i].x_in_enu);
  }
  PointCloud cloud;
  cloud.middle = (0.5 * (low + high)).array().round();
  for (const size_t i : all) {
    const survey::SparsePoint& point = survey.points[i];
    const std::span<const int32_t> photos = survey.tracks.PhotosOf(i);
    const int views = photos.empty() ? point.track_length : static_cast<int>(photos.size());
    cloud.points.push_back({.position = (point.x_in_enu - cloud.middle).cast<float>(),
                            .normal = Eigen::Vector3f::UnitZ(),
                            .rgb = point.rgb,
                            .views = static_cast<uint8_t>(std::clamp(views, 1, 255)),
                            .filled = 0});
  }
  const double area_m2 = std::max((high.x() - low.x()) * (high.y() - low.y()), 1e-6);
  const double even_m = std::sqrt(area_m2 / static_cast<double>(all.size())), reach_m = kReachInSpacings * even_m;
  std::vector<uint32_t> chosen(all.size());
  std::iota(chosen.begin(), chosen.end(), 0U);
  const PointGrid grid(cloud, chosen, reach_m);
  std::vector<Eigen::Vector3f> normals(all.size());
  std::vector<double> spacing_m(all.size(), std::numeric_limits<double>::quiet_NaN());
  constexpr size_t kPerTask = 512;
  threads.ParallelFor(static_cast<int64_t>((all.size() + kPerTask - 1) / kPerTask), [&](int64_t task, int /*thread*/) {
    std::vector<PointGrid::Found> near;
    const size_t first = static_cast<size_t>(task) * kPerTask;
    for (size_t i = first; i < std::min(all.size(), first + kPerTask); ++i) {
      grid.Near(static_cast<uint32_t>(i), reach_m, kNeighbours + 1, &near);
      const Eigen::Vector3d towards = TowardsPhotos(survey.points[all[i]].x_in_enu, survey.tracks.PhotosOf(all[i]), survey);
      normals[i] = near.size() > kLeastNeighbours ? PlaneNormal(cloud, near) : Eigen::Vector3f(towards.normalized().cast<float>());
      if (normals[i].cast<double>().dot(towards) < 0.0) normals[i] = -normals[i];
      // A disc as large as the distance of the n-th neighbour has n points.
      if (near.size() == kNeighbours + 1) {
        spacing_m[i] = std::sqrt(std::numbers::pi * static_cast<double>(near.back().squared_m2) / static_cast<double>(kNeighbours));
      }
    }
  });
  for (size_t i = 0; i < all.size(); ++i) cloud.points[i].normal = normals[i];
  std::erase_if(spacing_m, [](double value) { return !(value > 0.0); });
  cloud.spacing_m = spacing_m.empty() ? even_m : base::Median(std::move(spacing_m));
  return cloud;
}

double SparseGsd(const PointCloud& cloud, double gsd_m) {
  constexpr double kGsdInSpacings = 0.5;
  return std::max(gsd_m, kGsdInSpacings * cloud.spacing_m);
}

buildings::GroundGrid SparseGround(const PointCloud& cloud, const surface::TerrainOptions& options) {
  surface::TerrainOptions terrain = options;
  terrain.cell_m = std::max(options.cell_m, 2.0 * cloud.spacing_m);
  Eigen::Vector3f low = cloud.points.front().position, high = low;
  for (const SurfacePoint& point : cloud.points) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  surface::HeightRaster lowest;
  gis::MapGrid& grid = lowest.grid;
  grid.resolution_m = terrain.cell_m;
  grid.width = 1 + static_cast<int>(static_cast<double>(high.x() - low.x()) / terrain.cell_m);
  grid.height = 1 + static_cast<int>(static_cast<double>(high.y() - low.y()) / terrain.cell_m);
  grid.left = cloud.middle.x() + static_cast<double>(low.x());
  grid.top = cloud.middle.y() + static_cast<double>(low.y()) + grid.height * terrain.cell_m;
  lowest.height_m.assign(grid.size(), std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d x = cloud.At(i);
    const Eigen::Vector2d cell = grid.CellOf(x.head<2>());
    const auto column = static_cast<int>(std::clamp(std::lround(cell.x()), 0L, grid.width - 1L));
    const auto row = static_cast<int>(std::clamp(std::lround(cell.y()), 0L, grid.height - 1L));
    float& kept = lowest.height_m[grid.Index(column, row)];
    kept = std::fmin(kept, static_cast<float>(x.z()));  // ignores NaN
  }
  const surface::Terrain found = surface::FindTerrain(lowest, terrain);
  std::vector<float> ground;
  for (int row = grid.height - 1; row >= 0; --row) {  // maps begin in the north, GroundGrid in the south
    std::copy_n(found.height.height_m.begin() + static_cast<std::ptrdiff_t>(grid.Index(0, row)), grid.width, std::back_inserter(ground));
  }
  return {grid.CellCentre(0, grid.height - 1), terrain.cell_m, grid.width, grid.height, std::move(ground)};
}

}  // namespace skyquilt::bench
