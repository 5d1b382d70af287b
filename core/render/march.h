// Ray marching: places samples along a ray at uniform steps, and skips cells of the occupancy grid that are free. The first step starts at the near
// end of the interval; samples are shifted by `jitter` in [0, 1) of a step. In a contracted frame the step grows as the frame shrinks.
// Rays are in survey ENU, metres.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/ray_box.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// The interval of a ray inside the field: in its box, or for a contracted field in its slab up to 20 times its half width from the centre, beyond
// which the contracted frame has no cells left. Empty when the ray misses it.
inline geo::Interval FieldInterval(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (!map.contracted()) return geo::RayBox(origin, direction, map.min_enu(), map.max_enu());
  const Eigen::Vector3d centre = 0.5 * (map.min_enu() + map.max_enu());
  const double reach = 20.0 * 0.5 * (map.max_enu() - map.min_enu()).head<2>().maxCoeff();
  return geo::RayBox(origin, direction, Eigen::Vector3d(centre.x() - reach, centre.y() - reach, map.min_enu().z()),
                     Eigen::Vector3d(centre.x() + reach, centre.y() + reach, map.max_enu().z()));
}

// The interval of a ray inside the field's ground plan (its box, extended infinitely up and down). There only the field itself has density, never the
// context.
inline geo::Interval PlanInterval(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d& low = map.min_enu();
  const Eigen::Vector3d& high = map.max_enu();
  return geo::RayBox(origin, direction, Eigen::Vector3d(low.x(), low.y(), -kInfinity), Eigen::Vector3d(high.x(), high.y(), kInfinity));
}

// Positions along a ray in a field's unit frame, computed in double. Without contraction the ray is a straight line there too, which is cheaper.
class UnitRay {
 public:
  UnitRay(const encoding::SpaceMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)
      : map_(map),
        origin_(map.contracted() ? origin : Eigen::Vector3d((origin - map.min_enu()) * map.units_per_metre())),
        direction_(map.contracted() ? direction : Eigen::Vector3d(direction * map.units_per_metre())),
        units_per_metre_(map.contracted() ? 1.0 : map.units_per_metre()) {}
  Eigen::Vector3f At(double t) const { return Unit(origin_ + t * direction_); }
  // The position `beside` that at distance t, ENU metres.
  Eigen::Vector3f At(double t, const Eigen::Vector3d& beside) const { return Unit(origin_ + t * direction_ + units_per_metre_ * beside); }

 private:
  Eigen::Vector3f Unit(const Eigen::Vector3d& p) const { return map_.contracted() ? map_.UnitFromEnu(p) : Eigen::Vector3f(p.cast<float>()); }

  const encoding::SpaceMap& map_;
  Eigen::Vector3d origin_, direction_;  // in the unit frame without contraction, else ENU
  double units_per_metre_;              // of these
};

namespace internal {

// Traverses the cells of an uncontracted field along a ray (Amanatides and Woo 1987). Calls visit(enter, leave, cell) -> bool for every occupied
// cell; distances are metres from the near end of the interval. Stops when visit returns false.
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
    if (grid.occupied[static_cast<size_t>(index)] && !visit(at, leave, index)) return;
    at = leave;
    cell[axis] += increment[axis];
    if (cell[axis] < 0 || cell[axis] >= grid.size[axis]) return;
    index += index_increment[axis];
    next[axis] += delta[axis];
  }
}

// Emits the samples at (k + jitter) * step inside occupied cells, k = 0, 1, ...
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

// Cuts the occupied part of the ray into intervals of at most `step_m` and emits one sample in each, at the share `jitter` of its length: with steps
// longer than a cell, samples at fixed distances would skip thin surfaces.
template <typename Emit>
void MarchCellRuns(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                   float jitter, Emit&& emit) {
  const double share = static_cast<double>(jitter);
  double run_begin = 0.0, run_end = -1.0;  // empty
  bool more = true;
  const auto flush = [&] {
    const double length = run_end - run_begin;
    if (more && length > 0.0) more = emit(interval.t_near + run_begin + share * length, length, length);
    run_end = -1.0;
  };
  WalkCells(f, origin, direction, interval, [&](double at, double leave, int64_t) {
    // The end of a cell and the start of the next one may differ by rounding: compare with a tolerance.
    if (run_end >= 0.0 && at > run_end + 1e-9 * step_m) flush();
    if (run_end < 0.0) run_begin = at;
    run_end = leave;
    while (more && run_end - run_begin > step_m) {
      more = emit(interval.t_near + run_begin + share * step_m, step_m, step_m);
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
      if (f.occupancy.occupied[static_cast<size_t>(cell)] && !emit(t, step, step_m, cell)) return;
    }
    at += step;
  }
}

// Steps longer than the field's own, as MarchCellRuns does it: the ray is followed in steps of the field's own, so that no surface is skipped and the
// last interval ends where the ray leaves the field.
template <typename Emit>
void MarchContractedRuns(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval,
                         double step_m, float jitter, Emit&& emit) {
  const double share = static_cast<double>(jitter);
  double begin = 0.0, length = 0.0, unit_length = 0.0;  // of the present run
  const auto flush = [&] {
    const bool more = !(length > 0.0) || emit(begin + share * length, length, unit_length);
    length = unit_length = 0.0;
    return more;
  };
  double at = interval.t_near;
  while (at < interval.t_far) {
    const double scale = f.map.LocalScale(origin + at * direction);
    const double step = std::min(f.step_m / scale, interval.t_far - at);
    const Eigen::Vector3f x = f.map.UnitFromEnu(origin + (at + 0.5 * step) * direction);
    const bool occupied = f.occupancy.occupied[static_cast<size_t>(f.occupancy.IndexAt(x.x(), x.y(), x.z()))];
    if ((!occupied || unit_length + step * scale > step_m) && !flush()) return;
    if (occupied) {
      if (!(length > 0.0)) begin = at;
      length += step;
      unit_length += step * scale;
    }
    at += step;
  }
  flush();
}

}  // namespace internal

// For steps longer than the field's own, for pixels that cover more than the field's finest detail. emit(t, length_m, unit_length_m) -> bool as for
// March.
template <typename Emit>
void MarchCoarse(const TrainedField& f, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, geo::Interval interval, double step_m,
                 float jitter, Emit&& emit) {
  if (interval.Empty()) return;
  if (f.map.contracted()) {
    internal::MarchContractedRuns(f, origin, direction, interval, step_m, jitter, emit);
  } else {
    internal::MarchCellRuns(f, origin, direction, interval, step_m, jitter, emit);
  }
}

// Calls emit(t, length_m, unit_length_m, cell) -> bool for every sample: its distance along the ray, the length of its interval, that length after
// contraction (log density refers to it), and its occupancy cell. Stops when emit returns false.
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
