// Footprints of samples. A pixel sees a cone: the sample at distance t stands for a piece of space as wide as the pixel there, and features of the hash
// grid that are finer than this width fade (kernel::FootprintWeight). The footprint is taken as a normal distribution with the variance of a square of
// that width, one position per sample: weight erf(sqrt(3/2) voxel / width) (Barron et al. 2023, Zip-NeRF, section 3, with one sample).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/render/ray.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// kernel::Positions::sharpness of a footprint, in 1 / unit length: sqrt(12) / sqrt(8) / width. Infinite for width 0.
inline float SharpnessOf(double width_m, double units_per_metre) {
  return static_cast<float>(std::sqrt(1.5) / (width_m * units_per_metre));
}

// The same for a sample of a ray in a field with cones. Widths outside the range with which the field was trained count as at its ends: its networks
// have never seen others.
inline float SharpnessAt(const TrainedField& f, const Ray& ray, double t) {
  const double width_m = std::clamp(ray.Footprint(t), f.footprint_min_m, f.footprint_max_m);
  return SharpnessOf(width_m, f.map.VolumeScale(ray.origin_enu + t * ray.direction_enu));
}

}  // namespace skyquilt::render
