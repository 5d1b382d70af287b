#include "prepare/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace skyquilt::prepare {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd SolveLeastSquares(const MatrixXd& a, const VectorXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

MatrixXd SolveSymmetric(const MatrixXd& a, const MatrixXd& b) {
  return a.ldlt().solve(b);
}

VectorXd SolvePositive(const MatrixXd& a, const VectorXd& b) {
  return a.llt().solve(b);
}

double LogDeterminant(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
}

bool SolveLowerCholesky(const MatrixXd& a, const MatrixXd& b, MatrixXd* solution) {
  const Eigen::LLT<MatrixXd> llt(a);
  if (llt.info() != Eigen::Success) return false;
  *solution = llt.matrixL().solve(b);
  return true;
}

MatrixXd InverseOf(const MatrixXd& a) {
  return a.inverse();
}

bool SymmetricEigen(const MatrixXd& a, VectorXd* values, MatrixXd* vectors) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  if (solver.info() != Eigen::Success) return false;
  *values = solver.eigenvalues();
  *vectors = solver.eigenvectors();
  return true;
}

}  // namespace skyquilt::prepare
