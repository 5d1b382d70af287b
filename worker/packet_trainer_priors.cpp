// Losses of the distances at which rays end: rays of one segment of a photo end on a plane, and on a level or vertical one when it nearly is; rays
// towards a sparse point end there.
#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/losses/point_depth_loss.h"
#include "worker/losses/robust_loss.h"
#include "worker/packet_trainer.h"
#include "worker/plane_fit.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

RayEnd EndOf(size_t n, const float* weights, const float* t, double voxel_m) {
  constexpr double kFront = 0.15, kBack = 0.85;
  RayEnd end;
  double moment = 0.0, front = 0.0, back = 0.0;
  for (size_t k = 0; k < n; ++k) {
    const double before = end.weight, at = static_cast<double>(t[k]);
    end.weight += static_cast<double>(weights[k]);
    moment += static_cast<double>(weights[k]) * at;
    if (before < kFront) front = at;
    if (before < kBack) back = at;
  }
  if (!(end.weight > kOpaqueWeight)) return end;
  end.mean_m = moment / end.weight;
  end.sharp = back - front < kSharpVoxels * voxel_m;
  return end;
}

}  // namespace

void PacketTrainer::AddSegmentLosses(LossSums& sums) {
  distance_gradient_.clear();
  if (!step_->priors.Segments()) return;
  distance_gradient_.assign(views_.size(), 0.0F);
  ends_.assign(views_.size(), {});
  for (size_t first = 0; first < views_.size();) {
    size_t end = first + 1;
    while (Ray(first).segment >= 0 && end < views_.size() && Ray(end).segment == Ray(first).segment) ++end;
    if (end - first >= kFewestPlanePoints) AddSegmentLoss(first, end, sums);
    first = end;
  }
}

void PacketTrainer::AddSegmentLoss(size_t first, size_t end, LossSums& sums) {
  const PriorWeights& priors = step_->priors;
  std::vector<size_t> used;
  std::vector<Vector3d> points;
  for (size_t k = first; k < end; ++k) {
    const RayView& view = views_[k];
    ends_[k] =
        EndOf(static_cast<size_t>(view.count), weight_.data() + view.begin, step_->batch.t.data() + packet_->begin + view.begin, priors.voxel_m);
    if (!ends_[k].sharp) continue;
    used.push_back(k);
    points.emplace_back(Ray(k).ray.origin_enu + ends_[k].mean_m * Ray(k).ray.direction_enu);
  }
  const std::optional<Plane> plane = FitPlane(points);
  if (!plane) return;
  const std::optional<Plane> upright = priors.upright > 0.0 ? UprightPlane(*plane) : std::nullopt;
  for (size_t i = 0; i < used.size(); ++i) {
    const PixelRay& ray = Ray(used[i]).ray;
    const double gsd_m = static_cast<double>(ray.pixel_pitch) * ends_[used[i]].mean_m;
    const auto add = [&](double weight, const Plane& target) {
      const double off = (points[i] - target.point).dot(target.normal);
      const Loss<double> loss = RobustLoss(weight, off / gsd_m, priors.voxel_m / gsd_m);
      sums.loss += loss.value;
      distance_gradient_[used[i]] += static_cast<float>(loss.gradient * target.normal.dot(ray.direction_enu) / gsd_m) * step_->ray_share;
    };
    if (priors.planar > 0.0) add(priors.planar, *plane);
    if (upright) add(priors.upright, *upright);
  }
}

// The mean distance is sum w t / sum w.
void PacketTrainer::AddDistanceGradient(size_t view) {
  const RayEnd& end = ends_[view];
  const float* t = step_->batch.t.data() + packet_->begin + views_[view].begin;
  const auto per_weight = static_cast<float>(static_cast<double>(distance_gradient_[view]) / end.weight);
  for (size_t k = 0; k < static_cast<size_t>(views_[view].count); ++k) weight_gradient_[k] += per_weight * (t[k] - static_cast<float>(end.mean_m));
}

bool PacketTrainer::WantsPointLoss(const BatchRay& ray, const RayView& view) const {
  return step_->priors.points > 0.0 && ray.ray.point_sigma_m > 0.0F && view.count > 0;
}

// Samples are farther apart than many points are uncertain: the wider of both decides which samples are near the point.
void PacketTrainer::AddPointLoss(const BatchRay& ray, const RayView& view, LossSums& sums) {
  const auto step_m = static_cast<float>(shared_.target.step_m);
  const float sigma_m = std::hypot(ray.ray.point_sigma_m, 0.5F * step_m);
  const float weight = static_cast<float>(step_->priors.points) * step_->ray_share;
  const float loss =
      AddPointDepthLoss(weight, static_cast<size_t>(view.count), weight_.data() + view.begin, step_->batch.t.data() + packet_->begin + view.begin,
                        step_m, ray.ray.point_distance_m, sigma_m, weight_gradient_.data());
  sums.loss += static_cast<double>(loss) / static_cast<double>(step_->ray_share);
}

}  // namespace skyquilt::worker
