// Takes a simulated COLMAP model out of its exact frame into one as structure from motion makes it, which has nothing to do with the place.
#pragma once

#include <cstdint>

#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::simulate {

// model_from_enu with a random rotation, a scale of 0.02 to 50 model units per metre and a shift of up to 10 model units. The same seed gives the
// same.
geo::Similarity3d RandomModelFrame(uint32_t seed);

// Moves poses and points from ENU metres to the model's frame. Their reprojections stay the same.
void MoveModel(const geo::Similarity3d& model_from_enu, survey::ColmapModel& model);

// a_from_b from b_from_a.
geo::Similarity3d Inverse(const geo::Similarity3d& b_from_a);

}  // namespace skyquilt::simulate
