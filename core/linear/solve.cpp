#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "core/linear/linear.h"

namespace skyquilt::linear {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Only the sizes of inner loops are worth code of their own.
template <>
Vector<3> SolveSymmetric<3>(const Square<3>& a, const Vector<3>& b) {
  return a.ldlt().solve(b);
}

MatrixXd SolveSymmetric(const MatrixXd& a, const MatrixXd& b) {
  return a.ldlt().solve(b);
}

template <>
VectorXd SolveSymmetric<Eigen::Dynamic>(const MatrixXd& a, const VectorXd& b) {
  return SolveSymmetric(a, MatrixXd(b));
}

template <>
Vector<2> SolveSymmetric<2>(const Square<2>& a, const Vector<2>& b) {
  return SolveSymmetric(MatrixXd(a), MatrixXd(b));
}

template <>
Vector<7> SolveSymmetric<7>(const Square<7>& a, const Vector<7>& b) {
  return SolveSymmetric(MatrixXd(a), MatrixXd(b));
}

VectorXd SolvePositive(const MatrixXd& a, const VectorXd& b) {
  return a.llt().solve(b);
}

bool SolveLowerCholesky(const MatrixXd& a, const MatrixXd& b, MatrixXd* solution, double least_rcond) {
  const Eigen::LLT<MatrixXd> llt(a);
  if (llt.info() != Eigen::Success || (least_rcond > 0.0 && !(llt.rcond() > least_rcond))) return false;
  *solution = llt.matrixL().solve(b);
  return true;
}

VectorXd SolveLeastSquares(const MatrixXd& a, const VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

bool SolvePivoted(const MatrixXd& a, const MatrixXd& b, double least_pivot, MatrixXd* solution) {
  const Eigen::FullPivLU<MatrixXd> lu(a);
  if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > least_pivot)) return false;
  *solution = lu.solve(b);
  return true;
}

template <>
MatrixXd Inverse<Eigen::Dynamic>(const MatrixXd& a) {
  return a.inverse();
}

template <>
Square<2> Inverse<2>(const Square<2>& a) {
  return a.inverse();
}

template <>
Square<3> Inverse<3>(const Square<3>& a) {
  return a.inverse();
}

template <>
Square<7> Inverse<7>(const Square<7>& a) {
  return MatrixXd(a).inverse();
}

template <>
double Determinant<2>(const Square<2>& a) {
  return a.determinant();
}

template <>
double Determinant<3>(const Square<3>& a) {
  return a.determinant();
}

double LogDeterminant(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

Eigen::MatrixXd Product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a * b;
}

Eigen::MatrixXd TransposedProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.transpose() * b;
}

}  // namespace skyquilt::linear
