// Judges found poses by the true ones.
#pragma once

#include <limits>
#include <string>

#include "bench/poses/photo_sets.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::bench {

// A pose is right when it differs from the true one by less than this, after the model was moved, turned and scaled to the true positions.
constexpr double kRightPosition = 0.02;  // of the height above ground
constexpr double kRightRotation_deg = 2.0;

struct PoseScore {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  size_t n_photos = 0;                              // of the set, without intruders
  size_t registered = 0;                            // of these, with a pose
  size_t right = 0;                                 // of these, with a right one
  size_t intruders = 0;                             // of another place, with a pose
  double position_m = kNone, rotation_deg = kNone;  // medians of the registered photos' errors
  // Largest relative error of the focal lengths of registered photos; a model may have right poses and a wrong shape.
  double focal_error = kNone;
  std::string problem;  // why nothing is right; empty: the model could be compared
};

// Photos are found by name. The model may be in any frame.
PoseScore JudgePoses(const TrueSet& truth, const survey::ColmapModel& model);

}  // namespace skyquilt::bench
