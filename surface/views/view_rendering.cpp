#include "surface/views/view_rendering.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"
#include "core/geo/ray_box.h"
#include "core/survey/view_kind.h"

namespace skyquilt::surface {
namespace {

constexpr int64_t kBatchRays = 1 << 16;
constexpr int64_t kRaysPerTask = 4096;
constexpr double kMaxStepVoxels = 4.0;
constexpr double kFreeOpacity = 0.05;  // rays of level photos with at most this opacity meet nothing

// The part of the ray through a pixel that may show a surface; empty when t_far is 0.
render::Ray RayThrough(const ViewPose& pose, const Eigen::Vector3d& centre, int64_t pixel, const DepthLimits& limits) {
  const double x = static_cast<double>(pixel % pose.width) + 0.5, y = static_cast<double>(pixel / pose.width) + 0.5;
  render::Ray ray{.origin_enu = centre, .direction_enu = pose.DirectionAt(x, y)};
  // Square root of the pixel's solid angle, which falls with the third power of the cosine to the optical axis.
  const double u = (x - pose.cx) / pose.focal_px, v = (y - pose.cy) / pose.focal_px;
  ray.pixel_pitch = static_cast<float>(std::pow(1.0 + u * u + v * v, -0.75) / pose.focal_px);
  // The back of a surface at the border of the box may lie outside it.
  const Eigen::Vector3d margin(limits.max_spread_m, limits.max_spread_m, limits.max_spread_m);
  const geo::Interval inside = geo::RayBox(centre, ray.direction_enu, limits.min_enu - margin, limits.max_enu + margin);
  ray.t_near = inside.t_near;
  ray.t_far = inside.t_far;
  return ray;
}

}  // namespace

DepthLimits LimitsOf(const SurfaceInput& input, double voxel_m) {
  const SurfaceOptions& options = input.options;
  const SurfaceBox box = SurfaceBoxOf(*input.info);
  return {.min_opacity = options.min_opacity,
          // From above every ray ends on the ground, and one that does not met a hole of the field.
          .max_free_opacity = survey::LooksLevel(*input.survey) ? kFreeOpacity : -1.0,
          .max_spread_m = options.max_spread_voxels * voxel_m,
          .spread_across = survey::LooksLevel(*input.survey),
          .max_step_m = kMaxStepVoxels * voxel_m,
          .max_angle_deg = kMaxAngle_deg,
          .min_enu = box.min_enu,
          .max_enu = box.max_enu};
}

RenderedView RenderView(const ViewPose& pose, const RayCaster& caster, const DepthLimits& limits, base::ThreadPool& threads,
                        const std::function<void(int64_t pixels)>& on_pixels) {
  const int64_t n_pixels = static_cast<int64_t>(pose.width) * pose.height;
  RenderedView view;
  view.pose = pose;
  view.depth_m.assign(static_cast<size_t>(n_pixels), std::numeric_limits<float>::quiet_NaN());
  if (limits.spread_across) view.spread_m.assign(static_cast<size_t>(n_pixels), 0.0F);
  const Eigen::Vector3d centre = pose.Centre();
  std::vector<render::Ray> candidates, rays;
  std::vector<size_t> pixel_of, free_pixels;
  std::vector<render::RayColor> colors;
  for (int64_t first = 0; first < n_pixels; first += kBatchRays) {
    base::ThrowIfCancelled();
    const int64_t count = std::min(kBatchRays, n_pixels - first);
    candidates.resize(static_cast<size_t>(count));
    threads.ParallelFor((count + kRaysPerTask - 1) / kRaysPerTask, [&](int64_t task, int) {
      for (int64_t i = task * kRaysPerTask; i < std::min(count, (task + 1) * kRaysPerTask); ++i) {
        candidates[static_cast<size_t>(i)] = RayThrough(pose, centre, first + i, limits);
      }
    });
    rays.clear();
    pixel_of.clear();
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (!(candidates[i].t_far > candidates[i].t_near)) continue;
      rays.push_back(candidates[i]);
      pixel_of.push_back(static_cast<size_t>(first) + i);
    }
    if (!rays.empty()) {
      colors.assign(rays.size(), {});
      caster(rays, colors);
    }
    for (size_t i = 0; i < rays.size(); ++i) {
      view.depth_m[pixel_of[i]] = TrustedDepth(rays[i], colors[i], limits);
      if (limits.spread_across) view.spread_m[pixel_of[i]] = colors[i].depth_back - colors[i].depth_front;
      if (static_cast<double>(colors[i].opacity) <= limits.max_free_opacity) free_pixels.push_back(pixel_of[i]);
    }
    on_pixels(count);
  }
  FilterDepths(view, limits, threads);
  for (const size_t pixel : free_pixels) view.cosine[pixel] = kMeetsNothing;
  return view;
}

}  // namespace skyquilt::surface
