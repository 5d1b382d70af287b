#include "surface/texture/texel_colors.h"

#include <algorithm>
#include <cmath>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr size_t kBatchRays = size_t{1} << 16;
constexpr size_t kRaysPerTask = 4096;
constexpr float kLeastOpacity = 0.05F;

}  // namespace

render::Ray RayToTexel(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal, const Eigen::Vector3d* camera_enu, const RayWindow& window,
                       float width_m) {
  render::Ray ray;
  ray.pixel_width = width_m;
  if (camera_enu) {
    const Eigen::Vector3d way = x_in_enu - *camera_enu;
    const double distance = way.norm();
    if (distance > 0.0 && -normal.dot(way) >= kLeastViewCosine * distance) {
      ray.origin_enu = *camera_enu;
      ray.direction_enu = way / distance;
      ray.t_near = std::max(0.0, distance - window.before_m);
      ray.t_far = distance + window.behind_m;
      return ray;
    }
  }
  ray.origin_enu = x_in_enu + window.before_m * normal;
  ray.direction_enu = -normal;
  ray.t_far = window.before_m + window.behind_m;
  return ray;
}

TexelColors RenderTexels(const TileGeometry& geometry, const AtlasTexels& texels, std::span<const TexelRay> wanted, std::span<const DepthView> views,
                         const RayCaster& caster, const RayWindow& window, base::ThreadPool& threads) {
  std::vector<Eigen::Vector3d> camera;
  for (const DepthView& v : views) camera.push_back(v.pose.Centre());
  const size_t n = wanted.size();
  TexelColors colors;
  colors.rgb_srgb.resize(n);
  colors.known.assign(n, 0);
  std::vector<render::Ray> rays;
  std::vector<render::RayColor> seen;
  for (size_t first = 0; first < n; first += kBatchRays) {
    base::ThrowIfCancelled();
    const size_t count = std::min(kBatchRays, n - first);
    rays.resize(count);
    seen.assign(count, {});
    threads.ParallelFor(static_cast<int64_t>((count + kRaysPerTask - 1) / kRaysPerTask), [&](int64_t task, int) {
      const size_t begin = static_cast<size_t>(task) * kRaysPerTask;
      for (size_t k = begin; k < std::min(count, begin + kRaysPerTask); ++k) {
        const TexelRay& ray = wanted[first + k];
        const double wider = geometry.IsFilled(texels.texel[ray.texel].triangle) ? kFilledTolerance : 1.0;
        const RayWindow around{wider * window.before_m, wider * window.behind_m};
        const Eigen::Vector3d* from = ray.view >= 0 ? &camera[static_cast<size_t>(ray.view)] : nullptr;
        rays[k] = RayToTexel(texels.PositionOf(geometry, ray.texel), texels.NormalOf(geometry, ray.texel), from, around, ray.width_m);
      }
    });
    caster(rays, seen);
    for (size_t k = 0; k < count; ++k) {
      const float opacity = seen[k].opacity;
      if (!(opacity > kLeastOpacity)) continue;
      std::array<float, 3>& rgb = colors.rgb_srgb[first + k];
      for (size_t channel = 0; channel < 3; ++channel) rgb[channel] = std::clamp(seen[k].rgb_srgb[channel] / opacity, 0.0F, 1.0F);
      colors.known[first + k] = std::isfinite(rgb[0] + rgb[1] + rgb[2]) ? 1 : 0;
    }
  }
  return colors;
}

}  // namespace skyquilt::surface
