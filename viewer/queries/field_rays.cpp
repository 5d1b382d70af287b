#include "viewer/queries/field_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::viewer {
namespace {

constexpr double kSigmasAt15Percent = 1.03643;  // where a normal distribution has .15 left
constexpr double kMarginPixels = 2.0;           // beyond the box, in ground sampling distances: surfaces lie on its faces too

}  // namespace

double DepthSpread(const render::RayColor& color) {
  const auto front = static_cast<double>(color.depth_front), median = static_cast<double>(color.depth_median),
             back = static_cast<double>(color.depth_back);
  if (!std::isfinite(median) || !std::isfinite(front)) return std::numeric_limits<double>::quiet_NaN();
  // A ray that ends before the surface's back shows its front half.
  if (!std::isfinite(back)) return std::max(0.0, median - front) / kSigmasAt15Percent;
  return std::max(0.0, back - front) / (2.0 * kSigmasAt15Percent);
}

const RayCaster& CasterFor(const FieldAccess& access, Which project) {
  const RayCaster& caster = project == Which::kMain ? access.main : access.before;
  if (!caster) {
    throw BadMessage(project == Which::kMain ? "the trained scene of this project is not loaded, so nothing can be measured in it"
                                             : "the trained scene of the earlier project is not loaded, so nothing can be measured in it");
  }
  return caster;
}

double GsdOf(const FieldAccess& access) {
  return std::isfinite(access.gsd_m) && access.gsd_m > 0.0 ? access.gsd_m : FieldAccess().gsd_m;
}

VerticalRays::VerticalRays(const FieldAccess& access) {
  if (!access.min_enu.allFinite() || !access.max_enu.allFinite()) throw BadMessage("the size of this scene is not known");
  const double margin = kMarginPixels * GsdOf(access);
  top_ = access.max_enu.z() + margin;
  length_ = std::max(0.0, top_ - access.min_enu.z()) + margin;
}

render::Ray VerticalRays::At(const Eigen::Vector2d& place, double width_m) const {
  return {.origin_enu = {place.x(), place.y(), top_},
          .direction_enu = {0.0, 0.0, -1.0},
          .t_far = length_,
          .pixel_pitch = 0.0F,
          .pixel_width = static_cast<float>(width_m)};
}

double VerticalRays::Height(const render::RayColor& color) const {
  const auto depth = static_cast<double>(color.depth_median);
  return std::isfinite(depth) ? top_ - depth : std::numeric_limits<double>::quiet_NaN();
}

size_t CastSome(const RayCaster& caster, size_t batch, size_t done, size_t count, const std::function<render::Ray(size_t)>& make,
                const std::function<void(size_t, const render::RayColor&)>& take) {
  const size_t n = std::min(std::max<size_t>(1, batch), count - done);
  if (n == 0) return done;
  std::vector<render::Ray> rays;
  rays.reserve(n);
  for (size_t i = 0; i < n; ++i) rays.push_back(make(done + i));
  std::vector<render::RayColor> colors(n);
  caster(rays, colors);
  for (size_t i = 0; i < n; ++i) take(done + i, colors[i]);
  return done + n;
}

}  // namespace skyquilt::viewer
