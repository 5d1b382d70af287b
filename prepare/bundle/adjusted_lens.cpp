#include "prepare/bundle/adjusted_lens.h"

#include <cmath>
#include <tuple>

namespace skyquilt::prepare::bundle {

using camera::CameraModel;

std::optional<Lens> LensOf(const camera::Camera& camera) {
  const std::vector<double>& p = camera.params;
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
      return Lens{p[0], 1.0, p[1], p[2], 0.0, 0.0, 0.0, 0.0};
    case CameraModel::kPinhole:
      return Lens{p[0], p[1] / p[0], p[2], p[3], 0.0, 0.0, 0.0, 0.0};
    case CameraModel::kSimpleRadial:
      return Lens{p[0], 1.0, p[1], p[2], p[3], 0.0, 0.0, 0.0};
    case CameraModel::kRadial:
      return Lens{p[0], 1.0, p[1], p[2], p[3], p[4], 0.0, 0.0};
    case CameraModel::kOpencv:
      return Lens{p[0], p[1] / p[0], p[2], p[3], p[4], p[5], p[6], p[7]};
    default:
      break;
  }
  return std::nullopt;
}

camera::Camera CameraOf(const Lens& lens, const camera::Camera& model) {
  camera::Camera camera = model;
  const auto [f, ratio, cx, cy, k1, k2, p1, p2] = lens;
  switch (model.model) {
    case CameraModel::kSimplePinhole:
      camera.params = {f, cx, cy};
      break;
    case CameraModel::kPinhole:
      camera.params = {f, f * ratio, cx, cy};
      break;
    case CameraModel::kSimpleRadial:
      camera.params = {f, cx, cy, k1};
      break;
    case CameraModel::kRadial:
      camera.params = {f, cx, cy, k1, k2};
      break;
    case CameraModel::kOpencv:
      camera.params = {f, f * ratio, cx, cy, k1, k2, p1, p2};
      break;
    default:
      break;
  }
  return camera;
}

int CountNumbers(const camera::Camera& camera) {
  return static_cast<int>(LensOf(camera) ? std::tuple_size_v<Lens> : camera.params.size());
}

std::vector<int> HeldNumbers(const camera::Camera& camera, bool free_centre) {
  std::vector<int> held;
  int centre = 2;
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
      held = {1, 4, 5, 6, 7};
      break;
    case CameraModel::kPinhole:
      held = {4, 5, 6, 7};
      break;
    case CameraModel::kSimpleRadial:
      held = {1, 5, 6, 7};
      break;
    case CameraModel::kRadial:
      held = {1, 6, 7};
      break;
    default:
      centre = camera::HasOneFocalLength(camera.model) ? 1 : 2;
      break;
  }
  if (!free_centre) held.insert(held.end(), {centre, centre + 1});
  return held;
}

Eigen::Vector2d Project(const Lens& lens, const Eigen::Vector3d& x_in_cam, LensJacobian* jacobian) {
  const auto [f, ratio, cx, cy, k1, k2, p1, p2] = lens;
  constexpr double kLeastDepth = 1e-9;
  const double z = std::abs(x_in_cam.z()) < kLeastDepth ? kLeastDepth : x_in_cam.z();
  const double x = x_in_cam.x() / z, y = x_in_cam.y() / z;
  const double s = x * x + y * y;
  const double radial = 1.0 + s * (k1 + s * k2);
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x);
  const double yd = y * radial + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y;
  const double fy = f * ratio;
  if (jacobian != nullptr) {
    const double slope = 2.0 * (k1 + 2.0 * s * k2);  // of `radial` by x over x
    const double mixed = x * y * slope + 2.0 * (p1 * x + p2 * y);
    Eigen::Matrix2d plane;
    plane(0, 0) = f * (radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x);
    plane(0, 1) = f * mixed;
    plane(1, 0) = fy * mixed;
    plane(1, 1) = fy * (radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x);
    Eigen::Matrix<double, 2, 3> ideal;
    ideal << 1.0 / z, 0.0, -x / z, 0.0, 1.0 / z, -y / z;
    jacobian->by_point = plane * ideal;
    jacobian->by_lens.row(0) << xd, 0.0, 1.0, 0.0, f * x * s, f * x * s * s, f * 2.0 * x * y, f * (s + 2.0 * x * x);
    jacobian->by_lens.row(1) << ratio * yd, f * yd, 0.0, 1.0, fy * y * s, fy * y * s * s, fy * (s + 2.0 * y * y), fy * 2.0 * x * y;
  }
  return {f * xd + cx, fy * yd + cy};
}

}  // namespace skyquilt::prepare::bundle
