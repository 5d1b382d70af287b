// Which photos see which box, and with how many of their pixels.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::partition {

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

struct BlockViews {
  std::vector<int> photos;  // indices into Survey::photos, ascending; training and test
  int n_training = 0;
  double training_pixels = 0.0;  // whose ray meets the box, at the training size
};

// Shares are taken from 16 x 12 rays per photo, image borders included (trapezoid rule). A box that slips between those rays is found by
// projecting it; its share is then that of the rectangle around its corners. Result in the order of `boxes`.
std::vector<BlockViews> FindViews(const survey::Survey& survey, const std::vector<Box>& boxes, int image_width);

}  // namespace skyquilt::partition
