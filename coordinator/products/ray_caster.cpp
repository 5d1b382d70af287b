#include "coordinator/products/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace skyquilt::products {
namespace {

constexpr int64_t kBandRays = 1 << 16;

}  // namespace

RayCaster CasterOf(const render::Scene& scene, double exposure_ev, base::ThreadPool& threads) {
  const auto gain = static_cast<float>(std::exp2(exposure_ev));
  return [&scene, &threads, gain](std::span<const render::Ray> rays, std::span<render::RayColor> out) { scene.RenderRays(rays, out, gain, threads); };
}

ViewRenderer RendererOf(const render::Scene& scene, double exposure_ev, base::ThreadPool& threads) {
  const auto gain = static_cast<float>(std::exp2(exposure_ev));
  return [&scene, &threads, gain](const View& view) { return scene.RenderCamera(view.camera, view.cam_from_enu, gain, threads); };
}

ViewRenderer RendererOf(RayCaster caster) {
  return [caster = std::move(caster)](const View& view) {
    const int64_t n_pixels = static_cast<int64_t>(view.camera.width) * view.camera.height;
    std::vector<render::RayColor> colors(static_cast<size_t>(n_pixels));
    const Eigen::Vector3d eye = view.cam_from_enu.OriginInSource();
    const auto radius = static_cast<float>(0.5 / view.camera.FocalX());
    std::vector<render::Ray> rays;
    for (int64_t first = 0; first < n_pixels; first += kBandRays) {
      const int64_t count = std::min(kBandRays, n_pixels - first);
      rays.clear();
      for (int64_t i = first; i < first + count; ++i) {
        const Eigen::Vector2d pixel(static_cast<double>(i % view.camera.width) + 0.5, static_cast<double>(i / view.camera.width) + 0.5);
        const Eigen::Vector3d direction = view.cam_from_enu.rotation.conjugate() * view.camera.RayFromImg(pixel);
        rays.push_back({.origin_enu = eye, .direction_enu = direction.normalized(), .pixel_radius = radius});
      }
      caster(rays, std::span(colors).subspan(static_cast<size_t>(first), static_cast<size_t>(count)));
    }
    return colors;
  };
}

}  // namespace skyquilt::products
