// The lens as the adjustment sees it: COLMAP's OPENCV model with the ratio of the focal lengths in place of the second one, so that models with one
// focal length and fewer coefficients are the same lens with some numbers held.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/camera/camera.h"

namespace skyquilt::prepare::bundle {

// f, fy / fx, cx, cy, k1, k2, p1, p2; pixels for f, cx and cy.
using Lens = std::array<double, 8>;

// Nothing for models with more coefficients (FULL_OPENCV) or another kind of distortion (FOV and fisheyes).
std::optional<Lens> LensOf(const camera::Camera& camera);
// The camera with the numbers of the lens; `model` is the camera that LensOf was given.
camera::Camera CameraOf(const Lens& lens, const camera::Camera& model);
// Where LensOf gives nothing, the camera's parameters are the numbers. Of such a lens there are terms (TermOf) and, without a prior, an accuracy
// (AdjustmentAccuracy), but no adjustment.
int CountNumbers(const camera::Camera& camera);
// Which numbers of the lens the model does not have, and, unless `free_centre`, the principal point, which photos of a flight hardly determine.
std::vector<int> HeldNumbers(const camera::Camera& camera, bool free_centre);

struct LensJacobian {
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, 8> by_lens;
};

// Pixel of a point in the camera frame, z away from 0; for points behind the camera the formula's value, which has no meaning. `jacobian` may be
// null.
Eigen::Vector2d Project(const Lens& lens, const Eigen::Vector3d& x_in_cam, LensJacobian* jacobian);

}  // namespace skyquilt::prepare::bundle
