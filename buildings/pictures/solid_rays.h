// Where rays hit a solid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

class SolidRays {
 public:
  explicit SolidRays(const Solid& solid);

  // The least t > 0 at which origin + t * direction is on a face other than these two (indices, -1: none), whichever side it shows; infinite when
  // there is none.
  double FirstHit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, int but = -1, int and_but = -1) const;

 private:
  struct Triangle {
    Eigen::Vector3d a, ab, ac;
    int face = 0;
  };
  std::vector<Triangle> triangles_;
};

}  // namespace skyquilt::buildings
