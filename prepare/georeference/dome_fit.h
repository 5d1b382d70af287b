// Finds out whether a reconstruction is bent like a dome or a bowl, which pictures alone hardly exclude: a quadratic fit to the differences of camera
// heights between the reconstruction and its GPS tags.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace skyquilt::prepare::georeference {

struct HeightDifference {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // of the camera, ENU
  double up_m = 0.0;                                     // fitted less tagged height
};

struct Dome {
  double height_m = std::numeric_limits<double>::quiet_NaN();  // of the middle above the edge; positive: the reconstruction's middle is too high
  double sigma_m = std::numeric_limits<double>::quiet_NaN();
};

// Fits 1, x, y and r^2 with Huber's weights, so that wrong tags count little. The edge is the distance from the mean position within which 95 % of
// the positions lie. `differences` are in the order of time: sigma is larger when neighbours' residuals agree, since GPS heights drift. NaN for fewer
// than kMinDomeTags (values that are not finite do not count), positions that do not cover an area (one line, one place) and positions on one circle.
Dome FitDome(const std::vector<HeightDifference>& differences);

constexpr int kMinDomeTags = 10;

}  // namespace skyquilt::prepare::georeference
