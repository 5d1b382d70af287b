// Losses of a surface's normal. The normal is given as a vector v of any length along it, such as the negative gradient of the log density or the
// output of a normal head, and the derivatives are by v. A vector without direction has no loss.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "core/render/density_normal.h"

namespace skyquilt::worker {

template <typename T>
struct VectorLoss {
  T value = T(0);
  Eigen::Matrix<T, 3, 1> gradient = Eigen::Matrix<T, 3, 1>::Zero();
};

// weight * (1 - n . target) with n = v / |v|; target: length 1, taken as given.
template <typename T>
VectorLoss<T> NormalLoss(T weight, const Eigen::Matrix<T, 3, 1>& v, const Eigen::Matrix<T, 3, 1>& target) {
  const Eigen::Matrix<T, 3, 1> n = render::UnitNormal(v);
  if (n.isZero(T(0))) return {};
  return {weight * (T(1) - n.dot(target)), render::UnitNormalBackward<T>(v, -weight * target)};
}

// weight * min(0, n . towards_camera)^2: a surface that is seen faces the camera (Verbin et al. 2022, Ref-NeRF, eq. 11). towards_camera: length 1.
template <typename T>
VectorLoss<T> OrientationLoss(T weight, const Eigen::Matrix<T, 3, 1>& v, const Eigen::Matrix<T, 3, 1>& towards_camera) {
  const T facing = std::min(T(0), render::UnitNormal(v).dot(towards_camera));
  if (!(facing < T(0))) return {};
  return {weight * facing * facing, render::UnitNormalBackward<T>(v, T(2) * weight * facing * towards_camera)};
}

}  // namespace skyquilt::worker
