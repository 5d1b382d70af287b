// Units in which all parameters of a pose move the picture alike: camera preconditioning (Park et al. 2023, CamP, section 4). With J the
// derivatives of projected places by the parameters, and S the mean of J^T J over places all over the picture at several distances, the parameters
// are P phi with
//   P = (S + lambda diag(S) + mu 1)^(-1/2)
// so that phi of length 1 moves the places by about a pixel (root mean square, of the two axes together); less where lambda holds back combinations
// that hardly move the picture, such as the tilt and the shift of a camera that looks straight down.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/camera/camera.h"
#include "core/survey/refined_poses.h"

namespace skyquilt::worker {

using PoseVector = Eigen::Matrix<double, 6, 1>;  // rotation, radians, then translation, metres: survey::PoseOffset
using PoseMatrix = Eigen::Matrix<double, 6, 6>;

// P, and what tells how far a pose moves the picture.
struct PoseWhitening {
  PoseMatrix parameters_of_phi;  // P, symmetric
  PoseMatrix squared_pixels;     // S: the mean square movement of places is x^T S x

  double MovedPixels(const PoseVector& x) const { return std::sqrt(std::max(0.0, x.dot(squared_pixels.lazyProduct(x).eval()))); }
};

// distance_m: of what the photo shows, along its axis, > 0; places are at 0.7 to 1.4 times that.
PoseWhitening WhitenPose(const camera::Camera& camera, double distance_m);
}  // namespace skyquilt::worker
