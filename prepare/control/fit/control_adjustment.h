// Bundle adjustment with control points, the search for wrong points and marks in it, and the accuracy of its result.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/place_accuracy.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {

// A control or check point while the survey is fitted to it.
struct ControlState {
  const ControlPoint* as_read = nullptr;              // must outlive this
  uint32_t track = 0;                                 // its own in the bundle
  std::vector<std::optional<uint32_t>> entries;       // of its marks, see ControlBundle::mark
  Eigen::Vector3d given = Eigen::Vector3d::Zero();    // ENU metres; z is 0 without a height
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Ones();  // infinite z: no height
  bool used = false;                                  // determines the result
  bool contradicts = false;                           // a control point that is not used because the others say that it is wrong
  // Results; NaN: unknown.
  Eigen::Vector3d error_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  // estimated less given
  Eigen::Vector3d error_sigma_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d left_out_error_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d left_out_sigma_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

  bool HasHeight() const { return std::isfinite(sigma_m.z()); }
  bundle::KnownPoint Known() const { return {track, given, sigma_m}; }
};

struct ControlAdjustment {
  bool ok = false;  // false: no solution; the bundle and the states are those from before
  geo::PlaceAccuracy accuracy;
  // How far control points that are left out miss, over the accuracy of that; 1 as expected. Where it is larger, the accuracies have been multiplied
  // by it.
  double misfit = std::numeric_limits<double>::quiet_NaN();
};

// The bundle is in ENU about where it belongs, and used points have a place and agreeing marks. Points that then contradict the others lose `used`.
// `shift`: see UseTagScatter; null without tags. Entries of marks agree afterwards where they are used, and points of the model have been placed
// anew. Points without two marks that agree have no place (BundleProblem::has_point). `on_iteration` is called after each iteration of a bundle
// adjustment, of which there are seldom more than kUsualIterations. Throws base::Interrupted.
ControlAdjustment AdjustWithControl(ControlBundle& marked, std::vector<ControlState>& points, Eigen::Vector3d* shift, base::ThreadPool& threads,
                                    const std::function<void()>& on_iteration);
constexpr int kUsualIterations = 60;

// The same to the features alone, of a bundle without control points. Only positions of photos (BundlePhoto::gps) hold its frame. False: no solution;
// the bundle is as before. Else the features' accuracy has been measured (ControlBundle::tie_sigma), points of the model have been placed anew, and
// those that their photos do not agree about have no place.
bool AdjustToFeatures(ControlBundle& marked, base::ThreadPool& threads, const std::function<void()>& on_iteration);
// Sigmas of a feature's error that is no outlier.
constexpr double kTieThreshold = 5.0;

// What the others say of a point of the adjustment, from its error, its covariance in the adjustment and the information that its own place gave
// (the inverse of its variances): error and covariance of the estimate without it. False when the others do not determine it.
bool LeaveOut(const Eigen::Vector3d& error_m, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& own_information,
              Eigen::Vector3d* left_out_error_m, Eigen::Matrix3d* left_out_covariance);

// Places the points that are not used anew by their marks.
void PlaceUnusedPoints(ControlBundle& marked, const std::vector<ControlState>& points, double threshold);
// Marks of used points agree when they are within the threshold (units of lenses) of the point's place.
void JudgeUsedMarks(ControlBundle& marked, const std::vector<ControlState>& points, double threshold);
// The root mean square of the left-out errors over their accuracies, of the axes that the others determine; NaN for fewer than six of them.
double MisfitOf(const std::vector<ControlState>& points);

}  // namespace skyquilt::prepare::control
