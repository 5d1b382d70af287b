// Losses of the distances at which a packet's rays end: rays of one segment of a photo end on a plane, and on a level or vertical one when it nearly
// is; rays that end near a plane of sparse points end on it; rays towards a sparse point end there. Only in steps with such priors.
#pragma once

#include <span>
#include <vector>

#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

class PacketEnds {
 public:
  explicit PacketEnds(const PacketShared& shared) : shared_(shared) {}

  // After all rays are composed: finds their ends and adds the losses of groups of rays and of known planes.
  void Find(const PacketSamples& s, LossSums& sums);
  // Per view; not opaque where no prior asks for it.
  std::span<const RayEnd> ends() const { return ends_; }

  bool HasGradient(const PacketSamples& s, size_t view) const { return AtPoint(s, view) || distance_gradient_[view] != 0.0F; }
  // Adds the gradients by the weights of the ray's samples to weight_gradient, and the loss of a ray towards a sparse point to sums.
  void AddGradient(const PacketSamples& s, size_t view, float* weight_gradient, LossSums& sums) const;

 private:
  static bool AtPoint(const PacketSamples& s, size_t view) {
    return s.step->priors.Points() && s.Ray(view).ray.point_sigma_m > 0.0F && s.views[view].count > 0;
  }
  void AddKnownPlaneLoss(const PacketSamples& s, size_t view, LossSums& sums);
  void AddSegmentLoss(const PacketSamples& s, size_t first, size_t end, LossSums& sums);
  void AddDistanceLoss(const PacketSamples& s, size_t view, double weight, const Eigen::Vector3d& on_plane, const Eigen::Vector3d& normal,
                       LossSums& sums);

  const PacketShared& shared_;
  std::vector<float> stops_;              // per sample: metres from the camera at which its light is stopped on average
  std::vector<RayEnd> ends_;              // per view
  std::vector<float> distance_gradient_;  // per view: of the batch's mean loss by the mean distance
};

}  // namespace skyquilt::worker
