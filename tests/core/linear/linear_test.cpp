#include "core/linear/linear.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/linear/sparse.h"

namespace skyquilt::linear {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd AnyMatrix(Eigen::Index rows, Eigen::Index cols) {
  MatrixXd a(rows, cols);
  for (double& value : a.reshaped()) value = *rc::gen::inRange(-1000, 1001) / 100.0;
  return a;
}

// Symmetric, with eigenvalues of at least 0.5.
MatrixXd AnyPositive(Eigen::Index n) {
  const MatrixXd a = AnyMatrix(n, n);
  return a * a.transpose() + 0.5 * MatrixXd::Identity(n, n);
}

template <int n>
void CheckEigen() {
  const Square<n> a = AnyPositive(n == Eigen::Dynamic ? 5 : n) - 3.0 * MatrixXd::Identity(n == Eigen::Dynamic ? 5 : n, n == Eigen::Dynamic ? 5 : n);
  const EigenPairs<n> eigen = SymmetricEigen(a);
  RC_ASSERT(eigen.found);
  RC_ASSERT((a * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm() < 1e-10 * a.norm());
  RC_ASSERT((eigen.vectors.transpose() * eigen.vectors).isIdentity(1e-12));
  for (Eigen::Index i = 1; i < eigen.values.size(); ++i) RC_ASSERT(eigen.values[i] >= eigen.values[i - 1]);
}

RC_GTEST_PROP(SymmetricEigen, GivesOrderedPairs, ()) {
  CheckEigen<2>();
  CheckEigen<3>();
  CheckEigen<Eigen::Dynamic>();
}

RC_GTEST_PROP(SymmetricEigen, InClosedFormIsTheSame, ()) {
  const Eigen::Matrix3d a = AnyPositive(3);
  RC_ASSERT((FastSymmetricEigen(a).values - SymmetricEigen(a).values).norm() < 1e-6 * a.norm());
}

TEST(SymmetricEigen, SaysWhenThereAreNone) {
  EXPECT_FALSE(SymmetricEigen<Eigen::Dynamic>(MatrixXd::Constant(4, 4, std::numeric_limits<double>::quiet_NaN())).found);
}

template <int n>
void CheckInverse() {
  const Square<n> a = AnyPositive(n);
  RC_ASSERT((Inverse(a) * a).isIdentity(1e-6));
  const Vector<n> b = AnyMatrix(n, 1);
  RC_ASSERT((a * SolveSymmetric(a, b) - b).norm() < 1e-6 * (1.0 + b.norm()));
}

RC_GTEST_PROP(Inverse, TimesTheMatrixIsTheIdentity, ()) {
  CheckInverse<2>();
  CheckInverse<3>();
  CheckInverse<7>();
  const MatrixXd a = AnyPositive(4);
  RC_ASSERT((Inverse(a) * a).isIdentity(1e-6));
}

RC_GTEST_PROP(Solve, AllWaysAgree, ()) {
  const MatrixXd a = AnyPositive(5), b = AnyMatrix(5, 2);
  const MatrixXd x = SolveSymmetric(a, b);
  RC_ASSERT((a * x - b).norm() < 1e-6 * (1.0 + b.norm()));
  RC_ASSERT((SolvePositive(a, b.col(0)) - x.col(0)).norm() < 1e-6 * (1.0 + x.norm()));
  MatrixXd pivoted, lower;
  RC_ASSERT(SolvePivoted(a, b, 1e-9, &pivoted));
  RC_ASSERT((pivoted - x).norm() < 1e-6 * (1.0 + x.norm()));
  // (L^-1 b)^T (L^-1 b) = b^T a^-1 b.
  RC_ASSERT(SolveLowerCholesky(a, b, &lower));
  RC_ASSERT((lower.transpose() * lower - b.transpose() * x).norm() < 1e-6 * (1.0 + (b.transpose() * x).norm()));
  RC_ASSERT(std::abs(LogDeterminant(a) - SymmetricEigen(a).values.array().log().sum()) < 1e-8);
}

TEST(Solve, RefusesWhatHasNoSolution) {
  MatrixXd solution;
  EXPECT_FALSE(SolvePivoted(MatrixXd::Ones(3, 3), MatrixXd::Ones(3, 1), 1e-9, &solution));
  EXPECT_FALSE(SolveLowerCholesky(-MatrixXd::Identity(3, 3), MatrixXd::Ones(3, 1), &solution));
  const MatrixXd nearly_singular = Eigen::Vector3d(1.0, 1.0, 1e-15).asDiagonal();
  EXPECT_TRUE(SolveLowerCholesky(nearly_singular, MatrixXd::Ones(3, 1), &solution));
  EXPECT_FALSE(SolveLowerCholesky(nearly_singular, MatrixXd::Ones(3, 1), &solution, 1e-14));
}

RC_GTEST_PROP(LeastSquares, LeavesNothingAlongTheColumns, ()) {
  MatrixXd a = AnyMatrix(7, 3);
  a.topRows(3) += 30.0 * MatrixXd::Identity(3, 3);
  const VectorXd b = AnyMatrix(7, 1);
  RC_ASSERT((a.transpose() * (a * SolveLeastSquares(a, b) - b)).norm() < 1e-8 * (1.0 + a.norm() * b.norm()));
}

RC_GTEST_PROP(Similarity, FindsWhatWasApplied, ()) {
  const Eigen::Matrix3Xd from = AnyMatrix(3, 6) + 20.0 * MatrixXd::Identity(3, 6);
  Eigen::Matrix4d truth = Eigen::Matrix4d::Identity();
  const double angle = *rc::gen::inRange(-300, 301) / 100.0;
  truth.topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  truth.topLeftCorner<3, 3>() *= 2.5;
  truth.topRightCorner<3, 1>() = AnyMatrix(3, 1);
  const Eigen::Matrix3Xd to = (truth.topLeftCorner<3, 3>() * from).colwise() + truth.topRightCorner<3, 1>().eval();
  RC_ASSERT((Similarity(from, to) - truth).norm() < 1e-8);
}

RC_GTEST_PROP(Product, IsTheSumOfProducts, ()) {
  const MatrixXd a = AnyMatrix(7, 9), b = AnyMatrix(9, 4);
  RC_ASSERT((Product(a, b) - MatrixXd(a.lazyProduct(b))).norm() < 1e-10);
  RC_ASSERT((TransposedProduct(a.transpose(), b) - MatrixXd(a.lazyProduct(b))).norm() < 1e-10);
}

RC_GTEST_PROP(RotationBetween, IsTheShortestThatBringsOneToTheOther, ()) {
  const Eigen::Vector3d from = AnyMatrix(3, 1), to = AnyMatrix(3, 1);
  RC_PRE(from.norm() > 0.1 && to.norm() > 0.1);
  const Eigen::Quaterniond rotation = RotationBetween(from, to);
  RC_ASSERT(std::abs(rotation.norm() - 1.0) < 1e-9);
  RC_ASSERT((rotation * from.normalized() - to.normalized()).norm() < 1e-9);
  const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
  RC_ASSERT(std::abs(2.0 * std::atan2(rotation.vec().norm(), rotation.w()) - angle) < 1e-7);
}

RC_GTEST_PROP(RotationBetween, TurnsOppositeDirectionsByHalfATurn, ()) {
  const Eigen::Vector3d from = AnyMatrix(3, 1);
  RC_PRE(from.norm() > 0.1);
  const Eigen::Quaterniond rotation = RotationBetween(from, -2.0 * from);
  RC_ASSERT(std::abs(rotation.norm() - 1.0) < 1e-9);
  RC_ASSERT((rotation * from.normalized() + from.normalized()).norm() < 1e-9);
}

RC_GTEST_PROP(SparseFactors, SolveLikeDenseOnes, ()) {
  const int n = 6;
  std::vector<SparseElement> elements;
  MatrixXd dense = MatrixXd::Zero(n, n);
  const auto add = [&](int row, int column, double value) {
    elements.push_back({row, column, value});
    dense(row, column) += value;
    if (row != column) dense(column, row) += value;
  };
  for (int i = 0; i < n; ++i) add(i, i, 30.0);
  for (int i = 1; i < n; ++i) add(i, *rc::gen::inRange(0, i), *rc::gen::inRange(-9, 10));
  add(n - 1, n - 1, 1.0);  // a place that is named twice
  const MatrixXd b = AnyMatrix(n, 2);
  const SparseFactors factors(n, elements);
  RC_ASSERT(factors.ok() && factors.positive_definite());
  RC_ASSERT((dense * factors.Solve(b) - b).norm() < 1e-9 * (1.0 + b.norm()));
}

TEST(SparseFactors, SayWhatTheyAreNot) {
  EXPECT_FALSE(SparseFactors(2, std::vector<SparseElement>{{0, 0, 0.0}, {1, 1, 0.0}}).ok());
  const SparseFactors negative(2, std::vector<SparseElement>{{0, 0, 1.0}, {1, 1, -1.0}});
  EXPECT_TRUE(negative.ok());
  EXPECT_FALSE(negative.positive_definite());
}

}  // namespace
}  // namespace skyquilt::linear
