#include "viewer/engine/pass_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/base/errors.h"
#include "products/camera_path.h"

namespace skyquilt::viewer {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMargin = 0.05;  // of the scene's diagonal: orthographic rays start this far before its box

// How far behind the eye the scene's box begins, along the optical axis.
double BeginsBehind(const SceneFrame& scene, const Eigen::Vector3d& eye, const Eigen::Vector3d& ahead) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d x;
    for (int axis = 0; axis < 3; ++axis) x[axis] = (corner >> axis & 1) != 0 ? scene.max_enu[axis] : scene.min_enu[axis];
    nearest = std::min(nearest, ahead.dot(x - eye));
  }
  nearest -= kMargin * (scene.max_enu - scene.min_enu).norm();
  return std::isfinite(nearest) ? std::max(0.0, -nearest) : 0.0;
}

}  // namespace

std::vector<PassSize> PassSizes(int width, int height) {
  std::vector<PassSize> sizes;
  for (const int divisor : {4, 2, 1}) {
    const PassSize size{(width + divisor - 1) / divisor, (height + divisor - 1) / divisor};
    if (divisor == 1 || (size.width >= kMinViewSize && size.height >= kMinViewSize)) sizes.push_back(size);
  }
  return sizes;
}

PassRays::PassRays(const ViewRequest& view, PassSize size, const SceneFrame& scene)
    : size_(size),
      eye_enu_(view.eye_enu),
      cam_from_enu_(view.cam_from_enu),
      fovy_deg_or_height_m_(view.orthographic ? view.view_height_m : view.fovy_deg) {
  Place(scene);
  if (view.orthographic) {
    pixel_m_ = view.view_height_m / size.height;
    back_m_ = BeginsBehind(scene, cam_from_scene_.OriginInSource(), ahead_);
  } else {
    const double fov_deg = products::FovAcrossWidth(view.fovy_deg, size.width, size.height);
    camera_.emplace(products::PinholeCamera(size.width, size.height, fov_deg), cam_from_scene_, scene.cones);
  }
}

PassRays::PassRays(const products::View& photo, const SceneFrame& scene)
    : size_{photo.camera.width, photo.camera.height},
      eye_enu_(photo.cam_from_enu.OriginInSource()),
      cam_from_enu_(photo.cam_from_enu.rotation),
      fovy_deg_or_height_m_(2.0 * std::atan(0.5 * photo.camera.height / std::max(1e-9, photo.camera.FocalY())) * kDegPerRad) {
  Place(scene);
  // Without the detour over the eye, which would change the last bits.
  if (!scene.scene_from_main) cam_from_scene_ = photo.cam_from_enu;
  camera_.emplace(photo.camera, cam_from_scene_, scene.cones);
}

void PassRays::Place(const SceneFrame& scene) {
  cam_from_scene_ = {cam_from_enu_, -(cam_from_enu_ * eye_enu_)};
  if (scene.scene_from_main) {
    cam_from_scene_.rotation = (cam_from_enu_ * scene.scene_from_main->rotation.conjugate()).normalized();
    cam_from_scene_.translation = -(cam_from_scene_.rotation * (*scene.scene_from_main * eye_enu_));
  }
  ahead_ = cam_from_scene_.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

void PassRays::Make(std::span<const size_t> pixels, std::span<render::Ray> out) const {
  if (camera_) {
    camera_->Make(pixels, out);
    return;
  }
  SKYQUILT_CHECK(pixels.size() == out.size(), std::to_string(pixels.size()) + " pixels, " + std::to_string(out.size()) + " rays");
  const geo::Rigid3d scene_from_cam = cam_from_scene_.Inverse();
  const auto width = static_cast<size_t>(size_.width);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const size_t row_number = pixels[i] / width;
    const auto row = static_cast<double>(row_number), column = static_cast<double>(pixels[i] % width);
    const Eigen::Vector3d start((column + 0.5 - 0.5 * size_.width) * pixel_m_, (row + 0.5 - 0.5 * size_.height) * pixel_m_, -back_m_);
    out[i] = {.origin_enu = scene_from_cam * start, .direction_enu = ahead_.normalized(), .pixel_width = static_cast<float>(pixel_m_)};
  }
}

float PassRays::Depth(const render::Ray& ray, const render::RayColor& color) const {
  const double z = static_cast<double>(color.depth_median) * ahead_.dot(ray.direction_enu) - back_m_;
  // Rays of very wide lenses can point backwards.
  if (camera_ && !(z > 0.0)) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(z);
}

}  // namespace skyquilt::viewer
