// How well the photos of a survey determine the lens: the standard deviations of the first radial distortion coefficient and of the focal length,
// which COLMAP does not write. They are those of a bundle adjustment (AdjustmentAccuracy) by the model's observations alone: all have the same
// weight, nothing is known beforehand of poses and lens, and the seven degrees of freedom of the frame are held.
#pragma once

#include <cstdint>
#include <limits>

#include "core/survey/colmap_model.h"

namespace skyquilt::prepare::bundle {

struct LensAccuracy {
  double k1_sigma = std::numeric_limits<double>::quiet_NaN();  // at most 1000: the photos do not determine k1
  // Relative to the focal length, likewise. By these photos alone: their tags, and an adjustment that held the focal length, do not count.
  double focal_sigma = std::numeric_limits<double>::quiet_NaN();
  double sigma0_px = 0.0;  // standard deviation of one pixel coordinate, from the residuals
  int n_photos = 0;        // that the normal equations were made of
  int n_points = 0;
  int n_observations = 0;
};

// Limits on the cost. More photos: this many consecutive ones (in name order) from the middle. More points: evenly chosen ones, and the information
// of those left out is taken as the same on average.
constexpr int kMaxLensPhotos = 150;
constexpr int kMaxLensPoints = 20000;

// For the camera `camera_id` of the model, from its photos and the points that at least three of them see. All its parameters are unknowns, but not
// the principal point when it is exactly the middle of the image, where COLMAP leaves it by default. Both are NaN when nothing can be said: a
// camera model without k1 or with all distortion 0 (not adjusted), fewer than three photos, too few observations, or observations that are the
// points' own projections (a simulated survey). Observations of unknown points are ignored. Throws nothing for numbers of any size.
LensAccuracy MeasureLensAccuracy(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id);

// Index of the first radial coefficient among a camera's parameters; -1 when the model has none.
int RadialParameterIndex(camera::CameraModel model);

}  // namespace skyquilt::prepare::bundle
