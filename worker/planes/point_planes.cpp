#include "worker/planes/point_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/planes/plane_growth.h"
#include "worker/rays/depth_points.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

// Edge of the cubes by which planes are looked up, some metres: much longer than reaches, so that few cubes are looked at.
constexpr double kLookUp_gsd = 64.0;
constexpr int kCoordinateBits = 21;

using Cube = std::array<int64_t, 3>;

Cube CubeAt(const Vector3d& x, double cell_m) {
  constexpr double kLimit = static_cast<double>((1 << (kCoordinateBits - 1)) - 1);
  Cube cube;
  for (int axis = 0; axis < 3; ++axis)
    cube[static_cast<size_t>(axis)] = static_cast<int64_t>(std::clamp(std::floor(x[axis] / cell_m), -kLimit, kLimit));
  return cube;
}

// Calls each(key) for the cubes that a box touches.
template <typename Each>
void ForEachCube(const Cube& low, const Cube& high, const Each& each) {
  const auto bits = [](int64_t coordinate) { return static_cast<uint64_t>(coordinate + (1 << (kCoordinateBits - 1))); };
  for (int64_t x = low[0]; x <= high[0]; ++x)
    for (int64_t y = low[1]; y <= high[1]; ++y)
      for (int64_t z = low[2]; z <= high[2]; ++z) each((bits(x) << (2 * kCoordinateBits)) | (bits(y) << kCoordinateBits) | bits(z));
}

std::vector<Vector3d> PointsInPlan(const survey::Survey& survey, const geo::BlockBox& box) {
  const Vector3d low = box.TrainMin(), high = box.TrainMax();
  std::vector<Vector3d> points;
  for (const survey::SparsePoint& point : survey.points) {
    const Vector3d& x = point.x_in_enu;
    const bool in_plan = x.x() >= low.x() && x.y() >= low.y() && x.x() < high.x() && x.y() < high.y();
    if (in_plan && std::isfinite(x.z()) && static_cast<double>(point.error_px) <= kLargestPointError_px) points.push_back(x);
  }
  return points;
}

std::vector<Vector3d> PointsOf(const std::vector<int32_t>& indices, const std::vector<Vector3d>& points) {
  std::vector<Vector3d> result;
  result.reserve(indices.size());
  for (const int32_t i : indices) result.push_back(points[static_cast<size_t>(i)]);
  return result;
}

}  // namespace

PointPlanes::PointPlanes(const survey::Survey& survey, const geo::BlockBox& box, double gsd_m) {
  if (!(gsd_m > 0.0 && std::isfinite(gsd_m))) return;
  cell_m_ = kLookUp_gsd * gsd_m;
  const std::vector<Vector3d> points = PointsInPlan(survey, box);
  for (const PlaneRegion& region : GrowPlanes(points, gsd_m)) {
    const auto index = static_cast<int32_t>(planes_.size());
    planes_.push_back({region.plane.point, region.plane.normal, region.rms_m, static_cast<int>(region.points.size())});
    supports_.emplace_back(region.plane, PointsOf(region.points, points), PointsOf(region.elsewhere, points), region.spacing_m);
    supports_.back().ForEachBox([&](const Vector3d& min, const Vector3d& max) {
      ForEachCube(CubeAt(min, cell_m_), CubeAt(max, cell_m_), [&](uint64_t key) {
        std::vector<int32_t>& here = in_cell_[key];
        if (here.empty() || here.back() != index) here.push_back(index);
      });
    });
  }
}

template <typename Each>
void PointPlanes::ForEachFit(const Vector3d& x, double reach_m, const Each& each) const {
  const auto test = [&](size_t i) {
    const double distance = planes_[i].normal.dot(x - planes_[i].point);
    if (std::abs(distance) <= reach_m && supports_[i].Contains(x)) each(i, Vector3d(x - distance * planes_[i].normal), distance * distance);
  };
  const Cube low = CubeAt(x - Vector3d::Constant(reach_m), cell_m_), high = CubeAt(x + Vector3d::Constant(reach_m), cell_m_);
  double cubes = 1.0;
  for (size_t axis = 0; axis < 3; ++axis) cubes *= static_cast<double>(high[axis] - low[axis] + 1);
  if (cubes > 8.0 + static_cast<double>(planes_.size())) {
    for (size_t i = 0; i < planes_.size(); ++i) test(i);
    return;
  }
  ForEachCube(low, high, [&](uint64_t key) {
    const auto found = in_cell_.find(key);
    if (found == in_cell_.end()) return;
    for (const int32_t i : found->second) test(static_cast<size_t>(i));
  });
}

const PointPlane* PointPlanes::At(const Vector3d& x_in_enu, double reach_m) const {
  if (planes_.empty() || !x_in_enu.allFinite() || !(reach_m > 0.0)) return nullptr;
  size_t nearest = planes_.size();
  double least = 0.0;
  Vector3d foot;
  ForEachFit(x_in_enu, reach_m, [&](size_t i, const Vector3d& its_foot, double square) {
    if (nearest < planes_.size() && (square > least || (square == least && i >= nearest))) return;
    nearest = i;
    least = square;
    foot = its_foot;
  });
  if (nearest == planes_.size()) return nullptr;
  bool ambiguous = false;
  ForEachFit(x_in_enu, reach_m, [&](size_t, const Vector3d& other, double) { ambiguous |= (other - foot).squaredNorm() > reach_m * reach_m; });
  return ambiguous ? nullptr : &planes_[nearest];
}

}  // namespace skyquilt::worker
