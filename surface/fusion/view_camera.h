// A picture of depth with what is needed to project many points into it, computed once. The picture's pixels must outlive it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct ViewCamera {
  Eigen::Matrix3d rotation;  // camera from ENU
  Eigen::Vector3d centre;    // ENU, metres
  double focal_px = 0.0, cx = 0.0, cy = 0.0;
  int width = 0, height = 0;
  bool photo = false;  // not a virtual view
  const float* depth_m = nullptr;
  const uint8_t* cosine = nullptr;
  const uint8_t* weight = nullptr;      // null: all full
  std::array<Eigen::Vector3d, 4> side;  // planes through the centre that bound the image: normals of length 1, camera frame, inwards
};

// Depths that can be used. Pictures mark others with NaN.
inline bool IsDepth(float depth_m) {
  return depth_m > 0.0F && depth_m < 1e30F;
}

// Box in ENU, metres.
struct MetricBox {
  Eigen::Vector3d min, max;
};

// Half-open rectangle of pixels.
struct PixelRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool Empty() const { return x0 >= x1 || y0 >= y1; }
};

// The views that may see something of the box, in their order; views without pixels or without a usable pose are left out.
std::vector<ViewCamera> CamerasThatSee(std::span<const DepthView> views, const MetricBox& box);

// False only when no part of the sphere is in front of the camera and inside the image.
bool MaySeeSphere(const ViewCamera& view, const Eigen::Vector3d& middle_enu, double radius_m);

// Holds every pixel whose ray meets the box, and maybe others.
PixelRectangle PixelsOfBox(const ViewCamera& view, const MetricBox& box);

}  // namespace skyquilt::surface
