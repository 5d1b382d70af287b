// Fits a similarity transform to matched points of which some are wrong, for instance camera centres of a reconstruction to GPS tags with outliers.
// RANSAC over Eigen::umeyama (Umeyama 1991), then a refit on the inliers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geo/transform.h"

namespace skyquilt::geo {

struct RobustSimilarityOptions {
  double inlier_threshold_m = 10.0;  // > 0; matches with a residual up to this are inliers
  int iterations = 2000;             // at most; fewer when many matches agree
  uint64_t seed = 1;
};

struct RobustSimilarityFit {
  bool ok = false;          // false: fewer than 3 matches, no 3 of them agree, or they do not determine scale and rotation
  const char* reason = "";  // why not ok
  Similarity3d b_from_a;
  std::vector<char> inlier;        // per match
  std::vector<double> residual_m;  // per match, |b - b_from_a * a|
  double rmse_m = 0.0;             // over the inliers, 3-D
  int n_inliers = 0;
};

// Match i is points_in_a[i] with points_in_b[i]; throws std::logic_error for different lengths. Non-finite matches are never inliers.
// The same seed gives the same bits.
RobustSimilarityFit FitSimilarityRobustly(const std::vector<Eigen::Vector3d>& points_in_a, const std::vector<Eigen::Vector3d>& points_in_b,
                                          const RobustSimilarityOptions& options);

}  // namespace skyquilt::geo
