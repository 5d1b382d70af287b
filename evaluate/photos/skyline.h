// How high what a survey knows stands around a camera, told by its sparse points: a ray above it that meets nothing shows the sky.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "core/survey/survey.h"

namespace skyquilt::evaluate::photos {

class Skyline {
 public:
  // Around a camera at `eye_enu`. Frame: survey ENU.
  Skyline(std::span<const survey::SparsePoint> points, const Eigen::Vector3d& eye_enu);

  // Whether the direction rises and no point stands higher on this side of the camera, up to 1.5 to 3 degrees beside the direction. A hole that a
  // field has in a wall is no sky: points of the wall stand above it.
  bool IsAbove(const Eigen::Vector3d& direction_enu) const;

 private:
  static constexpr size_t kSides = 240;  // all round
  static size_t SideOf(const Eigen::Vector3d& direction_enu);
  std::array<double, kSides> highest_;  // sine of the elevation of the highest point there and on the sides next to it; -1: none
};

}  // namespace skyquilt::evaluate::photos
