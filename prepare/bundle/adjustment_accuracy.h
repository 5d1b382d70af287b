// How accurate the result of a bundle adjustment is, from its normal equations (Triggs et al., Bundle Adjustment - A Modern Synthesis, 2000, section
// 6): the points are eliminated, what remains of photos, lenses and the tags' common shift is factored (sparse Cholesky), and only the parts of the
// inverse that are asked for are computed. Terms count with the weight that their loss leaves them. ceres::Covariance gives blocks of the inverse
// only, of unknowns of the adjustment: check points have no part in it, and the survey as a whole would need the blocks of every pair of photos.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/geo/place_accuracy.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

class AdjustmentAccuracy {
 public:
  // After AdjustBundle with the same arguments, or of a bundle that others adjusted so. Errors of features are taken to have the standard deviation
  // of one unit, those of marks their sigma. Keeps a reference to the bundle.
  AdjustmentAccuracy(const BundleProblem& bundle, std::span<const uint32_t> tracks, const BundleStage& stage, const Eigen::Vector3d* shift);
  ~AdjustmentAccuracy();

  // False when the normal equations do not determine the photos: nothing is known then.
  bool ok() const;
  // Covariance of a point, square metres, from its agreeing entries, `known` (its measured place, when that was a part of the adjustment) and the
  // covariance of photos and lenses. Nothing when fewer than two of its entries count.
  std::optional<Eigen::Matrix3d> OfPoint(uint32_t track, const KnownPoint* known) const;
  // Variance of a number of a lens. Nothing for one that is held or of no photo.
  std::optional<double> OfLens(size_t lens, int number) const;
  // Of the survey as a whole: of the similarity that fits the points of the adjustment, about their middle.
  geo::PlaceAccuracy OfPlace() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// What BundleStage::known_loss leaves of the weight of a measured place when the point is at `x_in_enu`, 0 to 1.
double KnownWeight(const KnownPoint& known, const Eigen::Vector3d& x_in_enu, double loss);

// Derivatives of where a point gets by translation, rotation and log scale about a middle; `from_middle` is its place from there.
Eigen::Matrix<double, 3, 7> SimilarityJacobian(const Eigen::Vector3d& from_middle);

}  // namespace skyquilt::prepare::bundle
