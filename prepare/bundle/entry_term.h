// One observation of a bundle as a linear term, and points by their observations alone.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

// Error of an entry against a point, and its derivatives by its photo (columns as in PoseManifold, the seventh is zero), its lens's numbers and the
// point, all over the entry's sigma.
struct EntryTerm {
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor, 2, 16> by_lens;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
};
EntryTerm TermOf(const BundleProblem& bundle, uint32_t entry, const Eigen::Vector3d& x_in_enu);

// The entry agrees and its photo has a pose.
bool Counts(const BundleProblem& bundle, uint32_t entry);

// Moves a point to the least squares of its agreeing entries.
void RefineByMarks(BundleProblem& bundle, uint32_t track);
// Covariance of a point by its agreeing entries alone, as if photos and lenses were exact. Nothing when fewer than two count.
std::optional<Eigen::Matrix3d> CovarianceByMarks(const BundleProblem& bundle, uint32_t track);

}  // namespace skyquilt::prepare::bundle
