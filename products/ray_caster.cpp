#include "products/ray_caster.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/errors.h"
#include "core/camera/pixel_pitch.h"
#include "products/product_options.h"

namespace skyquilt::products {
namespace {

constexpr int64_t kBandRays = 1 << 16;

}  // namespace

scene::Appearance AppearanceOf(const std::string& exposure, const scene::SceneInfo& info) {
  scene::Appearance appearance;
  if (exposure == "normal") return appearance;
  if (const std::optional<double> stops = ExposureStops(exposure)) {
    appearance.log_gain.fill(static_cast<float>(*stops * std::numbers::ln2));
    return appearance;
  }
  const std::optional<size_t> photo = info.response.Find(exposure);
  if (!photo) {
    throw base::UsageError("exposure '" + exposure + "' is not allowed: give 'normal', a number of stops, or the name of a photo of this survey" +
                           (info.response.photos() == 0 ? " (this scene stores no photos: run `skyquilt merge` again)" : ""));
  }
  return {scene::Rendition::kRecorded, info.response.LogGain(*photo)};
}

RayCaster CasterOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads) {
  return [&scene, &threads, appearance](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    scene.RenderRays(rays, out, appearance, threads);
  };
}

RayCaster BackgroundCasterOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads) {
  return [&scene, &threads, appearance](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    scene.RenderRaysOverBackground(rays, out, appearance, threads);
  };
}

ViewRenderer RendererOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads) {
  return [&scene, &threads, appearance](const View& view) { return scene.RenderCamera(view.camera, view.cam_from_enu, appearance, threads); };
}

ViewRenderer RendererOf(RayCaster caster) {
  return [caster = std::move(caster)](const View& view) {
    const int64_t n_pixels = static_cast<int64_t>(view.camera.width) * view.camera.height;
    std::vector<render::RayColor> colors(static_cast<size_t>(n_pixels));
    const Eigen::Vector3d eye = view.cam_from_enu.OriginInSource();
    const camera::PixelPitch pitch(view.camera);
    std::vector<render::Ray> rays;
    for (int64_t first = 0; first < n_pixels; first += kBandRays) {
      const int64_t count = std::min(kBandRays, n_pixels - first);
      rays.clear();
      for (int64_t i = first; i < first + count; ++i) {
        const int64_t row = i / view.camera.width;
        const Eigen::Vector2d pixel(static_cast<double>(i % view.camera.width) + 0.5, static_cast<double>(row) + 0.5);
        const Eigen::Vector3d direction = view.cam_from_enu.rotation.conjugate() * view.camera.RayFromImg(pixel);
        rays.push_back({.origin_enu = eye, .direction_enu = direction.normalized(), .pixel_pitch = static_cast<float>(pitch.At(pixel))});
      }
      caster(rays, std::span(colors).subspan(static_cast<size_t>(first), static_cast<size_t>(count)));
    }
    return colors;
  };
}

}  // namespace skyquilt::products
