// A COLMAP model with marks of control points as a problem for the bundle adjustment.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "prepare/bundle/bundle_problem.h"
#include "prepare/control/fit/fit_control.h"

namespace skyquilt::prepare::control {

struct ControlBundle {
  // Photos in the order of the model's images, lenses in that of its cameras. Tracks: those of the model's points, then one for each control point.
  bundle::BundleProblem bundle;
  size_t n_ties = 0;                                       // tracks of the model's points
  std::vector<size_t> point_of_tie;                        // per tie track, index into the model's points
  std::vector<std::vector<std::optional<uint32_t>>> mark;  // per control point and mark: its entry; nothing when its photo has no pose
  bool known_lenses = true;                                // false: some lens is one that the adjustment does not know
  double tie_sigma = 1.0;                                  // of features, per axis, in pixels of a photo of 1600 pixels width
  double mark_sigma_px = 0.5;

  uint32_t TrackOfPoint(size_t control_point) const { return static_cast<uint32_t>(n_ties + control_point); }
  // Sets the lenses' units, so that errors of features are counted in their sigmas, and the marks' accuracy.
  void SetAccuracy(double new_tie_sigma, double new_mark_sigma_px);
  // The largest error in `times` sigmas of a mark in a photo of the widest lens, in units of lenses; poses are as accurate as features.
  double MarkThreshold(double times) const;
  void Move(const geo::Similarity3d& b_from_a);
};

// The points of the model agree with all of their observations, control points have no place yet. Marks and features of photos with a lens that the
// adjustment does not know are moved to where a lens without distortion would show them.
ControlBundle MakeControlBundle(const ControlJob& job);

}  // namespace skyquilt::prepare::control
