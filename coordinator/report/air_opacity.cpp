#include "coordinator/report/air_opacity.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::report {

namespace {

constexpr int kEvery = 6;  // pixels between rays, on both axes

}  // namespace

double AirOpacity::Pool::Mean() const {
  return rays > 0 ? sum / static_cast<double>(rays) : kNotMeasured;
}

AirOpacity& AirOpacity::operator+=(const AirOpacity& other) {
  const auto add = [](Pool& to, const Pool& from) {
    to.sum += from.sum;
    to.rays += from.rays;
  };
  add(clear_, other.clear_);
  for (size_t i = 0; i < profile_.size(); ++i) add(profile_[i], other.profile_[i]);
  return *this;
}

std::vector<std::pair<double, double>> AirOpacity::Profile() const {
  std::vector<std::pair<double, double>> profile;
  for (size_t i = 0; i < profile_.size(); ++i) profile.emplace_back(kAirProfile_m[i], profile_[i].Mean());
  return profile;
}

AirOpacity MeasureAirOpacity(const render::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads) {
  SKYQUILT_CHECK(!findings.true_depth.Empty(), "a photo with true depth");
  const geo::Rigid3d enu_from_cam = task.cam_from_enu.Inverse();
  const double gsd_per_depth = 2.0 / (task.camera.FocalX() + task.camera.FocalY());
  AirOpacity air;
  std::vector<render::Ray> rays;
  std::vector<AirOpacity::Pool*> pool_of;
  for (int y = kEvery / 2; y < task.camera.height; y += kEvery) {
    for (int x = kEvery / 2; x < task.camera.width; x += kEvery) {
      const double depth_m = static_cast<double>(*findings.true_depth.At(x, y));
      if (!std::isfinite(depth_m) || *findings.scored.At(x, y) == 0) continue;
      const Eigen::Vector3d direction_in_cam = task.camera.RayFromImg({x + 0.5, y + 0.5});
      const double surface_m = depth_m / direction_in_cam.z();
      render::Ray ray{.origin_enu = task.cam_from_enu.OriginInSource(), .direction_enu = enu_from_cam.rotation * direction_in_cam};
      const auto look = [&](double clearance_m, AirOpacity::Pool& pool) {
        if (!(surface_m > clearance_m)) return;
        ray.t_far = surface_m - clearance_m;
        rays.push_back(ray);
        pool_of.push_back(&pool);
      };
      look(std::max(kAirClearance_m, kAirClearance_gsd * depth_m * gsd_per_depth), air.clear_);
      for (size_t i = 0; i < air.profile_.size(); ++i) look(kAirProfile_m[i], air.profile_[i]);
    }
  }
  std::vector<render::RayColor> colors(rays.size());
  scene.RenderRays(rays, colors, {}, threads);
  for (size_t i = 0; i < rays.size(); ++i) {
    pool_of[i]->sum += static_cast<double>(colors[i].opacity);
    ++pool_of[i]->rays;
  }
  return air;
}

}  // namespace skyquilt::report
