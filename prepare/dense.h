// Decompositions of small dense matrices, compiled in one place: each use of Eigen's costs seconds of compilation.
#pragma once

#include <Eigen/Core>

namespace skyquilt::prepare {

// The x that minimises |a x - b|; a has at least as many rows as columns (Householder QR with column pivoting).
Eigen::VectorXd SolveLeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
// x of a x = b for a symmetric a, by LDL^T. Elements are not finite when a is singular.
Eigen::MatrixXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
// The same for a positive definite a, by Cholesky's L L^T; elements are not finite when it is not.
Eigen::VectorXd SolvePositive(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
// Logarithm of the determinant of a positive definite matrix.
double LogDeterminant(const Eigen::MatrixXd& a);
// L^-1 b for a = L L^T; false when a (its lower triangle is read) is not positive definite.
bool SolveLowerCholesky(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, Eigen::MatrixXd* solution);
// By LU with partial pivoting.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& a);
// Eigenvalues, ascending, and the unit eigenvectors (columns) of a symmetric matrix; false when they were not found.
bool SymmetricEigen(const Eigen::MatrixXd& a, Eigen::VectorXd* values, Eigen::MatrixXd* vectors);

}  // namespace skyquilt::prepare
