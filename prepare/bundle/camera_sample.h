// The part of a COLMAP model that the accuracy of a camera is computed from: photos of that camera and the points that they see.
#pragma once

#include <cstdint>

#include "core/survey/colmap_model.h"
#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

struct CameraSample {
  // In the model's frame and units. Photos are in name order; those that are placed and points that at least three of them see make the sample.
  BundleProblem bundle;
  double share_of_points = 1.0;  // of those that could have been taken
};

// The largest part that is connected by points. `max_photos` consecutive photos (in name order) are taken from the middle of all of the camera, and
// `max_points` evenly chosen points. Photos with fewer than kMinSightings are left out. Empty when nothing remains. The principal point is free
// unless it is exactly the middle of the image. The model must have the camera.
CameraSample SelectSample(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id, size_t max_photos,
                          size_t max_points);

constexpr int kMinSightings = 12;

}  // namespace skyquilt::prepare::bundle
