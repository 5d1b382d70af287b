// The similarity that places a model by control points, some of which may be wrong.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/geo/transform.h"

namespace skyquilt::prepare::control {

struct ControlPair {
  Eigen::Vector3d in_model = Eigen::Vector3d::Zero();  // from its marks
  Eigen::Vector3d in_enu = Eigen::Vector3d::Zero();    // surveyed, metres; finite
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Ones();   // of in_enu; infinite z: no height
  double gsd = 0.0;                                    // units of the model per pixel at the point
};

enum class SimilarityFailure { kNone, kTooFew, kOnLine };

struct ControlSimilarity {
  SimilarityFailure failure = SimilarityFailure::kNone;
  geo::Similarity3d enu_from_model;
  std::vector<char> agrees;  // per pair
  // Of translation, rotation (rad, about east, north, up) and log scale about `middle`; scaled by how well the pairs agree where that is worse than
  // their sigmas.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // ENU

  // Of where a point (ENU) gets.
  Eigen::Matrix3d CovarianceAt(const Eigen::Vector3d& x_in_enu) const;
};

// Needs three pairs with heights that are not on one line; the others help. All triples (a sample of them when there are many) are tried; the
// similarity with which most pairs agree is kept, within what marks, coordinates and a moderate bend of the model explain, and fitted by least
// squares to all of them. When fewer than most agree, the model is bent more, and the similarity whose errors are least for most of the pairs counts
// (Rousseeuw, Least Median of Squares Regression, 1984).
ControlSimilarity FitControlSimilarity(const std::vector<ControlPair>& pairs);

}  // namespace skyquilt::prepare::control
