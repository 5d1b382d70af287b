// Targets of ground control: squares on the ground in four fields, black and white in turn, whose common corner is the point.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulate/surface.h"

namespace skyquilt::simulate {

struct PaintedTarget {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // ENU metres
  double side_m = 1.0;                               // of the square, measured horizontally
  double yaw_rad = 0.0;                              // of one side, counter-clockwise from east
};

class TargetPaint {
 public:
  TargetPaint() = default;
  explicit TargetPaint(std::vector<PaintedTarget> targets);

  // Changes the colour of the ground at the hit where a target covers it, averaged over the width of a pixel. Thread-safe.
  void Apply(const Hit& hit, Surface& surface) const;

 private:
  std::vector<PaintedTarget> targets_;  // from west to east
  double reach_m_ = 0.0;                // of the largest one, from its centre to a corner
};

}  // namespace skyquilt::simulate
