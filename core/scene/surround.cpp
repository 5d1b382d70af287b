#include "core/scene/surround.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace skyquilt::scene {
namespace {

constexpr double kUnseen = 1.0, kSeen = 3.0;  // photos
constexpr float kGrey = 0.6F;                 // share of grey in the plain ground, the rest is the survey's mean colour
constexpr std::array<float, 3> kHorizon = {0.80F, 0.82F, 0.84F}, kZenith = {0.58F, 0.68F, 0.80F};
constexpr double kEdgeCells = 2.0;  // within which the background ends at the edge of its map

double SmoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

std::array<float, 3> Mix(const std::array<float, 3>& a, const std::array<float, 3>& b, double share_of_b) {
  const auto t = static_cast<float>(share_of_b);
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

}  // namespace

Surround::Surround(const Background& background) : background_(background) {
  if (background_.surface.Empty()) return;
  const geo::PlaneGrid& grid = background_.surface.grid();
  low_ = grid.origin;
  high_ = grid.origin + grid.cell_m * Eigen::Vector2d(grid.columns, grid.rows);
  haze_m_ = (high_ - low_).norm();
}

double Surround::DistanceOutside(const Eigen::Vector2d& x_enu) const {
  return (x_enu - x_enu.cwiseMax(low_).cwiseMin(high_)).norm();
}

double Surround::SeenShare(const Eigen::Vector2d& x_enu) const {
  if (background_.surface.Empty()) return 1.0;
  const double edge = 1.0 - SmoothStep(0.0, kEdgeCells * background_.surface.grid().cell_m, DistanceOutside(x_enu));
  if (background_.photos.empty() || edge <= 0.0) return edge;
  const HeightMap::Corners corners = background_.surface.Around(x_enu.x(), x_enu.y());
  double photos = 0.0;
  for (size_t i = 0; i < 4; ++i) photos += corners.weight[i] * std::min<double>(kSeen, background_.photos[corners.cell[i]]);
  return edge * SmoothStep(kUnseen, kSeen, photos);
}

std::array<float, 3> Surround::Sky(const Eigen::Vector3d& direction_enu) const {
  if (!background_.sky_srgb.empty()) {
    // Level rays have the colour of those that rise a little.
    const Eigen::Vector3d rising(direction_enu.x(), direction_enu.y(), std::max(direction_enu.z(), 1e-6));
    return background_.Color(Eigen::Vector3d::Zero(), rising);
  }
  return Mix(kHorizon, kZenith, std::sqrt(std::clamp(direction_enu.normalized().z(), 0.0, 1.0)));
}

std::array<float, 3> Surround::PlainGround(const Eigen::Vector3d& x_enu, const Eigen::Vector3d& direction_enu) const {
  const std::array<float, 3>& mean = background_.mean_srgb;
  const float grey = (mean[0] + mean[1] + mean[2]) / 3.0F;
  const double haze = 1.0 - std::exp(-DistanceOutside(x_enu.head<2>()) / haze_m_);
  return Mix(Mix(mean, {grey, grey, grey}, static_cast<double>(kGrey)), Sky({direction_enu.x(), direction_enu.y(), 0.0}), haze);
}

std::array<float, 3> Surround::Behind(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const {
  if (background_.surface.Empty()) return background_.Color(origin_enu, direction_enu);
  if (direction_enu.z() >= 0.0) return Sky(direction_enu);
  Eigen::Vector3d x;
  if (!background_.surface.Intersect(origin_enu, direction_enu, &x)) return Sky(direction_enu);
  const double seen = SeenShare(x.head<2>());
  const std::array<float, 3> plain = seen < 1.0 ? PlainGround(x, direction_enu) : background_.mean_srgb;
  return seen > 0.0 ? Mix(plain, background_.Color(origin_enu, direction_enu), seen) : plain;
}

void Surround::Fade(const render::Ray& ray, render::RayColor* color) const {
  // Level photos show what stands beyond the ground that they see.
  if (background_.photos.empty() || !(color->opacity > 0.0F)) return;
  const float depth = std::isfinite(color->depth_median) ? color->depth_median : color->depth;
  if (!std::isfinite(depth)) return;
  const auto share = static_cast<float>(SeenShare((ray.origin_enu + static_cast<double>(depth) * ray.direction_enu).head<2>()));
  if (share >= 1.0F) return;
  for (float& value : color->rgb_srgb) value *= share;
  color->opacity *= share;
}

}  // namespace skyquilt::scene
