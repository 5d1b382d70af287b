// Robust fit of a similarity between matched points: RANSAC over Eigen::umeyama (Umeyama 1991), then a refit on the inliers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geo/transform.h"

namespace skyquilt::geo {

struct RobustSimilarityOptions {
  double inlier_threshold_m = 10.0;  // > 0; residual below which a match counts
  int iterations = 2000;
  uint64_t seed = 1;
};

struct RobustSimilarityFit {
  bool ok = false;  // false: fewer than 3 matches, or all on one line or point
  const char* reason = "";
  Similarity3d b_from_a;
  std::vector<char> inlier;        // per match
  std::vector<double> residual_m;  // per match, |b - b_from_a * a|
  double rmse_m = 0.0;             // over the inliers, 3-D
  int n_inliers = 0;
};

// points_in_a and points_in_b have the same length (throws std::logic_error otherwise). Non-finite matches are never inliers.
RobustSimilarityFit FitSimilarityRobustly(const std::vector<Eigen::Vector3d>& points_in_a, const std::vector<Eigen::Vector3d>& points_in_b,
                                          const RobustSimilarityOptions& options);

}  // namespace skyquilt::geo
