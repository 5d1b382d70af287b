// Directions modulo 90 degrees.
#pragma once

#include <cmath>
#include <numbers>

namespace skyquilt::buildings {

// Direction::concentration below which a building has no dominant directions.
inline constexpr double kLeastConcentration = 0.5;

inline constexpr double kRightAngle_rad = 0.5 * std::numbers::pi;

// a - b, -45 to 45 degrees.
inline double RightAngleDifference(double a, double b) {
  return std::remainder(a - b, kRightAngle_rad);
}

// 0 to 90 degrees, without 90.
inline double InRightAngle(double angle) {
  const double wrapped = angle - kRightAngle_rad * std::floor(angle / kRightAngle_rad);
  return wrapped < kRightAngle_rad ? wrapped : 0.0;
}

}  // namespace skyquilt::buildings
