#include "prepare/control/fit/control_adjustment.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/bundle/adjustment_accuracy.h"
#include "prepare/bundle/entry_term.h"
#include "prepare/bundle/feature_tracks.h"
#include "prepare/bundle/robust.h"
#include "prepare/bundle/triangulate.h"

namespace skyquilt::prepare::control {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kTiesPerPhoto = 512;
constexpr double kMarkThreshold = 4.5;  // sigmas of a mark's error that is no outlier
constexpr double kKnownLoss = 3.0;
constexpr double kLeastTieSigma = 0.05;
constexpr size_t kLeastUsed = 4;  // with fewer, any of them might be the wrong one
constexpr int kMaxRejected = 4;   // each needs an adjustment

class Adjuster {
 public:
  Adjuster(ControlBundle& marked, std::vector<ControlState>& points, Vector3d* shift, base::ThreadPool& threads,
           const std::function<void()>& on_iteration)
      : marked_(marked),
        bundle_(marked.bundle),
        points_(points),
        shift_(shift),
        threads_(threads),
        on_iteration_(on_iteration),
        all_ties_(marked.n_ties) {
    std::iota(all_ties_.begin(), all_ties_.end(), uint32_t{0});
  }

  ControlAdjustment Run() {
    ControlAdjustment result;
    const ControlBundle before = marked_;
    const std::vector<ControlState> points_before = points_;
    if (!Begin()) return Failed(before, points_before);
    for (int round = 0;; ++round) {
      bundle::Triangulate(bundle_, all_ties_, kTieThreshold, threads_);
      MeasureTies(ties_);
      MeasureMarks();
      Choose();
      if (!Adjust(1e-9, 50)) return Failed(before, points_before);
      // Once more with the marks that agree with this result.
      if (JudgeMarks() && !Adjust(1e-9, 50)) return Failed(before, points_before);
      const bundle::AdjustmentAccuracy accuracy(bundle_, tracks_, Stage(0.0, 0), shift_);
      if (!accuracy.ok()) return Failed(before, points_before);
      Evaluate(accuracy);
      result.accuracy = accuracy.OfPlace();
      if (round >= kMaxRejected || !RejectWorst()) break;
    }
    bundle::Triangulate(bundle_, all_ties_, kTieThreshold, threads_);
    result.ok = true;
    result.misfit = MisfitOf(points_);
    Inflate(&result);
    return result;
  }

  bool RunByFeatures() {
    const ControlBundle before = marked_;
    bool solved = Begin();
    if (solved) {
      bundle::Triangulate(bundle_, all_ties_, kTieThreshold, threads_);
      MeasureTies(ties_);
      Choose();
      solved = Adjust(1e-9, 50);
    }
    if (solved) {
      bundle::Triangulate(bundle_, all_ties_, kTieThreshold, threads_);
    } else {
      marked_ = before;
    }
    return solved;
  }

 private:
  bool Begin() {
    MeasureTies(all_ties_);
    DropOutliers();
    Choose();
    return Adjust(1e-6, 30);
  }

  ControlAdjustment Failed(const ControlBundle& before, const std::vector<ControlState>& points_before) {
    marked_ = before;
    points_ = points_before;
    return {};
  }

  bundle::BundleStage Stage(double tolerance, int iterations) const {
    return {.loss = 2.5, .gentle = true, .max_iterations = iterations, .tolerance = tolerance, .known = known_, .known_loss = kKnownLoss};
  }

  bool Adjust(double tolerance, int iterations) {
    known_.clear();
    tracks_ = ties_;
    for (const ControlState& point : points_) {
      if (!point.used) continue;
      known_.push_back(point.Known());
      tracks_.push_back(point.track);
    }
    return bundle::AdjustBundle(bundle_, tracks_, Stage(tolerance, iterations), on_iteration_, shift_);
  }

  void Choose() {
    std::vector<char> usable = bundle_.has_point;
    std::fill(usable.begin() + static_cast<std::ptrdiff_t>(marked_.n_ties), usable.end(), char{0});
    ties_ = bundle::ChooseTracks(bundle_, usable, bundle_.agrees, kTiesPerPhoto);
  }

  // Features' sigma from the median error of the agreeing ones; the adjustment has taken a share of it.
  void MeasureTies(const std::vector<uint32_t>& of) {
    std::vector<double> errors;
    double unknowns = 0.0;
    for (const uint32_t t : of) {
      if (bundle_.has_point[t] == 0) continue;
      const size_t n = errors.size();
      for (uint32_t e = bundle_.tracks.first[t]; e < bundle_.tracks.first[t + 1]; ++e) {
        const double error = bundle_.agrees[e] != 0 ? bundle_.Error(e, bundle_.point[t]) : -1.0;
        if (error >= 0.0) errors.push_back(error);
      }
      unknowns += errors.size() > n ? 3.0 : 0.0;
    }
    unknowns += 6.0 * static_cast<double>(bundle_.photos.size());
    if (errors.empty()) return;
    const double residuals = 2.0 * static_cast<double>(errors.size());
    const double share = std::max(0.1, (residuals - unknowns) / residuals);
    const double sigma = marked_.tie_sigma * base::UpperMedian(errors) / bundle::kRayleighMedian / std::sqrt(share);
    marked_.SetAccuracy(std::max(sigma, kLeastTieSigma), marked_.mark_sigma_px);
  }

