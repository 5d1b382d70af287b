// Weights of the priors in one step, and the measure of where a ray ends that they need.
#pragma once

namespace skyquilt::worker {

// Relative to the photo loss; 0: off.
struct PriorWeights {
  double planar = 0.0, upright = 0.0, points = 0.0;
  double voxel_m = 0.0;  // finest voxel of the field

  bool Segments() const { return planar > 0.0 || upright > 0.0; }
};

// Where a ray ends, by its compositing weights.
struct RayEnd {
  double weight = 0.0;  // sum of the weights, 0..1
  double mean_m = 0.0;  // mean distance, metres along the ray
  bool sharp = false;   // opaque, and its light is stopped within kSharpVoxels: a surface, not leaves
};
constexpr double kOpaqueWeight = 0.9, kSharpVoxels = 3.0;

}  // namespace skyquilt::worker
