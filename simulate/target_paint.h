// Targets painted on the ground, squares in black and white: those of ground control in four fields, whose common corner is the point, and slanted
// edges in two halves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulate/surface.h"

namespace skyquilt::simulate {

enum class TargetPattern { kFourFields, kTwoHalves };

struct PaintedTarget {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // ENU metres
  double side_m = 1.0;                               // of the square, measured horizontally
  double yaw_rad = 0.0;                              // of one side, counter-clockwise from east
  TargetPattern pattern = TargetPattern::kFourFields;
  // Albedo: by default bright, but seldom clipped in normally exposed photos. Of two halves the left one is black, along yaw.
  float black = 0.03F;
  float white = 0.55F;
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
