// The priors of one step: their weights and what is known of the surface.
#pragma once

#include "core/survey/directions.h"
#include "worker/planes/point_planes.h"

namespace skyquilt::worker {

struct StepPriors {
  // Relative to the photo loss; 0: off. See PriorOptions.
  double planar = 0.0, upright = 0.0, planes = 0.0, points = 0.0, normals = 0.0, orientation = 0.0;
  double voxel_m = 0.0;                                          // finest voxel of the field
  const PointPlanes* known_planes = nullptr;                     // may be null
  const survey::DominantDirections* known_directions = nullptr;  // may be null

  bool Segments() const { return planar > 0.0 || upright > 0.0; }
  bool Normals() const { return normals > 0.0 || orientation > 0.0; }
  // Whether it matters where rays end.
  bool Ends() const { return Segments() || planes > 0.0 || Normals(); }
  bool Distances() const { return Ends() || points > 0.0; }
};

// Where a ray ends, by its compositing weights.
struct RayEnd {
  double weight = 0.0;   // sum of the weights, 0..1
  double mean_m = 0.0;   // mean distance, metres along the ray
  bool opaque = false;   // weight is above kOpaqueWeight; the other values are only set then
  bool sharp = false;    // its light is stopped within kSharpVoxels along the ray: a surface, not leaves
  double depth_m = 0.0;  // metres along the ray within which 70 % of the light is stopped
};
constexpr double kOpaqueWeight = 0.9, kSharpVoxels = 3.0;

}  // namespace skyquilt::worker
