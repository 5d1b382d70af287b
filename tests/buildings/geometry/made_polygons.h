// Polygons for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "buildings/geometry/polygon.h"
#include "core/base/random.h"

namespace skyquilt::buildings {

inline Polygon Box(double west, double south, double east, double north) {
  return {{{west, south}, {east, south}, {east, north}, {west, north}}, {}};
}

inline Polygon Moved(Polygon polygon, double angle_rad, const Eigen::Vector2d& by) {
  const auto move = [&](Eigen::Vector2d& p) {
    p = Eigen::Vector2d(std::cos(angle_rad) * p.x() - std::sin(angle_rad) * p.y(), std::sin(angle_rad) * p.x() + std::cos(angle_rad) * p.y()) + by;
  };
  for (Eigen::Vector2d& p : polygon.outer) move(p);
  for (auto& hole : polygon.holes) {
    for (Eigen::Vector2d& p : hole) move(p);
  }
  return polygon;
}

// Star-shaped around a random place in [0, 10)^2, with deep notches; sometimes with a hole around the same place.
inline Polygon RandomStar(base::Random& random) {
  const Eigen::Vector2d middle{random.Uniform(0.0, 10.0), random.Uniform(0.0, 10.0)};
  const int n = 3 + static_cast<int>(random.Below(12));
  const bool with_hole = random.Below(3) == 0;
  Polygon star;
  std::vector<Eigen::Vector2d> hole;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    star.outer.push_back(middle + random.Uniform(1.0, 5.0) * along);
    hole.push_back(middle + random.Uniform(0.1, 0.4) * along);
  }
  std::reverse(hole.begin(), hole.end());
  if (with_hole) star.holes.push_back(hole);
  return star;
}

}  // namespace skyquilt::buildings
