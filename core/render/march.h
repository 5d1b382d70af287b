// Sample positions along a ray: uniform steps on a lattice that starts at the interval's near end (shifted by `jitter` in [0, 1) of a
// step), kept only in occupied cells. In a contracted frame the step grows as the frame shrinks.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/ray_box.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// Where a ray can meet the field: its box, or its slab out to where the contracted frame has no cells left.
inline geo::Interval FieldInterval(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (!map.contracted()) return geo::RayBox(origin, direction, map.min_enu(), map.max_enu());
  const Eigen::Vector3d centre = 0.5 * (map.min_enu() + map.max_enu());
  const double reach = 20.0 * 0.5 * (map.max_enu() - map.min_enu()).head<2>().maxCoeff();
  return geo::RayBox(origin, direction, Eigen::Vector3d(centre.x() - reach, centre.y() - reach, map.min_enu().z()),
                     Eigen::Vector3d(centre.x() + reach, centre.y() + reach, map.max_enu().z()));
}

// The part of a ray over (or under) the ground plan of an uncontracted field. Inside it only the field itself, never the context, has matter.
inline geo::Interval PlanInterval(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d& low = map.min_enu();
  const Eigen::Vector3d& high = map.max_enu();
  return geo::RayBox(origin, direction, Eigen::Vector3d(low.x(), low.y(), -kEver), Eigen::Vector3d(high.x(), high.y(), kEver));
}

// Positions along a ray in a field's unit frame, computed in double: a line where the frame is not contracted.
class UnitRay {
 public:
  UnitRay(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)
      : map_(map),
        origin_(map.contracted() ? origin : Eigen::Vector3d((origin - map.min_enu()) * map.units_per_metre())),
        direction_(map.contracted() ? direction : Eigen::Vector3d(direction * map.units_per_metre())) {}
  Eigen::Vector3f At(double t) const {
    const Eigen::Vector3d p = origin_ + t * direction_;
    return map_.contracted() ? map_.UnitFromEnu(p) : Eigen::Vector3f(p.cast<float>());
  }

 private:
  const encoding::SpaceMap& map_;
  Eigen::Vector3d origin_, direction_;
};

namespace internal {

// Walks the cells of an uncontracted field in ray order (Amanatides and Woo 1987): visit(at, leave, cell) -> bool for every occupied one,
// distances from the interval's near end. False ends the walk.
template <typename Visit>
void WalkCells(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, Visit&& visit) {
  const field::OccupancyGrid& grid = f.occupancy;
  const double cell_m = static_cast<double>(grid.cell) / f.map.units_per_metre();
  const Eigen::Vector3d entry = origin + interval.t_near * direction - f.map.min_enu();
  const double length = interval.t_far - interval.t_near;
  int cell[3], increment[3];
  int64_t index_increment[3] = {1, grid.size[0], static_cast<int64_t>(grid.size[0]) * grid.size[1]};
  double next[3], delta[3];
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = std::clamp(static_cast<int>(std::floor(entry[axis] / cell_m)), 0, grid.size[axis] - 1);
    const double d = direction[axis];
    increment[axis] = d > 0.0 ? 1 : -1;
    index_increment[axis] *= increment[axis];
    if (d == 0.0) {
      next[axis] = delta[axis] = std::numeric_limits<double>::infinity();
    } else {
      delta[axis] = cell_m / std::abs(d);
      next[axis] = (cell_m * (cell[axis] + (d > 0.0 ? 1 : 0)) - entry[axis]) / d;
    }
  }
  double at = 0.0;
  int64_t index = grid.Index(cell[0], cell[1], cell[2]);
  while (at < length) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double leave = std::max(at, std::min(next[axis], length));
    if (grid.occupied[static_cast<size_t>(index)] != 0 && !visit(at, leave, index)) return;
    at = leave;
    cell[axis] += increment[axis];
    if (cell[axis] < 0 || cell[axis] >= grid.size[axis]) return;
    index += index_increment[axis];
    next[axis] += delta[axis];
  }
}

// Emits the lattice points (k + jitter) * step inside occupied cells.
template <typename Emit>
void MarchCells(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                float jitter, Emit&& emit) {
  WalkCells(f, origin, direction, interval, [&](double at, double leave, int64_t cell) {
    auto k = static_cast<int64_t>(std::ceil(at / step_m - static_cast<double>(jitter)));
    for (;; ++k) {
      const double t = (static_cast<double>(k) + static_cast<double>(jitter)) * step_m;
      if (!(t < leave)) return true;
      if (t >= at && !emit(interval.t_near + t, step_m, step_m, cell)) return false;
    }
  });
}

// The same walk with one sample for every interval of at most `step_m` inside occupied cells, at its middle: with steps longer than a cell
// a lattice would pass over thin surfaces.
template <typename Emit>
void MarchCellRuns(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                   Emit&& emit) {
  double run_begin = 0.0, run_end = -1.0;  // empty
  bool more = true;
  const auto flush = [&] {
    const double length = run_end - run_begin;
    if (more && length > 0.0) more = emit(interval.t_near + 0.5 * (run_begin + run_end), length, length);
    run_end = -1.0;
  };
  WalkCells(f, origin, direction, interval, [&](double at, double leave, int64_t) {
    // Cells follow each other without gaps only while rounding agrees: compare with a tolerance.
    if (run_end >= 0.0 && at > run_end + 1e-9 * step_m) flush();
    if (run_end < 0.0) run_begin = at;
    run_end = leave;
    while (more && run_end - run_begin > step_m) {
      more = emit(interval.t_near + run_begin + 0.5 * step_m, step_m, step_m);
      run_begin += step_m;
    }
    return more;
  });
  if (run_end >= 0.0) flush();
}

template <typename Emit>
void MarchContracted(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                     float jitter, Emit&& emit) {
  double at = interval.t_near;
  while (at < interval.t_far) {
    const double scale = f.map.LocalScale(origin + at * direction);
    const double step = step_m / scale;
    const double t = at + static_cast<double>(jitter) * step;
    if (t < interval.t_far) {
      const Eigen::Vector3f x = f.map.UnitFromEnu(origin + t * direction);
      const int64_t cell = f.occupancy.IndexAt(x.x(), x.y(), x.z());
      if (f.occupancy.occupied[static_cast<size_t>(cell)] != 0 && !emit(t, step, step_m, cell)) return;
    }
    at += step;
  }
}

}  // namespace internal

// Steps longer than the field's own: for pixels that cover more than the field's finest detail. emit(t, length_m, unit_length_m) as below.
template <typename Emit>
void MarchCoarse(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                 Emit&& emit) {
  if (interval.Empty()) return;
  if (f.map.contracted()) {
    internal::MarchContracted(f, origin, direction, interval, step_m, 0.5F,
                              [&](double t, double length_m, double unit_length_m, int64_t) { return emit(t, length_m, unit_length_m); });
  } else {
    internal::MarchCellRuns(f, origin, direction, interval, step_m, emit);
  }
}

// emit(t, length_m, unit_length_m, cell) -> bool: distance along the ray, length of the interval, that length measured in the uncontracted
// part's metres (what the log density refers to), and the occupancy cell. Return false to stop.
template <typename Emit>
void March(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
           float jitter, Emit&& emit) {
  if (interval.Empty()) return;
  if (f.map.contracted()) {
    internal::MarchContracted(f, origin, direction, interval, step_m, jitter, emit);
  } else {
    internal::MarchCells(f, origin, direction, interval, step_m, jitter, emit);
  }
}

}  // namespace skyquilt::render
