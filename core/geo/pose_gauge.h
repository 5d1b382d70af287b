// Rotations as vectors, and the part of small changes of camera poses that only moves the whole: poses that are refined by photos alone can drift
// together by a similarity (seven parameters), which no photo shows but which would take the survey off its place.
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/geo/transform.h"

namespace skyquilt::geo {

// The rotation about `vector` by its length, radians, and back (length at most pi).
Eigen::Quaterniond RotationOfVector(const Eigen::Vector3d& vector);
Eigen::Vector3d VectorOfRotation(const Eigen::Quaterniond& rotation);
// J with RotationOfVector(v + d) = RotationOfVector(v) RotationOfVector(J d) for small d (Sola 2017, A micro Lie theory, eq. 143).
Eigen::Matrix3d RightJacobianOfRotation(const Eigen::Vector3d& vector);

// b_from_a, where a are the given and b the changed poses: the similarity that brings the given nearest to the changed ones. It minimises, over the
// poses i with weight w_i,
//   w_i (|c'_i - S c_i|^2 + arm^2 |angle between R'_i and S R_i|^2)
// for changes so small that their products do not matter. arm_m: about the distance of the things that the cameras see, > 0. Without weight anywhere,
// the identity. Poses are enu_from_cam; lengths in metres. Throws std::logic_error for different lengths.
Similarity3d SmallSimilarity(std::span<const Rigid3d> given, std::span<const Rigid3d> changed, std::span<const double> weights, double arm_m);

// Takes that similarity off the changed poses, all of them, also those without weight. What remains of it is below 1e-6 of the survey's extent for
// changes of up to a degree and a hundredth of the extent.
void RemoveSimilarity(std::span<const Rigid3d> given, std::span<const double> weights, double arm_m, std::span<Rigid3d> changed);

}  // namespace skyquilt::geo
