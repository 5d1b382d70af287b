#include "products/sparse_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"

namespace skyquilt::products {
namespace {

constexpr size_t kEnoughPoints = 20;
constexpr double kStrayShare = 0.005;  // of the points, beyond each side of the area
constexpr double kRimShare = 0.03;     // of the area's size, added on each side: the ground goes on where points end
constexpr double kCellPoints = 4.0;
constexpr int kMostHeightCells = 1024;   // along an axis
constexpr size_t kFewestNeighbours = 5;  // known cells of 3 x 3, itself included, for a median

std::array<double, 2> RangeOfPoints(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
  const double low = base::NearestRankQuantile(values, kStrayShare);
  return {low, base::NearestRankQuantile(values, 1.0 - kStrayShare)};
}

// Where the rays of the photo's rim meet the level ground, or come as near to it as the widest view allows.
void ExtendByPhoto(const survey::Photo& photo, const camera::Camera& camera, double ground_z, Eigen::AlignedBox2d* area) {
  const double widest = std::tan(kWidestView_deg * std::numbers::pi / 180.0);
  const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
  const double height = eye.z() - ground_z;
  if (!eye.allFinite() || !(height > 0.0)) return;
  Eigen::AlignedBox2d seen;
  bool down = false;
  for (const double u : {0.0, 0.5, 1.0}) {
    for (const double v : {0.0, 0.5, 1.0}) {
      const Eigen::Vector3d ray = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({u * camera.width, v * camera.height});
      const double across = ray.head<2>().norm();
      const bool steep = ray.z() < 0.0 && across <= widest * -ray.z();
      down = down || steep;
      const Eigen::Vector2d reach = ray.head<2>() * (steep ? 1.0 / -ray.z() : widest / std::max(across, 1e-12));
      seen.extend(eye.head<2>() + height * reach);
    }
  }
  if (down) area->extend(seen);
}

}  // namespace

std::vector<Eigen::Vector3d> SteadyPoints(const survey::Survey& survey) {
  std::vector<Eigen::Vector3d> all, steady;
  for (const survey::SparsePoint& point : survey.points) {
    if (!point.x_in_enu.allFinite()) continue;
    all.push_back(point.x_in_enu);
    if (point.track_length >= 3) steady.push_back(point.x_in_enu);
  }
  return steady.size() >= std::max(kEnoughPoints, all.size() / 4) ? steady : all;
}

Eigen::AlignedBox2d SeenGround(const survey::Survey& survey, const std::vector<Eigen::Vector3d>& points, double ground_z) {
  Eigen::AlignedBox2d area;
  for (const survey::Photo& photo : survey.photos) ExtendByPhoto(photo, survey.cameras[static_cast<size_t>(photo.camera)], ground_z, &area);
  if (area.isEmpty() || points.size() < kEnoughPoints) return area;
  Eigen::AlignedBox2d known;
  const auto [west, east] = RangeOfPoints(points, 0);
  const auto [south, north] = RangeOfPoints(points, 1);
  const Eigen::Vector2d rim = kRimShare * Eigen::Vector2d(east - west, north - south);
  known.extend(Eigen::Vector2d(west, south) - rim);
  known.extend(Eigen::Vector2d(east, north) + rim);
  const Eigen::AlignedBox2d both = area.intersection(known);
  return both.isEmpty() || !(both.sizes().minCoeff() > 0.0) ? area : both;
}

scene::HeightMap HeightsOfPoints(const std::vector<Eigen::Vector3d>& points, const Eigen::AlignedBox2d& area) {
  SKYQUILT_CHECK(!points.empty() && !area.isEmpty(), "heights need points and an area");
  const Eigen::Vector2d size = area.sizes().cwiseMax(1e-6);
  const double cell_m = std::max(std::sqrt(kCellPoints * size.prod() / static_cast<double>(points.size())), size.maxCoeff() / kMostHeightCells);
  const geo::PlaneGrid grid(area.min(), cell_m, size);
  std::vector<std::vector<double>> in_cell(grid.size());
  std::vector<double> everywhere;
  for (const Eigen::Vector3d& point : points) {
    everywhere.push_back(point.z());
    const int64_t cell = grid.CellAt(point.head<2>());
    if (cell >= 0) in_cell[static_cast<size_t>(cell)].push_back(point.z());
  }
  // When all points lie beside the area, it is level.
  std::vector<double> medians(in_cell.size(), base::UpperMedian(everywhere)), known(in_cell.size(), 0.0);
  for (size_t i = 0; i < in_cell.size(); ++i) {
    if (in_cell[i].empty()) continue;
    medians[i] = base::UpperMedian(in_cell[i]);
    known[i] = 1.0;
  }
  std::vector<double> heights = medians, around;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (known[grid.Index(column, row)] == 0.0) continue;
      around.clear();
      for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
          if (known[grid.Index(c, r)] != 0.0) around.push_back(medians[grid.Index(c, r)]);
        }
      }
      if (around.size() >= kFewestNeighbours) heights[grid.Index(column, row)] = base::UpperMedian(around);
    }
  }
  scene::FillFromSurroundings(grid, 1, &heights, std::move(known));
  return {grid, std::move(heights)};
}

}  // namespace skyquilt::products
