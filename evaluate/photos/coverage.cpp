#include "evaluate/photos/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/errors.h"
#include "core/camera/photo_visibility.h"
#include "evaluate/photos/training_depths.h"

namespace skyquilt::evaluate::photos {

std::optional<Eigen::Vector3d> SurfacePoint(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu, double depth_m,
                                            HeightRange range) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double t_enter = 0.0;
  double t_leave = kInfinity;
  const double z = origin_enu.z();
  const double dz = direction_enu.z();
  if (dz == 0.0) {
    if (z < range.low_m || z > range.high_m) return std::nullopt;
  } else {
    const double t_low = (range.low_m - z) / dz;
    const double t_high = (range.high_m - z) / dz;
    t_enter = std::max(0.0, std::min(t_low, t_high));
    t_leave = std::max(t_low, t_high);
    if (!(t_leave >= t_enter)) return std::nullopt;
  }
  const double depth = std::isnan(depth_m) ? kInfinity : depth_m;
  const double t = std::clamp(depth, t_enter, t_leave);
  if (!std::isfinite(t)) return std::nullopt;
  return origin_enu + t * direction_enu;
}

TrainingViews::TrainingViews(std::vector<TrainingView> views) : views_(std::move(views)) {
  cones_.reserve(views_.size());
  for (const TrainingView& view : views_) {
    const size_t n_pixels = static_cast<size_t>(view.camera.width) * static_cast<size_t>(view.camera.height);
    SKYQUILT_CHECK(view.mask.empty() || view.mask.size() == n_pixels, "the mask must have the size of the camera's image");
    Cone cone;
    cone.apex_enu = view.cam_from_enu.OriginInSource();
    cone.axis_enu = view.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    // The widest ray is on the image border. Distortion models are invalid far outside the image, so points outside this cone are not projected.
    constexpr int kSteps = 16;
    for (int i = 0; i <= kSteps; ++i) {
      const double u = view.camera.width * static_cast<double>(i) / kSteps;
      const double v = view.camera.height * static_cast<double>(i) / kSteps;
      for (const Eigen::Vector2d& pixel :
           {Eigen::Vector2d(u, 0.0), Eigen::Vector2d(u, view.camera.height), Eigen::Vector2d(0.0, v), Eigen::Vector2d(view.camera.width, v)}) {
        cone.cos_limit = std::min(cone.cos_limit, view.camera.RayFromImg(pixel).z());
      }
    }
    cone.cos_limit -= 1e-3;
    cones_.push_back(cone);
  }
}

std::vector<int> TrainingViews::ByDistance(const Eigen::Vector3d& x_in_enu) const {
  std::vector<double> distance(views_.size());
  for (size_t i = 0; i < views_.size(); ++i) distance[i] = (cones_[i].apex_enu - x_in_enu).squaredNorm();
  std::vector<int> order(views_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return distance[static_cast<size_t>(a)] < distance[static_cast<size_t>(b)]; });
  return order;
}

bool TrainingViews::Sees(int view_index, const Eigen::Vector3d& x_in_enu) const {
  const TrainingView& view = views_[static_cast<size_t>(view_index)];
  const Cone& cone = cones_[static_cast<size_t>(view_index)];
  const Eigen::Vector3d offset = x_in_enu - cone.apex_enu;
  if (offset.dot(cone.axis_enu) < cone.cos_limit * offset.norm()) return false;
  return camera::IsVisible(view.camera, view.cam_from_enu, x_in_enu, {.mask = view.mask}) && !IsHidden(view, x_in_enu);
}

int TrainingViews::Count(const Eigen::Vector3d& x_in_enu, std::span<const int> order, int enough) const {
  int count = 0;
  for (const int view : order) {
    if (count >= enough) break;
    if (Sees(view, x_in_enu)) ++count;
  }
  return count;
}

}  // namespace skyquilt::evaluate::photos
