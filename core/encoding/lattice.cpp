#include "core/encoding/lattice.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::encoding {

kernel::GridLevel DenseLattice(const double extent[3], double resolution) {
  kernel::GridLevel level;
  level.cells_per_unit = static_cast<float>(resolution);
  for (int axis = 0; axis < 3; ++axis) level.size[axis] = std::max(2, static_cast<int32_t>(std::ceil(extent[axis] * resolution - 1e-9)) + 1);
  level.dense = true;
  return level;
}

double LatticePoints(const kernel::GridLevel& level) {
  double points = 1.0;
  for (const int32_t size : level.size) points *= size;
  return points;
}

double FinestResolutionWithinBudget(double budget, double finest, const std::function<double(double)>& count) {
  if (count(finest) <= budget) return finest;
  double fits = 1.0, too_fine = finest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (fits + too_fine);
    (count(middle) <= budget ? fits : too_fine) = middle;
  }
  return fits;
}

}  // namespace skyquilt::encoding
