#include "bench/numerics/prior_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace skyquilt::bench {
namespace {

using Eigen::Vector3d;

const double kPriorsHiddenBehind = -std::log(1e-3);
constexpr double kLeastFacing = 0.2, kReachVoxels = 1.5, kLeastWidthVoxels = 0.1, kLeastSlopePerVoxel = 0.05;

double Square(double x) {
  return x * x;
}

// Where in an interval its light is stopped on average, as a share of its length: the integral of s tau exp(-tau s) over [0, 1] / (1 - exp(-tau)).
double MeanStopShare(double tau) {
  if (tau < 1e-6) return 0.5;
  return (1.0 - (1.0 + tau) * std::exp(-tau)) / (tau * -std::expm1(-tau));
}

double Robust(double s, double kappa) {
  return s * s / (1.0 + Square(s / kappa));
}

}  // namespace

PriorReference::PriorReference(const render::TrainedField& target, const ReferenceField& field, const worker::RayBatch& batch,
                               const worker::StepPriors& priors, const ReferenceState& state)
    : target_(target), field_(field), priors_(priors) {
  for (const worker::BatchRay& ray : batch.rays) rays_.push_back(Start(batch, ray, state));
  for (Ray& ray : rays_) {
    if (priors_.planes > 0.0 && ray.Opaque()) AddKnownPlane(ray);
  }
  for (size_t first = 0; first < rays_.size();) {
    size_t end = first + 1;
    while (end < rays_.size() && rays_[end].ray->segment == rays_[first].ray->segment) ++end;
    AddSegment(first, end);
    first = end;
  }
  for (Ray& ray : rays_) {
    if (priors_.Normals() && ray.ray->segment >= 0 && ray.Sharp(priors_.voxel_m)) AddNormal(state, ray);
  }
}

double PriorReference::Tau(const ReferenceState& state, const Sample& sample) const {
  return std::exp(field_.ForwardDensity(state.grid, state.networks, sample.place).log_density + target_.config.density_bias) * sample.unit_length;
}

PriorReference::Ray PriorReference::Start(const worker::RayBatch& batch, const worker::BatchRay& ray, const ReferenceState& state) const {
  const kernel::Positions at = batch.Positions(target_.config);
  Ray result;
  result.ray = &ray;
  double passed = 0.0, moment = 0.0, front = 0.0, back = 0.0;
  for (auto s = static_cast<size_t>(ray.begin); s < static_cast<size_t>(ray.begin + ray.count) && passed < kPriorsHiddenBehind; ++s) {
    Sample sample{.place = PlaceOf(at, s), .unit_length = static_cast<double>(batch.unit_length[s])};
    const double tau = Tau(state, sample), weight = std::exp(-passed) * -std::expm1(-tau);
    sample.stop_m = static_cast<double>(batch.t[s]) + target_.step_m * (MeanStopShare(tau) - 0.5);
    if (result.opacity < 0.15) front = sample.stop_m;
    if (result.opacity < 0.85) back = sample.stop_m;
    result.opacity += weight;
    moment += weight * sample.stop_m;
    passed += tau;
    result.samples.push_back(std::move(sample));
  }
  result.mean_m = moment / result.opacity;
  result.depth_m = back - front;
  return result;
}

void PriorReference::AddPull(Ray& ray, double weight, const worker::Plane& plane) {
  if (std::abs(plane.normal.dot(ray.ray->ray.direction_enu)) < kLeastFacing) return;
  const double width_m = std::max(static_cast<double>(ray.ray->ray.pixel_pitch) * ray.mean_m, kLeastWidthVoxels * priors_.voxel_m);
  ray.pulls.push_back({.weight = weight, .width_m = width_m, .plane = plane});
  ++pulls_;
}

void PriorReference::AddKnownPlane(Ray& ray) {
  const worker::PointPlane* const plane = priors_.known_planes->At(ray.At(ray.mean_m), kReachVoxels * priors_.voxel_m);
  if (plane == nullptr) return;
  const double facing = std::abs(plane->normal.dot(ray.ray->ray.direction_enu));
  if (facing * ray.depth_m > worker::kSharpVoxels * priors_.voxel_m) return;
  AddPull(ray, priors_.planes, {plane->point, plane->normal});
}

