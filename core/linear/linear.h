// Decompositions of small dense matrices, compiled once: each use of Eigen's own costs seconds of compilation. Only this room includes them.
// `n` is the number of rows: one of the sizes named, or Eigen::Dynamic. Matrices with other types, such as sums, need it: Inverse<2>(a + b).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skyquilt::linear {

template <int n>
using Square = Eigen::Matrix<double, n, n>;
template <int n>
using Vector = Eigen::Matrix<double, n, 1>;

template <int n>
struct EigenPairs {
  Vector<n> values;   // ascending
  Square<n> vectors;  // unit vectors, in columns
  bool found;         // false: the iteration did not converge, as with elements that are not finite
};
// Of a symmetric matrix, whose lower triangle is read. n: 2, 3, Dynamic.
template <int n>
EigenPairs<n> SymmetricEigen(const Square<n>& a);
// In closed form: several times as fast, less exact where eigenvalues are close to each other.
EigenPairs<3> FastSymmetricEigen(const Eigen::Matrix3d& a);

// x of a x = b for a symmetric a, by L D L^T with pivoting. Elements may be not finite when a is singular. n: 2, 3, 7, Dynamic.
template <int n>
Vector<n> SolveSymmetric(const Square<n>& a, const Vector<n>& b);
Eigen::MatrixXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
// The same for a positive definite a, by L L^T.
Eigen::VectorXd SolvePositive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
// L^-1 b for a = L L^T. False when a, whose lower triangle is read, is not positive definite, or the inverse of its condition number is below
// `least_rcond`.
bool SolveLowerCholesky(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, Eigen::MatrixXd* solution, double least_rcond = 0.0);
// The x that minimises |a x - b|; a has at least as many rows as columns. By QR with column pivoting.
Eigen::VectorXd SolveLeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
// x of a x = b by LU with full pivoting. False when a pivot is not larger than `least_pivot`.
bool SolvePivoted(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double least_pivot, Eigen::MatrixXd* solution);

// By LU with partial pivoting, in closed form up to 4 rows. Elements are not finite when a is singular. n: 2, 3, 7, Dynamic.
template <int n>
Square<n> Inverse(const Square<n>& a);
// n: 2, 3.
template <int n>
double Determinant(const Square<n>& a);
// Logarithm of the determinant of a positive definite matrix.
double LogDeterminant(const Eigen::MatrixXd& a);

// Rotation, scale and translation (4 x 4) that bring the columns of `from` nearest to those of `to` (Umeyama 1991, equations 39 to 43).
// Not finite when the columns are all one point.
Eigen::Matrix4d Similarity(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

// a b and a^T b by Eigen's blocked algorithm, whose code for one pair of types takes three seconds to compile. For large matrices; for small ones use
// lazyProduct().
Eigen::MatrixXd Product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd TransposedProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The shortest rotation that brings the direction of `from` to that of `to`. Neither needs to be a unit vector.
Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// All sizes there are.
template <>
EigenPairs<2> SymmetricEigen<2>(const Square<2>& a);
template <>
EigenPairs<3> SymmetricEigen<3>(const Square<3>& a);
template <>
EigenPairs<Eigen::Dynamic> SymmetricEigen<Eigen::Dynamic>(const Eigen::MatrixXd& a);
template <>
Vector<2> SolveSymmetric<2>(const Square<2>& a, const Vector<2>& b);
template <>
Vector<3> SolveSymmetric<3>(const Square<3>& a, const Vector<3>& b);
template <>
Vector<7> SolveSymmetric<7>(const Square<7>& a, const Vector<7>& b);
template <>
Eigen::VectorXd SolveSymmetric<Eigen::Dynamic>(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
template <>
Square<2> Inverse<2>(const Square<2>& a);
template <>
Square<3> Inverse<3>(const Square<3>& a);
template <>
Square<7> Inverse<7>(const Square<7>& a);
template <>
Eigen::MatrixXd Inverse<Eigen::Dynamic>(const Eigen::MatrixXd& a);
template <>
double Determinant<2>(const Square<2>& a);
template <>
double Determinant<3>(const Square<3>& a);

}  // namespace skyquilt::linear
