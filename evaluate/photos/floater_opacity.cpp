#include "evaluate/photos/floater_opacity.h"

#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::evaluate::photos {

namespace {

constexpr int kEvery = 4;  // pixels between rays, on both axes

}  // namespace

FloaterOpacity& FloaterOpacity::operator+=(const FloaterOpacity& other) {
  for (size_t i = 0; i < sum.size(); ++i) {
    sum[i] += other.sum[i];
    rays[i] += other.rays[i];
  }
  return *this;
}

double FloaterOpacity::Mean(size_t clearance) const {
  return rays[clearance] > 0 ? sum[clearance] / static_cast<double>(rays[clearance]) : kNotMeasured;
}

std::vector<std::pair<double, double>> FloaterOpacity::Profile() const {
  std::vector<std::pair<double, double>> profile;
  for (size_t i = 0; i < sum.size(); ++i) profile.emplace_back(kFloaterProfile_m[i], Mean(i));
  return profile;
}

FloaterOpacity MeasureFloaterOpacity(const scene::Scene& scene, const HeldOutPhoto& task, const PhotoResult& findings, base::ThreadPool& threads) {
  SKYQUILT_CHECK(!findings.true_depth.Empty(), "the photo must have a true depth");
  const geo::Rigid3d enu_from_cam = task.cam_from_enu.Inverse();
  // One ray from the camera per clearance. Cutting one ray into pieces would change its samples, as pieces may be shorter than a marching step.
  std::vector<render::Ray> rays;
  std::vector<size_t> clearance_of;
  for (int y = kEvery / 2; y < task.camera.height; y += kEvery) {
    for (int x = kEvery / 2; x < task.camera.width; x += kEvery) {
      const double depth_m = static_cast<double>(*findings.true_depth.At(x, y));
      if (!std::isfinite(depth_m) || *findings.scored.At(x, y) == 0) continue;
      const Eigen::Vector3d direction_in_cam = task.camera.RayFromImg({x + 0.5, y + 0.5});
      const double surface_m = depth_m / direction_in_cam.z();
      render::Ray ray{.origin_enu = task.cam_from_enu.OriginInSource(), .direction_enu = enu_from_cam.rotation * direction_in_cam};
      for (size_t i = 0; i < kFloaterProfile_m.size() && surface_m > kFloaterProfile_m[i]; ++i) {
        ray.t_far = surface_m - kFloaterProfile_m[i];
        rays.push_back(ray);
        clearance_of.push_back(i);
      }
    }
  }
  std::vector<render::RayColor> colors(rays.size());
  scene.RenderRays(rays, colors, {}, threads);
  FloaterOpacity total;
  for (size_t k = 0; k < rays.size(); ++k) {
    total.sum[clearance_of[k]] += static_cast<double>(colors[k].opacity);
    ++total.rays[clearance_of[k]];
  }
  return total;
}

}  // namespace skyquilt::evaluate::photos
