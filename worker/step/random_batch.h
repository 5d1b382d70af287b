// A batch of rays to measure the speed of training with, where there is no survey.
#pragma once

#include <cstdint>

#include "worker/rays/ray_batch.h"

namespace skyquilt::worker {

// Rays whose samples are at random positions in the unit cube, with random colours and directions; laid out for a field with so many rows of
// features. At least one ray.
RayBatch RandomBatch(int64_t samples, int samples_per_ray, int feature_rows, uint64_t seed);

}  // namespace skyquilt::worker
