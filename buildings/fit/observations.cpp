#include "buildings/fit/observations.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::buildings {
namespace {

// A coordinate of a place along one of the axes, and its derivative with respect to yaw.
struct Coordinate {
  double at = 0.0, by_yaw = 0.0;
};
Coordinate CoordinateOf(const Eigen::Vector2d& place, int axis, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double u = c * place.x() + s * place.y(), v = c * place.y() - s * place.x();
  return axis == 0 ? Coordinate{u, v} : Coordinate{v, -u};
}

double RoofResidual(const Observation& o, const Parameters& parameters, const double* values, double* gradient) {
  const int eave = parameters.eave(o.part), ridge = parameters.ridge(o.part);
  if (o.half_low < 0) {
    if (gradient != nullptr) gradient[eave] -= o.tilt;
    return o.tilt * (o.height - values[eave]);
  }
  const int line = parameters.line(o.axis, o.line);
  const int low = parameters.line(o.half_axis, o.half_low), high = parameters.line(o.half_axis, o.half_high);
  const Coordinate at = CoordinateOf(o.place, o.axis, values[parameters.yaw()]);
  const double half = 0.5 * (values[high] - values[low]);
  const double rise = (values[ridge] - values[eave]) / half;
  const double inside = o.side * (values[line] - at.at);
  if (gradient != nullptr) {
    gradient[eave] -= o.tilt * (1.0 - inside / half);
    gradient[ridge] -= o.tilt * inside / half;
    gradient[line] -= o.tilt * rise * o.side;
    gradient[parameters.yaw()] += o.tilt * rise * o.side * at.by_yaw;
    gradient[low] -= o.tilt * 0.5 * rise * inside / half;
    gradient[high] += o.tilt * 0.5 * rise * inside / half;
  }
  return o.tilt * (o.height - values[eave] - rise * inside);
}

double LineResidual(const Observation& o, const Parameters& parameters, const double* values, double* gradient) {
  const int line = parameters.line(o.axis, o.line);
  const Coordinate at = CoordinateOf(o.place, o.axis, values[parameters.yaw()]);
  if (gradient != nullptr) {
    gradient[line] -= o.side;
    gradient[parameters.yaw()] += o.side * at.by_yaw;
    gradient[o.parameter] -= o.reach;
  }
  return o.side * (at.at - values[line]) - o.value - o.reach * values[o.parameter];
}

}  // namespace

double Residual(const Observation& observation, const Parameters& parameters, const double* values, double* gradient) {
  if (gradient != nullptr) std::fill_n(gradient, parameters.size(), 0.0);
  switch (observation.kind) {
    case ObservationKind::kRoof:
      return RoofResidual(observation, parameters, values, gradient);
    case ObservationKind::kLine:
      return LineResidual(observation, parameters, values, gradient);
    case ObservationKind::kPrior:
      if (gradient != nullptr) gradient[observation.parameter] = 1.0;
      return values[observation.parameter] - observation.value;
  }
  return 0.0;
}

double Group::Weight() const {
  const auto n = static_cast<double>(observations.size());
  return 1.0 / (sigma_m * sigma_m * n / std::max(n_eff, 1.0) + n * common_m * common_m);
}

void Group::Thin(size_t most) {
  const size_t n = observations.size();
  if (n <= most) return;
  const double step = static_cast<double>(n) / static_cast<double>(most);
  for (size_t i = 0; i < most; ++i) {
    const auto from = static_cast<size_t>(static_cast<double>(i) * step);
    observations[i] = observations[from];
    at[i] = at[from];
  }
  observations.resize(most);
  at.resize(most);
}

}  // namespace skyquilt::buildings
