// The last step of the geo-reference: similarity, lag of the tags and errors of their heights in one least-squares adjustment of positions and
// gravity, with tags that disagree losing their weight, and the covariance of the result.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/geo/transform.h"
#include "prepare/georeference/gravity.h"
#include "prepare/georeference/height_bias.h"
#include "prepare/georeference/tags/tags.h"
#include "prepare/georeference/tags/track.h"

namespace skyquilt::prepare::georeference {

struct AdjustmentInput {
  const Track& track;
  const Gravity& gravity;
  const std::vector<Tag>& tags;  // in the order of the track
  const HeightBias& bias;        // of these tags
  BiasSigmas bias_sigmas;
  Eigen::Vector3d middle_in_model;  // the accuracy of the position is that of this point
  double threshold_m = 10.0;        // tags farther off lose all weight
  double lag_sigma_s = 0.0;         // prior of the lag; 0: no lag
};

struct Adjustment {
  geo::Similarity3d enu_from_model;
  double lag_s = 0.0;
  std::vector<double> bias_m;                           // per tag, error of its height
  std::vector<char> inlier;                             // per tag: within the threshold, also in height where it has one
  double horizontal_noise = 1.0, vertical_noise = 1.0;  // standard deviation of the tags over their stated accuracy
  // Covariance of rotation (rad, about east, north, up), log scale, position of the middle (metres) and lag (seconds).
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Identity();
  // What the tags alone say of the rotation about east and north, relative to the result, and its covariance; NaN where they say nothing.
  Eigen::Vector2d tags_rotation = Eigen::Vector2d::Zero();
  Eigen::Matrix2d tags_covariance = Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix2d tags_information = Eigen::Matrix2d::Zero();
};

// Where to begin: close enough that most good tags are within the threshold.
struct AdjustmentStart {
  geo::Similarity3d enu_from_model;
  double lag_s = 0.0;    // see FitHorizontally
  Eigen::VectorXd bias;  // parameters, see ChooseBias
};
// Gauss-Newton. At least two tags.
Adjustment Adjust(const AdjustmentInput& input, const AdjustmentStart& start);

}  // namespace skyquilt::prepare::georeference
