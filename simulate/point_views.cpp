#include "simulate/point_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
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
  for (size_t i = 0; i < views_.size(); ++i) {
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
