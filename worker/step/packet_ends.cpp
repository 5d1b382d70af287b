#include "worker/step/packet_ends.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/render/composite.h"
#include "worker/losses/loss.h"
#include "worker/losses/point_depth_loss.h"
#include "worker/planes/plane_fit.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

// A ray that grazes a plane says little about where it meets it.
constexpr double kLeastFacing = 0.2;
// Rays that end farther from a plane of sparse points, in voxels, belong to something else. With twice as much, the feet of walls and low things are
// drawn to the ground.
constexpr double kPlaneReachVoxels = 1.5;
// Pixels are nowhere taken to be narrower than this: next to the camera they are, and the loss would have no bound.
constexpr double kLeastWidthVoxels = 0.1;
// So far before a sparse point, in its uncertainty along the ray, nothing stops its light.
constexpr float kFreeSigmas = 3.0F;

RayEnd EndOf(size_t n, const float* weights, const float* stops, double voxel_m) {
  constexpr double kFront = 0.15, kBack = 0.85;
  RayEnd end;
  double moment = 0.0, front = 0.0, back = 0.0;
  for (size_t k = 0; k < n; ++k) {
    const double before = end.weight, at = static_cast<double>(stops[k]);
    end.weight += static_cast<double>(weights[k]);
    moment += static_cast<double>(weights[k]) * at;
    if (before < kFront) front = at;
    if (before < kBack) back = at;
  }
  if (!(end.weight > kOpaqueWeight)) return end;
  end.opaque = true;
  end.mean_m = moment / end.weight;
  end.depth_m = back - front;
  end.sharp = end.depth_m < kSharpVoxels * voxel_m;
  return end;
}

}  // namespace

void PacketEnds::Find(const PacketSamples& s, LossSums& sums) {
  const StepPriors& priors = s.step->priors;
  // A sample stands in the middle of its interval, but a dense one stops the light near the front. Without the difference, surfaces would come to lie
  // too near to the camera, by up to half a step.
  const auto n = static_cast<size_t>(s.live);
  Grow(stops_, n);
  const float* t = s.Distances();
  const auto step_m = static_cast<float>(shared_.target.step_m);
  const RayBatch& batch = s.step->batch;
  for (size_t k = 0; k < s.views.size(); ++k) {
    const auto begin = static_cast<size_t>(s.views[k].begin), in_batch = static_cast<size_t>(s.Ray(k).begin);
    for (size_t j = 0; j < static_cast<size_t>(s.views[k].count); ++j) {
      const float length_m = batch.uneven ? step_m * batch.unit_length[in_batch + j] : step_m;
      stops_[begin + j] = t[begin + j] + length_m * (render::MeanStop(s.tau[begin + j]) - 0.5F);
    }
  }
  distance_gradient_.assign(s.views.size(), 0.0F);
  ends_.assign(s.views.size(), {});
  const bool everywhere = priors.planes > 0.0 && priors.known_planes != nullptr;
  for (size_t k = 0; k < s.views.size(); ++k) {
    const BatchRay& r = s.Ray(k);
    // A pixel of a reduced photo may show several surfaces.
    if (r.ray.empty || r.ray.level != 0 || !(everywhere || r.segment >= 0)) continue;
    const RayView& view = s.views[k];
    ends_[k] = EndOf(static_cast<size_t>(view.count), s.weight.data() + view.begin, stops_.data() + view.begin, priors.voxel_m);
    if (everywhere && ends_[k].opaque) AddKnownPlaneLoss(s, k, sums);
  }
  if (!priors.Segments()) return;
  for (size_t first = 0; first < s.views.size();) {
    size_t end = first + 1;
    while (s.Ray(first).segment >= 0 && end < s.views.size() && s.Ray(end).segment == s.Ray(first).segment) ++end;
    if (end - first >= kFewestPlanePoints) AddSegmentLoss(s, first, end, sums);
    first = end;
  }
}

