#include "surface/fusion/view_camera.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::surface {
namespace {

bool IsUsablePose(const ViewPose& pose) {
  return pose.width > 0 && pose.height > 0 && pose.focal_px > 0.0 && std::isfinite(pose.focal_px) && std::isfinite(pose.cx) &&
         std::isfinite(pose.cy) && pose.cam_from_enu.rotation.coeffs().allFinite() && pose.cam_from_enu.translation.allFinite();
}

ViewCamera CameraOf(const DepthView& view) {
  const ViewPose& pose = view.pose;
  const size_t n_pixels = static_cast<size_t>(pose.width) * static_cast<size_t>(pose.height);
  SKYQUILT_CHECK(view.depth_m.size() == n_pixels && view.cosine.size() == n_pixels && (view.weight.empty() || view.weight.size() == n_pixels),
                 "a picture of depth does not have the size of its pose");
  ViewCamera camera;
  camera.rotation = pose.cam_from_enu.rotation.toRotationMatrix();
  camera.centre = pose.Centre();
  camera.focal_px = pose.focal_px;
  camera.cx = pose.cx;
  camera.cy = pose.cy;
  camera.width = pose.width;
  camera.height = pose.height;
  camera.photo = pose.photo >= 0;
  camera.depth_m = view.depth_m.data();
  camera.cosine = view.cosine.data();
  if (!view.weight.empty()) camera.weight = view.weight.data();
  camera.side[0] = Eigen::Vector3d(pose.focal_px, 0.0, pose.cx).normalized();
  camera.side[1] = Eigen::Vector3d(-pose.focal_px, 0.0, pose.width - pose.cx).normalized();
  camera.side[2] = Eigen::Vector3d(0.0, pose.focal_px, pose.cy).normalized();
  camera.side[3] = Eigen::Vector3d(0.0, -pose.focal_px, pose.height - pose.cy).normalized();
  return camera;
}

// The corners in the camera frame.
std::array<Eigen::Vector3d, 8> CornersInCamera(const ViewCamera& view, const MetricBox& box) {
  std::array<Eigen::Vector3d, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner((i & 1U) != 0 ? box.max.x() : box.min.x(), (i & 2U) != 0 ? box.max.y() : box.min.y(),
                                 (i & 4U) != 0 ? box.max.z() : box.min.z());
    corners[i] = view.rotation * (corner - view.centre);
  }
  return corners;
}

bool MaySeeBox(const ViewCamera& view, const MetricBox& box) {
  const std::array<Eigen::Vector3d, 8> corners = CornersInCamera(view, box);
  const auto all_outside = [&](const Eigen::Vector3d& inwards) {
    return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& corner) { return inwards.dot(corner) < 0.0; });
  };
  return !all_outside(Eigen::Vector3d::UnitZ()) && std::none_of(view.side.begin(), view.side.end(), all_outside);
}

}  // namespace

std::vector<ViewCamera> CamerasThatSee(std::span<const DepthView> views, const MetricBox& box) {
  std::vector<ViewCamera> cameras;
  for (const DepthView& view : views) {
    if (!IsUsablePose(view.pose)) continue;
    const ViewCamera camera = CameraOf(view);
    if (MaySeeBox(camera, box)) cameras.push_back(camera);
  }
  return cameras;
}

bool MaySeeSphere(const ViewCamera& view, const Eigen::Vector3d& middle_enu, double radius_m) {
  const Eigen::Vector3d middle = view.rotation * (middle_enu - view.centre);
  if (middle.z() < -radius_m) return false;
  for (const Eigen::Vector3d& inwards : view.side) {
    if (inwards.dot(middle) < -radius_m) return false;
  }
  return true;
}

PixelRectangle PixelsOfBox(const ViewCamera& view, const MetricBox& box) {
  const PixelRectangle whole{0, 0, view.width, view.height};
  Eigen::Vector2d low(view.width, view.height);
  Eigen::Vector2d high(0.0, 0.0);
  for (const Eigen::Vector3d& corner : CornersInCamera(view, box)) {
    // The picture of a box that reaches behind the camera is not bounded by that of its corners.
    if (!(corner.z() > 0.01 * corner.norm())) return whole;
    const Eigen::Vector2d pixel(view.focal_px * corner.x() / corner.z() + view.cx, view.focal_px * corner.y() / corner.z() + view.cy);
    low = low.cwiseMin(pixel);
    high = high.cwiseMax(pixel);
  }
  // One pixel more on each side, for rounding.
  const auto clamped = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size))); };
  return {clamped(low.x() - 1.0, view.width), clamped(low.y() - 1.0, view.height), clamped(std::ceil(high.x()) + 1.0, view.width),
          clamped(std::ceil(high.y()) + 1.0, view.height)};
}

}  // namespace skyquilt::surface
