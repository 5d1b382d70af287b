// Scale, direction and horizontal place of a levelled reconstruction from tags, of which many may be wrong, together with the lag of the tags.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

namespace skyquilt::prepare::georeference {

// x_enu = scale * R(angle) * x_level + translation, horizontally; the angle is counter-clockwise.
struct HorizontalSimilarity {
  double scale = 1.0;
  double angle = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& x) const;
};

struct HorizontalFit {
  bool ok = false;  // false: no two tags define a similarity
  HorizontalSimilarity enu_from_level;
  double lag_s = 0.0;
  double cost = 0.0;              // sum of squared residuals, each limited to the threshold
  std::vector<char> inlier = {};  // per tag
  int n_inliers = 0;
};

struct HorizontalFitOptions {
  double threshold_m = 10.0;
  std::vector<double> lags_s = {0.0};  // to try
  int draws = 400;
  uint64_t seed = 1;
};

// `level(k, lag)`: levelled horizontal position of the camera of tag k, `lag` seconds before its photo. Samples of two tags (RANSAC with the cost of
// MSAC), refined on the inliers. Of lags with about the same cost the one nearest to zero wins. The same seed gives the same bits.
HorizontalFit FitHorizontally(const std::vector<Eigen::Vector2d>& tags, const std::function<Eigen::Vector2d(size_t, double)>& level,
                              const HorizontalFitOptions& options);

}  // namespace skyquilt::prepare::georeference
