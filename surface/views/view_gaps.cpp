#include "surface/views/view_gaps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/order_statistics.h"

namespace skyquilt::surface {
namespace {

constexpr int64_t kMaxSamples = 150000;
constexpr double kToleranceVoxels = 3.0;
constexpr double kCellOfFootprint = 0.35;  // width of a cell, in widths of a photo's view on the ground
constexpr double kCellOfPicture = 0.7;     // and at most in those of a virtual view, which must show the whole cell
constexpr double kLeastCellVoxels = 4.0;
constexpr double kNotableShare = 0.02;  // of a cell's area that must be weak
constexpr int kNotableSamples = 2;      // a single one may be noise
constexpr double kHalfFieldRad = 30.0 * std::numbers::pi / 180.0;
constexpr double kLeastWidthPx = 16.0, kMostWidthPx = 256.0;
constexpr double kClearance = 0.25;  // above what stands below a virtual camera, in heights above ground

struct Cell {
  double top_m = -std::numeric_limits<double>::infinity();  // highest surface
  int weak_samples = 0;
  double weak_m2 = 0.0;
  Eigen::Vector3d weak_sum = Eigen::Vector3d::Zero();  // of positions by area
};
using Cells = std::map<std::pair<int64_t, int64_t>, Cell>;

struct WeakPlace {
  Eigen::Vector3d centre;
  double weak_m2 = 0.0;
};

// Focal length and size of virtual pictures: pixels as large as those of photos, hence a narrower field where that would be too many.
struct Lens {
  double focal_px = 0.0;
  int width_px = 0;
};

Lens LensLike(const std::vector<ViewPose>& photos) {
  std::vector<double> focal;
  focal.reserve(photos.size());
  for (const ViewPose& pose : photos) focal.push_back(pose.focal_px);
  const double pixels_per_focal = 2.0 * std::tan(kHalfFieldRad);
  Lens lens;
  lens.focal_px = std::max(base::UpperMedian(focal), kLeastWidthPx / pixels_per_focal);
  lens.width_px = static_cast<int>(std::clamp(std::round(lens.focal_px * pixels_per_focal), kLeastWidthPx, kMostWidthPx));
  return lens;
}

double CellWidth(const std::vector<ViewPose>& photos, const Lens& lens, const GapOptions& options) {
  std::vector<double> footprint;
  footprint.reserve(photos.size());
  for (const ViewPose& pose : photos) footprint.push_back(pose.width / pose.focal_px * options.agl_m);
  const double picture = lens.width_px / lens.focal_px * options.agl_m;
  return std::max(kLeastCellVoxels * options.voxel_m, std::min(kCellOfFootprint * base::UpperMedian(footprint), kCellOfPicture * picture));
}

std::pair<int64_t, int64_t> CellOf(const Eigen::Vector3d& x, double cell_m) {
  return {static_cast<int64_t>(std::floor(x.x() / cell_m)), static_cast<int64_t>(std::floor(x.y() / cell_m))};
}

Cells CollectCells(const std::vector<SurfaceSample>& samples, double cell_m, int min_views) {
  Cells cells;
  for (const SurfaceSample& sample : samples) {
    Cell& cell = cells[CellOf(sample.position, cell_m)];
    cell.top_m = std::max(cell.top_m, sample.position.z());
    if (sample.views > min_views) continue;
    // Each view that sees the surface has its own samples of it.
    const double area_m2 = sample.area_m2 / sample.views;
    ++cell.weak_samples;
    cell.weak_m2 += area_m2;
    cell.weak_sum += area_m2 * sample.position;
  }
  return cells;
}

std::vector<WeakPlace> WeakPlaces(const Cells& cells, double cell_m) {
  std::vector<WeakPlace> weak;
  for (const auto& [id, cell] : cells) {
    if (cell.weak_samples < kNotableSamples || cell.weak_m2 < kNotableShare * cell_m * cell_m) continue;
    weak.push_back({cell.weak_sum / cell.weak_m2, cell.weak_m2});
  }
  // Equally weak ones stay in the order of the cells.
  std::stable_sort(weak.begin(), weak.end(), [](const WeakPlace& a, const WeakPlace& b) { return a.weak_m2 > b.weak_m2; });
  return weak;
}

// The camera at `centre`, raised where it would be inside a building or just above one.
Eigen::Vector3d InFreeSpace(Eigen::Vector3d centre, const Cells& cells, double cell_m, double agl_m) {
  const auto [column, row] = CellOf(centre, cell_m);
  for (int64_t x = column - 1; x <= column + 1; ++x) {
    for (int64_t y = row - 1; y <= row + 1; ++y) {
      const auto cell = cells.find({x, y});
      if (cell != cells.end()) centre.z() = std::max(centre.z(), cell->second.top_m + kClearance * agl_m);
    }
  }
  return centre;
}

// Looks from the centre to the target. Up in the picture is the sky, or north in views from straight above.
ViewPose LookAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& target, const Lens& lens) {
  const Eigen::Vector3d forward = (target - centre).normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  right = right.norm() < 1e-6 ? Eigen::Vector3d::UnitX() : right.normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right;
  rotation.row(1) = forward.cross(right);
  rotation.row(2) = forward;
  ViewPose pose;
  pose.width = pose.height = lens.width_px;
  pose.focal_px = lens.focal_px;
  pose.cx = pose.cy = 0.5 * lens.width_px;
  pose.cam_from_enu.rotation = Eigen::Quaterniond(rotation).normalized();
  pose.cam_from_enu.translation = -(pose.cam_from_enu.rotation * centre);
  return pose;
}

}  // namespace

std::vector<ViewPose> PlanGapViews(const CoarseDepths& photos, const GapOptions& options, base::ThreadPool& threads) {
  if (photos.poses().empty() || !(options.agl_m > 0.0)) return {};
  const Lens lens = LensLike(photos.poses());
  const int64_t n_most = options.budget_rays / (static_cast<int64_t>(lens.width_px) * lens.width_px);
  if (n_most <= 0) return {};
  const double cell_m = CellWidth(photos.poses(), lens, options);
  const std::vector<SurfaceSample> samples = photos.Samples(kMaxSamples, kToleranceVoxels * options.voxel_m, threads);
  const Cells cells = CollectCells(samples, cell_m, options.min_views);
  const std::vector<WeakPlace> weak = WeakPlaces(cells, cell_m);

  // Straight above first, then at 45 degrees from north, east, south and west.
  const std::array<Eigen::Vector2d, 4> sides = {Eigen::Vector2d(0.0, 1.0), {1.0, 0.0}, {0.0, -1.0}, {-1.0, 0.0}};
  std::vector<ViewPose> views;
  const auto add = [&](const WeakPlace& place, const Eigen::Vector2d& side) {
    if (static_cast<int64_t>(views.size()) >= n_most) return;
    const Eigen::Vector3d offset(side.x() * options.agl_m, side.y() * options.agl_m, options.agl_m);
    views.push_back(LookAt(InFreeSpace(place.centre + offset, cells, cell_m, options.agl_m), place.centre, lens));
  };
  for (const WeakPlace& place : weak) add(place, Eigen::Vector2d::Zero());
  for (const WeakPlace& place : weak) {
    for (const Eigen::Vector2d& side : sides) add(place, side);
  }
  return views;
}

}  // namespace skyquilt::surface
