// Finds which training photos see which box, and with how many pixels: the photos a block is trained on and the amount of work.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::partition {

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

struct BoxVisibility {
  std::vector<int> photos;       // indices into Survey::photos, ascending; held-out ones are not among them
  double training_pixels = 0.0;  // pixels of these photos whose ray hits the box, at the training size
};

// Pixels of all training photos at the training width (0 = full size).
double TrainingPixels(const survey::Survey& survey, int image_width);

// Pixels are estimated with 16 x 12 rays per photo, image borders included (trapezoid rule). A box that none of these rays hits is projected
// instead and counts with the rectangle around its corners. image_width: training width in pixels, 0 = full size. Result in the order of `boxes`.
// Of more than few_boxes only those near a photo's footprint are asked, with the same result.
std::vector<BoxVisibility> FindVisibility(const survey::Survey& survey, const std::vector<Box>& boxes, int image_width, size_t few_boxes = 64);

}  // namespace skyquilt::partition
