// Unit normals from vectors of any length, and their derivatives. A density grows into a surface, so its outward normal is n = -g / |g|, g the
// gradient of the log density; in ENU g_enu = UnitPerEnu(x)^T g_unit (encoding::SpaceMap). A normal head predicts the vector itself, in ENU.
#pragma once

#include <Eigen/Core>
#include <limits>

namespace skyquilt::render {

// v / |v|; zero where v is (nearly) zero or not finite: there is no normal.
template <typename T>
Eigen::Matrix<T, 3, 1> UnitNormal(const Eigen::Matrix<T, 3, 1>& v) {
  const T size = v.stableNorm();
  if (!(size > T(1e-12)) || !(size < std::numeric_limits<T>::max())) return Eigen::Matrix<T, 3, 1>::Zero();
  return v / size;
}

// d loss / d v from d loss / d n: (I - n n^T) dL/dn / |v|. Zero where there is no normal.
template <typename T>
Eigen::Matrix<T, 3, 1> UnitNormalBackward(const Eigen::Matrix<T, 3, 1>& v, const Eigen::Matrix<T, 3, 1>& normal_gradient) {
  const Eigen::Matrix<T, 3, 1> n = UnitNormal(v);
  if (n.isZero(T(0))) return n;
  return (normal_gradient - n.dot(normal_gradient) * n) / v.stableNorm();
}

// Of a density with this gradient.
template <typename T>
Eigen::Matrix<T, 3, 1> OutwardNormal(const Eigen::Matrix<T, 3, 1>& gradient) {
  return -UnitNormal(gradient);
}

// d loss / d gradient from d loss / d n.
template <typename T>
Eigen::Matrix<T, 3, 1> OutwardNormalBackward(const Eigen::Matrix<T, 3, 1>& gradient, const Eigen::Matrix<T, 3, 1>& normal_gradient) {
  return -UnitNormalBackward(gradient, normal_gradient);
}

}  // namespace skyquilt::render
