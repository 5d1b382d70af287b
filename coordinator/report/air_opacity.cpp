#include "coordinator/report/air_opacity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::report {

namespace {

constexpr int kEvery = 4;  // pixels between rays, on both axes

}  // namespace

AirOpacity& AirOpacity::operator+=(const AirOpacity& other) {
  sum += other.sum;
  rays += other.rays;
  return *this;
}

double AirOpacity::Mean() const {
  return rays > 0 ? sum / static_cast<double>(rays) : kNotMeasured;
}

AirOpacity MeasureAirOpacity(const render::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads) {
  SKYQUILT_CHECK(!findings.true_depth.Empty(), "a photo with true depth");
  const geo::Rigid3d enu_from_cam = task.cam_from_enu.Inverse();
  const Eigen::Vector3d origin = task.cam_from_enu.OriginInSource();
  const double gsd_per_depth = 2.0 / (task.camera.FocalX() + task.camera.FocalY());
  std::vector<render::Ray> rays;
  for (int y = kEvery / 2; y < task.camera.height; y += kEvery) {
    for (int x = kEvery / 2; x < task.camera.width; x += kEvery) {
      const double depth_m = static_cast<double>(*findings.true_depth.At(x, y));
      if (!std::isfinite(depth_m) || *findings.scored.At(x, y) == 0) continue;
      const Eigen::Vector3d direction_in_cam = task.camera.RayFromImg({x + 0.5, y + 0.5});
      const double surface_m = depth_m / direction_in_cam.z();
      const double clearance_m = std::max(kAirClearance_m, kAirClearance_gsd * depth_m * gsd_per_depth);
      if (!(surface_m > clearance_m)) continue;
      rays.push_back({.origin_enu = origin, .direction_enu = enu_from_cam.rotation * direction_in_cam, .t_far = surface_m - clearance_m});
    }
  }
  std::vector<render::RayColor> colors(rays.size());
  scene.RenderRays(rays, colors, {}, threads);
  AirOpacity air;
  air.rays = static_cast<int64_t>(rays.size());
  for (const render::RayColor& color : colors) air.sum += static_cast<double>(color.opacity);
  return air;
}

}  // namespace skyquilt::report
