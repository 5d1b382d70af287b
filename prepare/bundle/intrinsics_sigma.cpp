#include "prepare/bundle/intrinsics_sigma.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "core/linear/linear.h"
#include "prepare/bundle/adjustment_accuracy.h"
#include "prepare/bundle/camera_sample.h"
#include "prepare/bundle/entry_term.h"

namespace skyquilt::prepare::bundle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Residuals below this are rounding, not measurement: no feature is located to a thousandth of a pixel.
constexpr double kExactResidual_px = 1e-3;
// Of k1, and of the relative focal length, that the photos do not determine; of any real lens k1 is below 1.
constexpr double kLargestSigma = 1e3;
constexpr int kFrameFreedoms = 7;

bool HasDistortion(const camera::Camera& camera, int k1_index) {
  return std::any_of(camera.params.begin() + k1_index, camera.params.end(), [](double value) { return value != 0.0; });
}

// The point's distance along the rays is not known: what remains is rounding.
bool IsFlat(const Eigen::Matrix3d& covariance) {
  const linear::EigenPairs<3> axes = linear::SymmetricEigen<3>(covariance);
  return !(axes.values[0] > 1e-14 * axes.values[2]);
}

// Seven numbers of three points for the seven freedoms of the frame: what photos say about the lens does not depend on this choice. Well measured
// points, far from each other. `variance`: of each point; infinite: not in the sample.
std::vector<KnownPoint> HoldFrame(const BundleProblem& bundle, std::span<const uint32_t> tracks, const std::vector<double>& variance) {
  const auto best = [&](const auto& leverage) {
    const auto score = [&](uint32_t track) { return leverage(bundle.point[track]) / variance[track]; };
    return *std::max_element(tracks.begin(), tracks.end(), [&](uint32_t a, uint32_t b) { return score(a) < score(b); });
  };
  const uint32_t a = best([](const Eigen::Vector3d& /*point*/) { return 1.0; });
  const Eigen::Vector3d& origin = bundle.point[a];
  const uint32_t b = best([&](const Eigen::Vector3d& point) { return (point - origin).squaredNorm(); });
  const Eigen::Vector3d line = bundle.point[b] - origin;
  const uint32_t c = best([&](const Eigen::Vector3d& point) { return (point - origin).cross(line).squaredNorm(); });
  // The axis along which a turn about the line moves the third point most.
  Eigen::Index axis = 0;
  (bundle.point[c] - origin).cross(line).cwiseAbs().maxCoeff(&axis);
  const auto sigma = [&](uint32_t track) { return 0.1 * std::sqrt(variance[track]); };
  Eigen::Vector3d along = Eigen::Vector3d::Constant(kInfinity);
  along[axis] = sigma(c);
  return {{a, origin, Eigen::Vector3d::Constant(sigma(a))}, {b, bundle.point[b], Eigen::Vector3d::Constant(sigma(b))}, {c, bundle.point[c], along}};
}

}  // namespace

int RadialParameterIndex(camera::CameraModel model) {
  using camera::CameraModel;
  if (model == CameraModel::kSimplePinhole || model == CameraModel::kPinhole || model == CameraModel::kFov) return -1;
  return camera::HasOneFocalLength(model) ? 3 : 4;
}

LensAccuracy MeasureLensAccuracy(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id) {
  LensAccuracy accuracy;
  const auto found = model.cameras.find(camera_id);
  if (found == model.cameras.end()) return accuracy;
  const camera::Camera& camera = found->second;
  const int k1_index = RadialParameterIndex(camera.model);
  if (k1_index < 0 || !HasDistortion(camera, k1_index)) return accuracy;
  CameraSample sample = SelectSample(model, observations, camera_id, kMaxLensPhotos, kMaxLensPoints);
  BundleProblem& bundle = sample.bundle;
  const auto n_photos = std::count_if(bundle.photos.begin(), bundle.photos.end(), [](const BundlePhoto& photo) { return photo.placed; });
  if (n_photos < 3) return accuracy;

  accuracy.n_photos = static_cast<int>(n_photos);
  std::vector<double> variance(bundle.tracks.size(), kInfinity);
  double sum_of_squares = 0.0;
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    const std::optional<Eigen::Matrix3d> covariance = CovarianceByMarks(bundle, t);
    if (!covariance || IsFlat(*covariance)) {
      bundle.has_point[t] = 0;
      continue;
    }
    variance[t] = covariance->trace();
    ++accuracy.n_points;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      if (!Counts(bundle, e)) continue;
      sum_of_squares += TermOf(bundle, e, bundle.point[t]).residual.squaredNorm();
      ++accuracy.n_observations;
    }
  }
  const int n_free = CountNumbers(camera) - static_cast<int>(HeldNumbersOf(bundle.lenses.front()).size());
  const int redundancy = 2 * accuracy.n_observations - 6 * accuracy.n_photos - 3 * accuracy.n_points - n_free + kFrameFreedoms;
  if (redundancy < 1) return accuracy;
  accuracy.sigma0_px = std::sqrt(sum_of_squares / redundancy);
  if (!(accuracy.sigma0_px > kExactResidual_px)) return accuracy;

  std::vector<uint32_t> tracks(bundle.tracks.size());
  std::iota(tracks.begin(), tracks.end(), uint32_t{0});
  const std::vector<KnownPoint> frame = HoldFrame(bundle, tracks, variance);
  BundleStage stage{.loss = kInfinity, .gentle = true, .lens_prior = false, .known = frame};
  const AdjustmentAccuracy of_all(bundle, tracks, stage, nullptr);
  const auto k1_variance = of_all.OfLens(0, LensOf(camera) ? 4 : k1_index), focal_variance = of_all.OfLens(0, 0);
  if (k1_variance && focal_variance) {
    const auto sigma_of = [&](double number_variance, double unit) {
      const double sigma = accuracy.sigma0_px * std::sqrt(number_variance * sample.share_of_points) / unit;
      return std::isfinite(sigma) ? std::min(sigma, kLargestSigma) : std::numeric_limits<double>::quiet_NaN();
    };
    accuracy.k1_sigma = sigma_of(*k1_variance, 1.0);
    accuracy.focal_sigma = sigma_of(*focal_variance, camera.FocalX());
    return accuracy;
  }
  // It is the lens that the photos do not determine if they determine the poses with a known one.
  stage.free_lens = false;
  if (AdjustmentAccuracy(bundle, tracks, stage, nullptr).ok()) accuracy.k1_sigma = accuracy.focal_sigma = kLargestSigma;
  return accuracy;
}

}  // namespace skyquilt::prepare::bundle