void PriorReference::AddSegment(size_t first, size_t end) {
  std::vector<Vector3d> points;
  for (size_t k = first; k < end; ++k) {
    if (rays_[k].Sharp(priors_.voxel_m)) points.push_back(rays_[k].At(rays_[k].mean_m));
  }
  const std::optional<worker::Plane> plane = worker::FitPlane(points);
  if (!plane) return;
  const std::optional<worker::Plane> upright = worker::UprightPlane(*plane);
  for (size_t k = first; k < end; ++k) {
    if (!rays_[k].Sharp(priors_.voxel_m)) continue;
    if (priors_.planar > 0.0) AddPull(rays_[k], priors_.planar, *plane);
    if (priors_.upright > 0.0 && upright) AddPull(rays_[k], priors_.upright, *upright);
  }
}

void PriorReference::AddNormal(const ReferenceState& state, Ray& ray) {
  const Vector3d x = ray.At(ray.mean_m);
  const Eigen::Vector3f unit = target_.map.UnitFromEnu(x);
  ReferenceField::Place place;
  place.positions.push_back({static_cast<double>(unit.x()), static_cast<double>(unit.y()), static_cast<double>(unit.z())});
  // As in PlaceOf: the deviation of a square of the pixel's width.
  if (target_.config.Cones()) {
    place.deviation = static_cast<double>(ray.ray->ray.pixel_pitch) * ray.mean_m * target_.map.units_per_metre() / std::sqrt(12.0);
  }
  if (!(Slope(state, place).norm() * priors_.voxel_m > kLeastSlopePerVoxel)) return;
  ray.end = place;
  if (const worker::PointPlane* const plane = priors_.known_planes->At(x, priors_.voxel_m)) {
    ray.known = plane->normal.dot(ray.ray->ray.direction_enu) > 0.0 ? Vector3d(-plane->normal) : plane->normal;
  }
  ++normals_;
}

std::vector<double> PriorReference::Weights(const ReferenceState& state, const Ray& ray) const {
  std::vector<double> weights;
  weights.reserve(ray.samples.size());
  double before = 0.0;
  for (const Sample& sample : ray.samples) {
    const double tau = Tau(state, sample);
    weights.push_back(std::exp(-before) * -std::expm1(-tau));
    before += tau;
  }
  return weights;
}

Vector3d PriorReference::Slope(const ReferenceState& state, const ReferenceField::Place& place) const {
  constexpr double kStep = 1e-6;  // inside of a cell
  Vector3d slope;
  for (size_t axis = 0; axis < 3; ++axis) {
    ReferenceField::Place below = place, above = place;
    below.positions[0][axis] -= kStep;
    above.positions[0][axis] += kStep;
    const double difference =
        field_.ForwardDensity(state.grid, state.networks, above).log_density - field_.ForwardDensity(state.grid, state.networks, below).log_density;
    slope[static_cast<Eigen::Index>(axis)] = difference / (2.0 * kStep) * target_.map.units_per_metre();
  }
  return slope;
}

double PriorReference::LossOf(const ReferenceState& state, const Ray& ray) const {
  double loss = 0.0;
  const std::vector<double> weights = Weights(state, ray);
  double opacity = 0.0, moment = 0.0;
  for (size_t k = 0; k < weights.size(); ++k) {
    opacity += weights[k];
    moment += weights[k] * ray.samples[k].stop_m;
  }
  for (const Pull& pull : ray.pulls) {
    const double off = (ray.At(moment / opacity) - pull.plane.point).dot(pull.plane.normal);
    loss += pull.weight * Robust(off / pull.width_m, priors_.voxel_m / pull.width_m);
  }
  const auto sigma_m = static_cast<double>(ray.ray->ray.point_sigma_m);
  if (priors_.points > 0.0 && sigma_m > 0.0) {
    const double wide_m = std::hypot(sigma_m, 0.5 * target_.step_m);
    for (size_t k = 0; k < weights.size(); ++k) {
      const double off = (ray.samples[k].stop_m - static_cast<double>(ray.ray->ray.point_distance_m)) / wide_m;
      const double share = std::exp(-0.5 * off * off) * target_.step_m / (wide_m * std::sqrt(2.0 * std::numbers::pi));
      loss -= priors_.points * share * std::log(weights[k] + 1e-2);
    }
  }
  if (ray.end) {
    const Vector3d outward = -Slope(state, *ray.end).normalized();
    const double facing = -outward.dot(ray.ray->ray.direction_enu);
    if (priors_.normals > 0.0 && ray.known) loss += priors_.normals * (1.0 - outward.dot(*ray.known));
    loss += priors_.orientation * Square(std::min(0.0, facing));
  }
  return loss;
}

double PriorReference::Loss(const ReferenceState& state) const {
  double loss = 0.0;
  for (const Ray& ray : rays_) loss += LossOf(state, ray);
  return loss / static_cast<double>(std::max<size_t>(1, rays_.size()));
}

}  // namespace skyquilt::bench
