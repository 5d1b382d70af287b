#include "prepare/bundle/adjusted_lens.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::prepare::bundle {
namespace {

// Models up to OPENCV have one focal length or two, the principal point, then k1, k2, p1, p2 or as many of these as they have.
bool IsKnown(const camera::Camera& camera) {
  return camera.model <= camera::CameraModel::kOpencv;
}

std::ptrdiff_t CountFocalLengths(const camera::Camera& camera) {
  return camera::HasOneFocalLength(camera.model) ? 1 : 2;
}

}  // namespace

std::optional<Lens> LensOf(const camera::Camera& camera) {
  if (!IsKnown(camera)) return std::nullopt;
  const std::vector<double>& p = camera.params;
  const std::ptrdiff_t n_focal = CountFocalLengths(camera);
  Lens lens = {p[0], n_focal == 1 ? 1.0 : p[1] / p[0]};
  std::copy(p.begin() + n_focal, p.end(), lens.begin() + 2);
  return lens;
}

camera::Camera CameraOf(const Lens& lens, const camera::Camera& model) {
  camera::Camera camera = model;
  if (!IsKnown(model)) return camera;
  const std::ptrdiff_t n_focal = CountFocalLengths(model);
  camera.params[0] = lens[0];
  if (n_focal == 2) camera.params[1] = lens[0] * lens[1];
  std::copy_n(lens.begin() + 2, std::ssize(camera.params) - n_focal, camera.params.begin() + n_focal);
  return camera;
}

int CountNumbers(const camera::Camera& camera) {
  return static_cast<int>(IsKnown(camera) ? Lens{}.size() : camera.params.size());
}

std::vector<int> HeldNumbers(const camera::Camera& camera, bool free_centre) {
  std::vector<int> held;
  const int n_focal = static_cast<int>(CountFocalLengths(camera)), centre = IsKnown(camera) ? 2 : n_focal;
  if (!free_centre) held = {centre, centre + 1};
  if (n_focal < centre) held.push_back(1);
  const int first_missing = static_cast<int>(camera.params.size()) - n_focal + centre;
  for (int k = first_missing; k < CountNumbers(camera); ++k) held.push_back(k);
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
