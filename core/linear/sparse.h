// Large symmetric systems with few elements per row.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

namespace skyquilt::linear {

struct SparseElement {
  int row, column;
  double value;
};

// The factors L D L^T of a symmetric matrix with `n` rows, from its lower triangle. Elements of the same place are added; those above the diagonal
// are not read.
class SparseFactors {
 public:
  SparseFactors(int n, std::span<const SparseElement> elements);
  ~SparseFactors();
  SparseFactors(const SparseFactors&) = delete;
  SparseFactors& operator=(const SparseFactors&) = delete;

  bool ok() const { return ok_; }  // false: a pivot is zero, and there is nothing to solve with
  bool positive_definite() const { return positive_definite_; }
  // x of a x = b. Needs ok().
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  bool ok_ = false, positive_definite_ = false;
};

}  // namespace skyquilt::linear