  // Estimates the marks' sigma; its value before counts as much as ten residuals of the marks.
  void MeasureMarks() {
    PlaceUnusedPoints(marked_, points_, marked_.MarkThreshold(kMarkThreshold));
    constexpr double kPriorWeight = 10.0, kLeast = 0.2, kMost = 6.0;
    std::vector<double> errors_px;
    double residuals = 0.0, unknowns = 0.0;
    for (const ControlState& point : points_) {
      const uint32_t t = point.track;
      if (bundle_.has_point[t] == 0) continue;
      const size_t n = errors_px.size();
      for (uint32_t e = bundle_.tracks.first[t]; e < bundle_.tracks.first[t + 1]; ++e) {
        const double error = bundle_.Error(e, bundle_.point[t]);
        const double unit_px = bundle_.lenses[static_cast<size_t>(bundle_.photos[bundle_.tracks.entries[e].photo].lens)].unit_px;
        if (error >= 0.0) errors_px.push_back(error * unit_px);
      }
      const size_t of_point = errors_px.size() - n;
      if (of_point < 3) {
        errors_px.resize(n);
        continue;
      }
      residuals += 2.0 * static_cast<double>(of_point);
      unknowns += 3.0;
    }
    if (first_mark_sigma_px_ <= 0.0) first_mark_sigma_px_ = marked_.mark_sigma_px;
    const double said = first_mark_sigma_px_;
    double sigma_px = said;
    if (!errors_px.empty()) {
      const double seen = base::UpperMedian(errors_px) / bundle::kRayleighMedian / std::sqrt((residuals - unknowns) / residuals);
      sigma_px = std::sqrt((kPriorWeight * said * said + (residuals - unknowns) * seen * seen) / (kPriorWeight + residuals - unknowns));
    }
    marked_.SetAccuracy(marked_.tie_sigma, std::clamp(sigma_px, kLeast * said, kMost * said));
  }

  // True when other marks of used points agree than before.
  bool JudgeMarks() {
    const auto first_mark = bundle_.agrees.begin() + static_cast<std::ptrdiff_t>(bundle_.tracks.first[marked_.n_ties]);
    const std::vector<char> before(first_mark, bundle_.agrees.end());
    JudgeUsedMarks(marked_, points_, marked_.MarkThreshold(kMarkThreshold));
    const bool changed = !std::equal(before.begin(), before.end(), first_mark);
    for (ControlState& point : points_) {
      // Two marks make a point.
      if (!point.used || bundle_.has_point[point.track] != 0) continue;
      point.used = false;
      point.contradicts = true;
    }
    PlaceUnusedPoints(marked_, points_, marked_.MarkThreshold(kMarkThreshold));
    return changed;
  }

  void DropOutliers() {
    for (const uint32_t t : all_ties_) {
      size_t n = 0;
      for (uint32_t e = bundle_.tracks.first[t]; e < bundle_.tracks.first[t + 1]; ++e) {
        const double error = bundle_.Error(e, bundle_.point[t]);
        bundle_.agrees[e] = error >= 0.0 && error <= kTieThreshold ? 1 : 0;
        n += bundle_.agrees[e] != 0 ? 1 : 0;
      }
      if (n < 2) bundle_.has_point[t] = 0;
    }
  }

  void Evaluate(const bundle::AdjustmentAccuracy& accuracy) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    for (ControlState& point : points_) {
      point.error_m = point.error_sigma_m = point.left_out_error_m = point.left_out_sigma_m = Vector3d::Constant(kNan);
      if (bundle_.has_point[point.track] == 0) continue;
      point.error_m = bundle_.point[point.track] - point.given;
      const bundle::KnownPoint known = point.Known();
      const std::optional<Matrix3d> covariance = accuracy.OfPoint(point.track, point.used ? &known : nullptr);
      if (covariance) {
        const Eigen::Array3d of_point = covariance->diagonal().array(), given = point.sigma_m.array().square();
        // A point that is used has moved towards what was given.
        const Eigen::Array3d of_error = point.used ? Eigen::Array3d((given - of_point).max(0.0)) : Eigen::Array3d(given + of_point);
        point.error_sigma_m = of_error.sqrt();
        Matrix3d without;
        const Vector3d own = bundle::KnownWeight(known, bundle_.point[point.track], kKnownLoss) * point.sigma_m.cwiseAbs2().cwiseInverse();
        if (point.used && LeaveOut(point.error_m, *covariance, own, &point.left_out_error_m, &without)) {
          point.left_out_sigma_m = (without.diagonal().array() + given).sqrt();
        }
      }
      if (point.HasHeight()) continue;
      point.error_m.z() = point.error_sigma_m.z() = point.left_out_error_m.z() = point.left_out_sigma_m.z() = kNan;
    }
  }