// The robust square of the distance between a ray's end and a plane, in widths of its pixel; one voxel is far. No loss where the ray grazes the
// plane.
void PacketEnds::AddDistanceLoss(const PacketSamples& s, size_t view, double weight, const Vector3d& on_plane, const Vector3d& normal,
                                 LossSums& sums) {
  const PixelRay& ray = s.Ray(view).ray;
  const double along = normal.dot(ray.direction_enu), voxel_m = s.step->priors.voxel_m;
  if (std::abs(along) < kLeastFacing) return;
  const double width_m = std::max(static_cast<double>(ray.pixel_pitch) * ends_[view].mean_m, kLeastWidthVoxels * voxel_m);
  const double off = (ray.origin_enu + ends_[view].mean_m * ray.direction_enu - on_plane).dot(normal);
  const Loss<double> loss = RobustLoss(weight, off / width_m, voxel_m / width_m);
  sums.loss += loss.value;
  distance_gradient_[view] += static_cast<float>(loss.gradient * along / width_m) * s.step->ray_share;
}

void PacketEnds::AddKnownPlaneLoss(const PacketSamples& s, size_t view, LossSums& sums) {
  const StepPriors& priors = s.step->priors;
  const PixelRay& ray = s.Ray(view).ray;
  const PointPlane* const plane =
      priors.known_planes->At(ray.origin_enu + ends_[view].mean_m * ray.direction_enu, kPlaneReachVoxels * priors.voxel_m);
  if (plane == nullptr) return;
  // Light that grazes a wall is stopped over a long way, but near the wall.
  const double facing = std::abs(plane->normal.dot(ray.direction_enu));
  if (facing * ends_[view].depth_m > kSharpVoxels * priors.voxel_m) return;
  AddDistanceLoss(s, view, priors.planes, plane->point, plane->normal, sums);
}

void PacketEnds::AddSegmentLoss(const PacketSamples& s, size_t first, size_t end, LossSums& sums) {
  const StepPriors& priors = s.step->priors;
  std::vector<size_t> used;
  std::vector<Vector3d> points;
  for (size_t k = first; k < end; ++k) {
    if (!ends_[k].sharp) continue;
    used.push_back(k);
    points.emplace_back(s.Ray(k).ray.origin_enu + ends_[k].mean_m * s.Ray(k).ray.direction_enu);
  }
  const std::optional<Plane> plane = FitPlane(points);
  if (!plane) return;
  std::optional<Plane> upright;
  if (priors.upright > 0.0) {
    const auto yaw_deg = priors.known_directions != nullptr ? priors.known_directions->YawAt(plane->point.head<2>()) : std::nullopt;
    upright = UprightPlane(*plane, yaw_deg);
  }
  for (const size_t k : used) {
    if (priors.planar > 0.0) AddDistanceLoss(s, k, priors.planar, plane->point, plane->normal, sums);
    if (upright) AddDistanceLoss(s, k, priors.upright, upright->point, upright->normal, sums);
  }
}

void PacketEnds::AddGradient(const PacketSamples& s, size_t view, float* weight_gradient, LossSums& sums) const {
  const RayView& samples = s.views[view];
  const float* stops = stops_.data() + samples.begin;
  const auto count = static_cast<size_t>(samples.count);
  if (AtPoint(s, view)) {
    const PixelRay& ray = s.Ray(view).ray;
    // Samples are farther apart than many points are uncertain: the wider of both decides which samples are near the point.
    const auto step_m = static_cast<float>(shared_.target.step_m);
    const float sigma_m = std::hypot(ray.point_sigma_m, 0.5F * step_m);
    const float* weights = s.weight.data() + samples.begin;
    const float to_points = static_cast<float>(s.step->priors.points) * s.step->ray_share;
    const float before_points = static_cast<float>(s.step->priors.free_space) * s.step->ray_share;
    const float loss = AddPointDepthLoss(to_points, count, weights, stops, step_m, ray.point_distance_m, sigma_m, weight_gradient) +
                       AddFreeSpaceLoss(before_points, count, weights, stops, ray.point_distance_m - kFreeSigmas * sigma_m, weight_gradient);
    sums.loss += static_cast<double>(loss) / static_cast<double>(s.step->ray_share);
  }
  if (distance_gradient_[view] == 0.0F) return;
  // The mean distance is sum w s / sum w over the stops s, which are taken as given.
  const RayEnd& end = ends_[view];
  const auto per_weight = static_cast<float>(static_cast<double>(distance_gradient_[view]) / end.weight);
  for (size_t k = 0; k < count; ++k) weight_gradient[k] += per_weight * (stops[k] - static_cast<float>(end.mean_m));
}

}  // namespace skyquilt::worker
