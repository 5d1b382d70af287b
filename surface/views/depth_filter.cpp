#include "surface/views/depth_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace skyquilt::surface {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

// Depths with access outside the image, where there is none.
class DepthGrid {
 public:
  DepthGrid(const ViewPose& pose, std::span<const float> depth_m) : pose_(pose), depth_m_(depth_m) {}
  double At(int x, int y) const {
    if (x < 0 || y < 0 || x >= pose_.width || y >= pose_.height) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(depth_m_[static_cast<size_t>(y) * static_cast<size_t>(pose_.width) + static_cast<size_t>(x)]);
  }
  // In the camera frame.
  Eigen::Vector3d Direction(int x, int y) const {
    return Eigen::Vector3d((x + 0.5 - pose_.cx) / pose_.focal_px, (y + 0.5 - pose_.cy) / pose_.focal_px, 1.0).normalized();
  }
  Eigen::Vector3d Point(int x, int y) const { return Direction(x, y) * At(x, y); }

 private:
  const ViewPose& pose_;
  std::span<const float> depth_m_;
};

// Whether the depth jumps between a pixel and its neighbour (dx, dy). Not where it goes on changing about as much behind the neighbour: on a surface
// seen obliquely every step may be long.
bool Jumps(const DepthGrid& grid, int x, int y, int dx, int dy, double max_step_m) {
  const double neighbour = grid.At(x + dx, y + dy);
  const double step = std::abs(grid.At(x, y) - neighbour);
  if (!(step > max_step_m)) return false;  // NaN too: nothing is known there
  const double next_step = std::abs(neighbour - grid.At(x + 2 * dx, y + 2 * dy));
  return !(2.0 * next_step >= step);
}

bool IsSpike(const DepthGrid& grid, int x, int y, double max_step_m) {
  const auto jumps = [&](int dx, int dy) { return Jumps(grid, x, y, dx, dy, max_step_m); };
  return (jumps(1, 0) && jumps(-1, 0)) || (jumps(0, 1) && jumps(0, -1));
}

// Difference between neighbouring points along an axis, of the two the one with the smaller change of depth; false when both are missing.
bool Tangent(const DepthGrid& grid, int x, int y, int dx, int dy, Eigen::Vector3d& tangent) {
  const double depth = grid.At(x, y);
  const double after = std::abs(grid.At(x + dx, y + dy) - depth), before = std::abs(grid.At(x - dx, y - dy) - depth);
  if (std::isnan(after) && std::isnan(before)) return false;
  if (std::isnan(before) || after <= before) {
    tangent = grid.Point(x + dx, y + dy) - grid.Point(x, y);
  } else {
    tangent = grid.Point(x, y) - grid.Point(x - dx, y - dy);
  }
  return true;
}

double CosineAt(const DepthGrid& grid, int x, int y) {
  Eigen::Vector3d along_x, along_y;
  if (!Tangent(grid, x, y, 1, 0, along_x) || !Tangent(grid, x, y, 0, 1, along_y)) return 1.0;
  const Eigen::Vector3d normal = along_x.cross(along_y);
  const double length = normal.norm();
  if (!(length > 0.0)) return 1.0;
  return std::min(1.0, std::abs(normal.dot(grid.Direction(x, y))) / length);
}

double LeastCosine(const DepthLimits& limits) {
  return std::cos(limits.max_angle_deg * std::numbers::pi / 180.0);
}

}  // namespace

float TrustedDepth(const render::Ray& ray, const render::RayColor& color, const DepthLimits& limits) {
  if (!(static_cast<double>(color.opacity) >= limits.min_opacity)) return kNoDepth;
  if (!(std::isfinite(color.depth_median) && color.depth_median > 0.0F)) return kNoDepth;
  // False for NaN: a ray that never reaches the back of the surface.
  const double spread_m = static_cast<double>(color.depth_back) - static_cast<double>(color.depth_front);
  if (!(spread_m * (limits.spread_across ? LeastCosine(limits) : 1.0) <= limits.max_spread_m)) return kNoDepth;
  const Eigen::Vector3d point = ray.origin_enu + static_cast<double>(color.depth_median) * ray.direction_enu;
  const bool inside = (point.array() >= limits.min_enu.array()).all() && (point.array() <= limits.max_enu.array()).all();
  return inside ? color.depth_median : kNoDepth;
}

void FilterDepths(RenderedView& view, const DepthLimits& limits, base::ThreadPool& threads) {
  const int width = view.pose.width;
  const auto row_start = [width](int64_t row) { return static_cast<size_t>(row) * static_cast<size_t>(width); };
  std::vector<float> smooth(view.depth_m.size(), kNoDepth);
  const DepthGrid rendered(view.pose, view.depth_m);
  threads.ParallelFor(view.pose.height, [&](int64_t row, int) {
    for (int x = 0; x < width; ++x) {
      const size_t i = row_start(row) + static_cast<size_t>(x);
      if (!IsSpike(rendered, x, static_cast<int>(row), limits.max_step_m)) smooth[i] = view.depth_m[i];
    }
  });

  view.cosine.assign(smooth.size(), 0);
  const double least_cosine = LeastCosine(limits);
  const DepthGrid grid(view.pose, smooth);
  threads.ParallelFor(view.pose.height, [&](int64_t row, int) {
    for (int x = 0; x < width; ++x) {
      const size_t i = row_start(row) + static_cast<size_t>(x);
      view.depth_m[i] = kNoDepth;
      if (std::isnan(smooth[i])) continue;
      const double cosine = CosineAt(grid, x, static_cast<int>(row));
      if (cosine < least_cosine) continue;
      if (limits.spread_across && !(static_cast<double>(view.spread_m[i]) * cosine <= limits.max_spread_m)) continue;
      view.depth_m[i] = smooth[i];
      view.cosine[i] = static_cast<uint8_t>(std::max(1L, std::lround(255.0 * cosine)));
    }
  });
  view.spread_m = {};
}

}  // namespace skyquilt::surface
