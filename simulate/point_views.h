// Finds the photos of a simulated survey that see a point of the static scene.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/camera/camera.h"
#include "simulate/flight.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

class PointViews {
 public:
  // Holds references: all must outlive it.
  PointViews(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos);

  // Indices of the photos that see a surface point with this normal, ascending: it is at least border_px inside the image, not at a grazing angle,
  // and nothing hides it, moving cars included. ENU metres.
  std::vector<uint32_t> Seeing(const Eigen::Vector3f& position, const Eigen::Vector3f& normal, double border_px) const;
  // Replaces *found by the indices of the photos that look down onto a place near enough to show it, ascending: all that may, and some others. Where
  // photos look level, all.
  void FindNear(const Eigen::Vector3d& place, std::vector<uint32_t>* found) const;
  // Whether a moving car hides what the photo sees in this direction (unit, ENU) before far_m metres.
  bool HiddenByCar(size_t photo, const Eigen::Vector3f& direction, float far_m) const;
  const Eigen::Vector3d& Centre(size_t photo) const { return views_[photo].centre; }  // of the camera, ENU metres

 private:
  struct View {
    Eigen::Vector3d centre;
    Eigen::Vector3d axis;  // optical axis in ENU
  };

  const World& world_;
  const camera::Camera& camera_;
  const std::vector<PhotoPlan>& photos_;
  std::vector<View> views_;
  std::vector<MovingScene> moving_;
  std::vector<uint32_t> by_east_;  // indices of the photos, from west to east
  double highest_m_ = 0.0;         // camera
  double reach_ = 0.0;             // horizontal metres that a photo sees per metre of its height above a place; infinite where it sees the horizon
  double cos_half_view_ = 1.0;     // a point farther from the optical axis than the image corners is not in the photo
};

}  // namespace skyquilt::simulate