  // The used point that misses most when it is left out, if by far more than the others do.
  bool RejectWorst() {
    constexpr double kLimit = 4.5;
    std::vector<double> all;
    double worst = 0.0;
    ControlState* worst_point = nullptr;
    size_t n_used = 0;
    for (ControlState& point : points_) {
      if (!point.used) continue;
      ++n_used;
      for (int axis = 0; axis < 3; ++axis) {
        const double relative = std::abs(point.left_out_error_m[axis]) / point.left_out_sigma_m[axis];
        if (!std::isfinite(relative)) continue;
        all.push_back(relative);
        if (relative <= worst) continue;
        worst = relative;
        worst_point = &point;
      }
    }
    if (n_used <= kLeastUsed || all.empty()) return false;
    const double usual = std::max(1.0, base::kMadToSigma * base::Median(all));
    if (!(worst > kLimit * usual)) return false;
    worst_point->used = false;
    worst_point->contradicts = true;
    return true;
  }

  void Inflate(ControlAdjustment* result) {
    const double factor = std::isfinite(result->misfit) ? std::max(1.0, result->misfit) : 1.0;
    for (ControlState& point : points_) {
      point.error_sigma_m *= factor;
      point.left_out_sigma_m *= factor;
    }
    for (double* value : {&result->accuracy.scale_percent, &result->accuracy.tilt_deg, &result->accuracy.yaw_deg, &result->accuracy.horizontal_m,
                          &result->accuracy.vertical_m}) {
      *value *= factor;
    }
  }

  ControlBundle& marked_;
  bundle::BundleProblem& bundle_;
  std::vector<ControlState>& points_;
  Vector3d* shift_;
  base::ThreadPool& threads_;
  const std::function<void()>& on_iteration_;
  std::vector<uint32_t> all_ties_, ties_, tracks_;
  std::vector<bundle::KnownPoint> known_;
  double first_mark_sigma_px_ = 0.0;
};

}  // namespace

ControlAdjustment AdjustWithControl(ControlBundle& marked, std::vector<ControlState>& points, Vector3d* shift, base::ThreadPool& threads,
                                    const std::function<void()>& on_iteration) {
  return Adjuster(marked, points, shift, threads, on_iteration).Run();
}

bool AdjustToFeatures(ControlBundle& marked, base::ThreadPool& threads, const std::function<void()>& on_iteration) {
  std::vector<ControlState> no_points;
  return Adjuster(marked, no_points, nullptr, threads, on_iteration).RunByFeatures();
}

bool LeaveOut(const Vector3d& error_m, const Matrix3d& covariance, const Vector3d& own_information, Vector3d* left_out_error_m,
              Matrix3d* left_out_covariance) {
  // The information without the point is that with it less its own, and its own says that the error is zero.
  const Matrix3d others = Matrix3d::Identity() - covariance * own_information.asDiagonal();
  constexpr double kLeastShare = 1e-6;  // of the information that is the others'
  Eigen::MatrixXd right(3, 4), solution;
  right << error_m, covariance;
  if (!linear::SolvePivoted(others, right, kLeastShare, &solution)) return false;
  *left_out_error_m = solution.col(0);
  *left_out_covariance = solution.rightCols<3>();
  return left_out_error_m->allFinite() && (left_out_covariance->diagonal().array() > 0.0).all();
}

void PlaceUnusedPoints(ControlBundle& marked, const std::vector<ControlState>& points, double threshold) {
  for (const ControlState& point : points) {
    if (point.used) continue;
    bundle::TriangulateTrack(marked.bundle, point.track, threshold);
    bundle::RefineByMarks(marked.bundle, point.track);
  }
}

void JudgeUsedMarks(ControlBundle& marked, const std::vector<ControlState>& points, double threshold) {
  bundle::BundleProblem& bundle = marked.bundle;
  for (const ControlState& point : points) {
    if (!point.used) continue;
    const uint32_t t = point.track;
    int n = 0;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      const double error = bundle.Error(e, bundle.point[t]);
      bundle.agrees[e] = error >= 0.0 && error <= threshold ? 1 : 0;
      n += bundle.agrees[e];
    }
    if (n < 2) bundle.has_point[t] = 0;
  }
}

double MisfitOf(const std::vector<ControlState>& points) {
  constexpr int kLeast = 6;
  constexpr double kDetermined = 30.0;  // sigmas of the given coordinate; less accurate, the others hardly say anything
  double squares = 0.0;
  int n = 0;
  for (const ControlState& point : points) {
    if (!point.used) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const double sigma = point.left_out_sigma_m[axis], relative = point.left_out_error_m[axis] / sigma;
      if (!std::isfinite(relative) || sigma > kDetermined * point.sigma_m[axis]) continue;
      squares += relative * relative;
      ++n;
    }
  }
  return n >= kLeast ? std::sqrt(squares / n) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace skyquilt::prepare::control
