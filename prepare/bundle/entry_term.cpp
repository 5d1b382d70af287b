#include "prepare/bundle/entry_term.h"

#include <algorithm>
#include <cmath>

#include "core/linear/linear.h"
#include "prepare/bundle/bundle_costs.h"

namespace skyquilt::prepare::bundle {
namespace {

// Of a lens that LensOf does not know: by central differences. A point that the camera does not see has no error.
EntryTerm TermByDifferences(const BundlePhoto& photo, camera::Camera camera, const Eigen::Vector2d& pixel, double sigma_px,
                            const Eigen::Vector3d& x_in_enu) {
  const Eigen::Vector3d x_in_cam = photo.cam_from_enu * (x_in_enu - photo.centre);
  const Eigen::Vector2d projected = camera.ImgFromCam(x_in_cam).value_or(pixel);
  const auto n_params = static_cast<Eigen::Index>(camera.params.size());
  Eigen::Matrix2Xd slopes(2, 3 + n_params);  // by the point in the camera frame and the camera's parameters
  for (Eigen::Index k = 0; k < slopes.cols(); ++k) {
    Eigen::Vector3d x = x_in_cam;
    double& number = k < 3 ? x[k] : camera.params[static_cast<size_t>(k - 3)];
    // A millionth of the depth moves the pixel by about a thousandth: far above rounding, far below where the lens' curvature counts. Focal lengths
    // and the principal point are in pixels, distortion is near 1.
    const double value = number, step = 1e-6 * (k < 3 ? x_in_cam.z() : std::max(1.0, std::abs(value)));
    number = value + step;
    const auto ahead = camera.ImgFromCam(x);
    number = value - step;
    const auto behind = camera.ImgFromCam(x);
    number = value;
    // At the rim of what the lens shows, one side has no pixel.
    slopes.col(k) = (ahead.value_or(projected) - behind.value_or(projected)) / ((ahead && behind ? 2.0 : 1.0) * step * sigma_px);
  }
  EntryTerm term;
  term.residual = (projected - pixel) / sigma_px;
  term.by_point = slopes.leftCols<3>() * photo.cam_from_enu.toRotationMatrix();
  term.by_lens = slopes.rightCols(n_params);
  for (int row = 0; row < 2; ++row)
    term.by_pose.row(row) << x_in_cam.cross(slopes.row(row).head<3>().transpose()).transpose(), -term.by_point.row(row), 0.0;
  return term;
}

}  // namespace

EntryTerm TermOf(const BundleProblem& bundle, uint32_t entry, const Eigen::Vector3d& x_in_enu) {
  const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[entry].photo];
  const BundleLens& lens = bundle.lenses[static_cast<size_t>(photo.lens)];
  const double sigma_px = lens.unit_px * (bundle.sigma.empty() ? 1.0 : bundle.sigma[entry]);
  if (!LensOf(lens.camera)) return TermByDifferences(photo, lens.camera, bundle.pixel[entry], sigma_px, x_in_enu);
  PoseNumbers pose{};
  Eigen::Map<Eigen::Vector4d>(pose.data()) = photo.cam_from_enu.coeffs();
  Eigen::Map<Eigen::Vector3d>(pose.data() + 4) = photo.centre;
  EntryTerm term;
  term.by_lens.resize(2, 8);
  const ReprojectionCost cost(bundle.pixel[entry], sigma_px);
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
