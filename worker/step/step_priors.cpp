#include "worker/step/step_priors.h"

namespace skyquilt::worker {

StepPriors FieldPriors::StepAt(double progress, double voxel_m) const {
  const double strength = options.Strength(progress);
  const double of_segments = segments != nullptr ? strength : 0.0;
  const double of_planes = planes != nullptr && !planes->Empty() ? strength : 0.0;
  const double of_points = points != nullptr && !points->Empty() ? options.PointStrength(progress) : 0.0;
  return {.planar = of_segments * options.planar,
          .upright = of_segments * options.upright,
          .planes = of_planes * options.planes,
          .points = of_points * options.points,
          .free_space = of_points * options.free_space,
          .normals = of_segments * options.normals,
          .orientation = of_segments * options.orientation,
          .voxel_m = voxel_m,
          .known_planes = planes,
          .known_directions = directions};
}

PriorRays FieldPriors::RaysFor(const StepPriors& step) const {
  return {step.Segments() || step.Normals() ? segments : nullptr, options.segment_share, step.Points() ? points : nullptr, options.point_share};
}

}  // namespace skyquilt::worker
