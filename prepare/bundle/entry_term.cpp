#include "prepare/bundle/entry_term.h"

#include "core/linear/linear.h"
#include "prepare/bundle/bundle_costs.h"

namespace skyquilt::prepare::bundle {

EntryTerm TermOf(const BundleProblem& bundle, uint32_t entry, const Eigen::Vector3d& x_in_enu) {
  const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[entry].photo];
  const BundleLens& lens = bundle.lenses[static_cast<size_t>(photo.lens)];
  PoseNumbers pose{};
  Eigen::Map<Eigen::Vector4d>(pose.data()) = photo.cam_from_enu.coeffs();
  Eigen::Map<Eigen::Vector3d>(pose.data() + 4) = photo.centre;
  EntryTerm term;
  const ReprojectionCost cost(bundle.pixel[entry], lens.unit_px * (bundle.sigma.empty() ? 1.0 : bundle.sigma[entry]));
  const double* parameters[] = {pose.data(), lens.numbers.data(), x_in_enu.data()};
  double* jacobians[] = {term.by_pose.data(), term.by_lens.data(), term.by_point.data()};
  cost.Evaluate(parameters, term.residual.data(), jacobians);
  return term;
}

bool Counts(const BundleProblem& bundle, uint32_t entry) {
  return bundle.agrees[entry] != 0 && bundle.photos[bundle.tracks.entries[entry].photo].placed;
}

void RefineByMarks(BundleProblem& bundle, uint32_t track) {
  constexpr int kSteps = 4;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (uint32_t e = bundle.tracks.first[track]; e < bundle.tracks.first[track + 1]; ++e) {
      if (!Counts(bundle, e)) continue;
      const EntryTerm term = TermOf(bundle, e, bundle.point[track]);
      information += term.by_point.transpose() * term.by_point;
      gradient += term.by_point.transpose() * term.residual;
    }
    const Eigen::Vector3d change = linear::SolveSymmetric(information, gradient);
    if (!change.allFinite()) return;
    bundle.point[track] -= change;
  }
}

std::optional<Eigen::Matrix3d> CovarianceByMarks(const BundleProblem& bundle, uint32_t track) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int n = 0;
  for (uint32_t e = bundle.tracks.first[track]; e < bundle.tracks.first[track + 1]; ++e) {
    if (!Counts(bundle, e)) continue;
    const EntryTerm term = TermOf(bundle, e, bundle.point[track]);
    information += term.by_point.transpose() * term.by_point;
    ++n;
  }
  const Eigen::Matrix3d inverse = linear::Inverse(information);
  if (n < 2 || !inverse.allFinite()) return std::nullopt;
  return inverse;
}

}  // namespace skyquilt::prepare::bundle
