// Rays that look down at a box of 10 by 4 from above it and from beside it, for tests.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/base/random.h"
#include "core/render/ray.h"

namespace skyquilt::render {

inline std::vector<Ray> RaysFromAbove(int n) {
  base::Random random(3);
  std::vector<Ray> rays;
  for (int i = 0; i < n; ++i) {
    Ray ray;
    ray.origin_enu = {random.Uniform(-3.0, 13.0), random.Uniform(-3.0, 7.0), 12.0};
    ray.direction_enu = Eigen::Vector3d{random.Uniform(-0.6, 0.6), random.Uniform(-0.6, 0.6), -1.0}.normalized();
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace skyquilt::render
