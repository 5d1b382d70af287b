#include "core/linear/sparse.h"

#include <Eigen/SparseCholesky>
#include <vector>

namespace skyquilt::linear {

struct SparseFactors::Impl {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
};

SparseFactors::SparseFactors(int n, std::span<const SparseElement> elements) : impl_(std::make_unique<Impl>()) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(elements.size());
  for (const SparseElement& element : elements) triplets.emplace_back(element.row, element.column, element.value);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  impl_->solver.compute(matrix);
  ok_ = impl_->solver.info() == Eigen::Success;
  positive_definite_ = ok_ && (n == 0 || impl_->solver.vectorD().minCoeff() > 0.0);
}

SparseFactors::~SparseFactors() = default;

Eigen::MatrixXd SparseFactors::Solve(const Eigen::MatrixXd& b) const {
  return impl_->solver.solve(b);
}

}  // namespace skyquilt::linear
