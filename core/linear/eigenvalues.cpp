#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "core/linear/linear.h"

namespace skyquilt::linear {
namespace {

template <int n>
EigenPairs<n> PairsOf(const Square<n>& a) {
  const Eigen::SelfAdjointEigenSolver<Square<n>> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

}  // namespace

// Only the sizes of inner loops are worth code of their own.
template <>
EigenPairs<3> SymmetricEigen<3>(const Square<3>& a) {
  return PairsOf<3>(a);
}

template <>
EigenPairs<Eigen::Dynamic> SymmetricEigen<Eigen::Dynamic>(const Eigen::MatrixXd& a) {
  return PairsOf<Eigen::Dynamic>(a);
}

template <>
EigenPairs<2> SymmetricEigen<2>(const Square<2>& a) {
  const EigenPairs<Eigen::Dynamic> pairs = PairsOf<Eigen::Dynamic>(a);
  return {pairs.values, pairs.vectors, pairs.found};
}

EigenPairs<3> FastSymmetricEigen(const Eigen::Matrix3d& a) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(a);
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

Eigen::Matrix4d Similarity(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  return Eigen::umeyama(from, to, true);
}

Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = a.dot(b);
  // Opposite directions: half a turn about any axis across. Eigen's FromTwoVectors looks for one by a singular value decomposition.
  if (cosine < -1.0 + 1e-12) {
    const Eigen::Vector3d axis = a.unitOrthogonal();
    return {0.0, axis.x(), axis.y(), axis.z()};
  }
  const double s = std::sqrt(2.0 * (1.0 + cosine));
  const Eigen::Vector3d axis = a.cross(b) / s;
  return {0.5 * s, axis.x(), axis.y(), axis.z()};
}

}  // namespace skyquilt::linear
