// Places a reconstruction on Earth by ground control points, and measures how well it agrees with them and with check points. A similarity that
// tolerates wrong points comes first; then everything, photos, lenses, points of the model and control points, is adjusted at once to the photos'
// features, the marks and the surveyed coordinates (Kraus, Photogrammetry, 2007, chapter 5), and wrong points and marks are found again by what the
// others say of them. The accuracies are those of the adjustment.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/geodetic.h"
#include "core/geo/place_accuracy.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "core/survey/control_fit.h"
#include "core/survey/geo_fit.h"
#include "prepare/control/reading/control_points.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::control {

// Points of the model with observations in two photos or more; with fewer there is no adjustment.
constexpr size_t kLeastTies = 50;

// Where the survey is without control points, by GPS tags or by its model.
struct PlaceWithoutControl {
  geo::Geodetic origin;
  geo::Similarity3d enu_from_model;
  geo::PlaceAccuracy accuracy;
  bool exact = false;  // the model's own frame is kept, and control points are only compared
};

struct ControlJob {
  survey::ColmapModel& model;  // in any frame; see FitControl
  // Of the model's points; empty when the model has none: then there is no adjustment.
  const survey::ColmapObservations& observations;
  const std::vector<input::PreparedPhoto>& photos;  // that marks may be on
  const ControlPoints& control;
  std::optional<PlaceWithoutControl> otherwise = {};
  double mark_sigma_px = 0.5;  // > 0, per axis, pixels of the stored photo; corrected by what the marks show
  // How GPS tags vary about a shift that they may have in common counts, as much as it agrees with the photos; it can bend the survey a little where
  // there is no control.
  bool use_tags = true;
};

struct PlacedByControl {
  geo::Geodetic origin;
  survey::ControlFit fit;                 // of origin's frame
  geo::PlaceAccuracy accuracy;            // of the place without control when fit.placed is false
  std::vector<survey::Problem> problems;  // the worst first
  double scale = 1.0;                     // metres per unit that the model had
};

// When fit.placed, the model's poses, cameras and points have been changed: they are in ENU metres about `origin`, the middle of the control points.
// Else too few control points can be used, the model is as it was, and points are compared with the place without control. Throws base::InputError
// that names the control file when there is no other place, std::logic_error for photos without image, base::Interrupted. The same input gives the
// same bits, whatever the number of threads.
PlacedByControl FitControl(const ControlJob& job, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::control
