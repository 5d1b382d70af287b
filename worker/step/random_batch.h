// A batch of rays to measure the speed of training with, where there is no survey.
#pragma once

#include <cstdint>

#include "worker/rays/ray_batch.h"

namespace skyquilt::worker {

// Rays with random colours and directions, whose samples are in the unit cube: at random positions, or, with a step, one after another along the ray
// from a random place, as in training. Laid out for a field with so many rows of features. At least one ray.
RayBatch RandomBatch(int64_t samples, int samples_per_ray, int feature_rows, uint64_t seed, double step = 0.0);

}  // namespace skyquilt::worker
