// What a field is taught beside the photos, and which part of it applies to one step.
#pragma once

#include "core/survey/directions.h"
#include "worker/planes/point_planes.h"
#include "worker/prior_options.h"
#include "worker/rays/ray_batch.h"

namespace skyquilt::worker {

// The priors of one step: their weights and what is known of the surface.
struct StepPriors {
  // Relative to the photo loss; 0: off. See PriorOptions.
  double planar = 0.0, upright = 0.0, planes = 0.0, points = 0.0, free_space = 0.0, normals = 0.0, orientation = 0.0;
  double voxel_m = 0.0;                                          // finest voxel of the field
  const PointPlanes* known_planes = nullptr;                     // may be null
  const survey::DominantDirections* known_directions = nullptr;  // may be null

  bool Segments() const { return planar > 0.0 || upright > 0.0; }
  bool Points() const { return points > 0.0 || free_space > 0.0; }
  bool Normals() const { return normals > 0.0 || orientation > 0.0; }
  // Whether it matters where rays end.
  bool Distances() const { return Segments() || planes > 0.0 || Points() || Normals(); }
};

// Nothing by default. What is null or empty is not taught, whatever its weight.
struct FieldPriors {
  PriorOptions options;
  const PhotoSegments* segments = nullptr;                 // of the field's photos; needed for options.Segments()
  const DepthPoints* points = nullptr;                     // of the field; needed for options.Points()
  const PointPlanes* planes = nullptr;                     // of the field; needed for options.Planes()
  const survey::DominantDirections* directions = nullptr;  // of buildings, for options.upright

  // progress: of the budget, 0..1. voxel_m: finest voxel of the field.
  StepPriors StepAt(double progress, double voxel_m) const;
  // The rays that the losses of such a step need.
  PriorRays RaysFor(const StepPriors& step) const;
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
