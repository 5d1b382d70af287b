// Sample positions along a ray: uniform steps on a lattice that starts at the stretch's near end (shifted by `jitter` in [0, 1) of a
// step), kept only in occupied cells. In a contracted frame the step grows as the frame shrinks.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/render/ray_box.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// Where a ray can meet the field: its box, or its slab out to where the contracted frame has no cells left.
inline Stretch FieldStretch(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (!map.contracted()) return RayBox(origin, direction, map.min_enu(), map.max_enu());
  const Eigen::Vector3d centre = 0.5 * (map.min_enu() + map.max_enu());
  const double reach = 20.0 * 0.5 * (map.max_enu() - map.min_enu()).head<2>().maxCoeff();
  return RayBox(origin, direction, Eigen::Vector3d(centre.x() - reach, centre.y() - reach, map.min_enu().z()),
                Eigen::Vector3d(centre.x() + reach, centre.y() + reach, map.max_enu().z()));
}

// The part of a ray over (or under) the ground plan of an uncontracted field. Inside it only the field itself, never the context, has matter.
inline Stretch PlanStretch(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d& low = map.min_enu();
  const Eigen::Vector3d& high = map.max_enu();
  return RayBox(origin, direction, Eigen::Vector3d(low.x(), low.y(), -kEver), Eigen::Vector3d(high.x(), high.y(), kEver));
}

namespace internal {

// Walks the cells of an uncontracted field in ray order (Amanatides and Woo 1987) and emits the lattice points of occupied ones.
template <typename Emit>
void MarchCells(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Stretch stretch, double step_m, float jitter,
                Emit&& emit) {
  const field::OccupancyGrid& grid = f.occupancy;
  const double cell_m = static_cast<double>(grid.cell) / f.map.units_per_metre();
  const Eigen::Vector3d entry = origin + stretch.t_near * direction - f.map.min_enu();
  const double length = stretch.t_far - stretch.t_near;
  int cell[3], increment[3];
  double next[3], delta[3];
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = std::clamp(static_cast<int>(std::floor(entry[axis] / cell_m)), 0, grid.size[axis] - 1);
    const double d = direction[axis];
    increment[axis] = d > 0.0 ? 1 : -1;
    if (d == 0.0) {
      next[axis] = delta[axis] = std::numeric_limits<double>::infinity();
    } else {
      delta[axis] = cell_m / std::abs(d);
      next[axis] = (cell_m * (cell[axis] + (d > 0.0 ? 1 : 0)) - entry[axis]) / d;
    }
  }
  double at = 0.0;
  while (at < length) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double leave = std::max(at, std::min(next[axis], length));
    if (grid.occupied[static_cast<size_t>(grid.Index(cell[0], cell[1], cell[2]))] != 0) {
      // Lattice midpoints (k + jitter) * step inside [at, leave).
      auto k = static_cast<int64_t>(std::ceil(at / step_m - static_cast<double>(jitter)));
      for (;; ++k) {
        const double t = (static_cast<double>(k) + static_cast<double>(jitter)) * step_m;
        if (!(t < leave)) break;
        if (t < at) continue;
        if (!emit(stretch.t_near + t, step_m, step_m)) return;
      }
    }
    at = leave;
    cell[axis] += increment[axis];
    if (cell[axis] < 0 || cell[axis] >= grid.size[axis]) return;
    next[axis] += delta[axis];
  }
}

template <typename Emit>
void MarchContracted(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Stretch stretch, double step_m,
                     float jitter, Emit&& emit) {
  double at = stretch.t_near;
  while (at < stretch.t_far) {
    const double scale = f.map.LocalScale(origin + at * direction);
    const double step = step_m / scale;
    const double t = at + static_cast<double>(jitter) * step;
    if (t < stretch.t_far) {
      const Eigen::Vector3f x = f.map.UnitFromEnu(origin + t * direction);
      if (f.occupancy.occupied[static_cast<size_t>(f.occupancy.IndexAt(x.x(), x.y(), x.z()))] != 0 && !emit(t, step, step_m)) return;
    }
    at += step;
  }
}

}  // namespace internal

// emit(t, length_m, unit_length_m) -> bool: distance along the ray, length of the interval, and that length measured in the
// uncontracted part's metres (what the log density refers to). Return false to stop.
template <typename Emit>
void March(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Stretch stretch, double step_m, float jitter,
           Emit&& emit) {
  if (stretch.Empty()) return;
  if (f.map.contracted()) {
    internal::MarchContracted(f, origin, direction, stretch, step_m, jitter, emit);
  } else {
    internal::MarchCells(f, origin, direction, stretch, step_m, jitter, emit);
  }
}

}  // namespace skyquilt::render
