// Errors of a simulated model's poses, as structure from motion leaves them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/survey/colmap_model.h"
#include "simulate/flight.h"

namespace skyquilt::simulate {

// Turns and shifts the poses of the model, which is in ENU metres and has the photos in their order, by normally distributed errors with this root
// mean square (of the whole angle, and of the whole distance). Photos with true depth keep their pose, so that scores on them measure the scene and
// not their own pose. The similarity that the errors have in common is taken off, so the survey stays in its place. Points stay as they are. The same
// seed gives the same errors.
void AddPoseNoise(double rms_deg, double rms_m, uint32_t seed, const std::vector<PhotoPlan>& photos, survey::ColmapModel& model);

}  // namespace skyquilt::simulate
