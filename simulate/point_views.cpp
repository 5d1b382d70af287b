#include "simulate/point_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace skyquilt::simulate {

using Eigen::Vector3d;
using Eigen::Vector3f;

PointViews::PointViews(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos)
    : world_(world), camera_(camera), photos_(photos) {
  for (const PhotoPlan& photo : photos) {
    views_.push_back({photo.cam_from_enu.OriginInSource(), photo.cam_from_enu.rotation.conjugate() * Vector3d::UnitZ()});
    moving_.push_back(world.MovingAt(photo.time_s));
  }
  double cos_corner = 1.0;
  for (const double x : {0.0, static_cast<double>(camera.width)}) {
    for (const double y : {0.0, static_cast<double>(camera.height)}) cos_corner = std::min(cos_corner, camera.RayFromImg({x, y}).z());
  }
  cos_half_view_ = cos_corner - 1e-3;
  constexpr double kFlattest = 0.999;  // sine of the angle from straight down, about 87 degrees: flatter photos count as seeing everything
  const double half_view = std::acos(std::clamp(cos_half_view_, -1.0, 1.0));
  double widest = 0.0;  // angle from straight down
  highest_m_ = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < views_.size(); ++i) {
    widest = std::max(widest, half_view + std::acos(std::clamp(-views_[i].axis.z(), -1.0, 1.0)));
    highest_m_ = std::max(highest_m_, views_[i].centre.z());
    by_east_.push_back(static_cast<uint32_t>(i));
  }
  reach_ = std::sin(std::min(widest, std::numbers::pi / 2.0)) < kFlattest ? std::tan(widest) : std::numeric_limits<double>::infinity();
  std::sort(by_east_.begin(), by_east_.end(), [&](uint32_t a, uint32_t b) { return views_[a].centre.x() < views_[b].centre.x(); });
}

void PointViews::FindNear(const Vector3d& place, std::vector<uint32_t>* found) const {
  found->clear();
  if (!std::isfinite(reach_)) {
    for (size_t i = 0; i < views_.size(); ++i) found->push_back(static_cast<uint32_t>(i));
    return;
  }
  const double reach_m = 0.01 + 1.001 * reach_ * std::max(0.0, highest_m_ - place.z());
  const auto from =
      std::lower_bound(by_east_.begin(), by_east_.end(), place.x() - reach_m, [&](uint32_t i, double x) { return views_[i].centre.x() < x; });
  for (auto at = from; at != by_east_.end() && views_[*at].centre.x() <= place.x() + reach_m; ++at) {
    if (std::abs(views_[*at].centre.y() - place.y()) <= reach_m) found->push_back(*at);
  }
  std::sort(found->begin(), found->end());
}

bool PointViews::HiddenByCar(size_t photo, const Vector3f& direction, float far_m) const {
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, views_[photo].centre.cast<float>(), direction, 0.1F, far_m);
  return moving_[photo].scene.Occluded(ray) != 0;
}

std::vector<uint32_t> PointViews::Seeing(const Vector3f& position, const Vector3f& normal, double border_px) const {
  std::vector<uint32_t> seeing;
  const Vector3d point = position.cast<double>();
  raytrace::RayPacket rays;
  std::array<uint32_t, raytrace::kPacket> photo{};
  size_t n = 0;
  rays.valid.fill(0);
  const auto Flush = [&] {
    const uint32_t occluded = world_.scene().Occluded(rays);
    for (size_t lane = 0; lane < n; ++lane) {
      if (((occluded >> lane) & 1U) != 0) continue;
      const Vector3f direction(-rays.dx[lane], -rays.dy[lane], -rays.dz[lane]);
      if (!HiddenByCar(photo[lane], direction, rays.t_far[lane])) seeing.push_back(photo[lane]);
    }
    n = 0;
    rays.valid.fill(0);
  };
  std::vector<uint32_t> near;
  FindNear(point, &near);
  for (const size_t i : near) {
    const Vector3d to_camera = views_[i].centre - point;
    const double distance = to_camera.norm();
    if (-to_camera.dot(views_[i].axis) < cos_half_view_ * distance) continue;
    const Vector3f direction = (to_camera / distance).cast<float>();
    if (normal.dot(direction) < 0.2F) continue;
    const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(photos_[i].cam_from_enu * point);
    if (!pixel || pixel->minCoeff() < border_px || pixel->x() > camera_.width - border_px || pixel->y() > camera_.height - border_px) continue;
    photo[n] = static_cast<uint32_t>(i);
    rays.Set(n++, position + 0.01F * normal, direction, 0.01F, static_cast<float>(distance));
    if (n == raytrace::kPacket) Flush();
  }
  if (n > 0) Flush();
  return seeing;
}

}  // namespace skyquilt::simulate
