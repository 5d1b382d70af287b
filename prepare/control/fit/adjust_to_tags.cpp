#include "prepare/control/fit/adjust_to_tags.h"

#include <algorithm>

#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/geo/enu_frame.h"
#include "prepare/control/fit/control_adjustment.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/fit/fit_control.h"
#include "prepare/control/fit/tag_noise.h"
#include "prepare/control/fit/update_model.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {
namespace {

// The first one straightens the bend that the scatter of the tags contains, the next ones count them as what they are.
constexpr int kRounds = 3;
// Photos that move by at most this many standard deviations of their tags have arrived.
constexpr double kArrived = 1.0;
// Features that fit that much worse contradict the tags.
constexpr double kMostError = 1.1;

double MedianError(const ControlBundle& marked) {
  const bundle::BundleProblem& bundle = marked.bundle;
  std::vector<double> errors;
  for (uint32_t t = 0; t < marked.n_ties; ++t) {
    if (bundle.has_point[t] == 0) continue;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      const double error = bundle.Error(e, bundle.point[t]);
      // Counted in the features' accuracy; outliers too.
      if (error >= 0.0) errors.push_back(error * marked.tie_sigma);
    }
  }
  return errors.empty() ? 0.0 : base::UpperMedian(errors);
}

// The farthest that a photo with a tag has moved, in standard deviations of its tag.
double Moved(const std::vector<bundle::BundlePhoto>& before, const std::vector<bundle::BundlePhoto>& after) {
  double farthest = 0.0;
  for (size_t i = 0; i < after.size(); ++i) {
    if (after[i].gps) farthest = std::max(farthest, (after[i].centre - before[i].centre).cwiseQuotient(after[i].gps_sigma).norm());
  }
  return farthest;
}

}  // namespace

AdjustedToTags AdjustToTags(const TagJob& job, base::ThreadPool& threads) {
  AdjustedToTags result;
  const ControlPoints no_points;
  ControlBundle marked = MakeControlBundle({.model = job.model, .observations = job.observations, .photos = job.photos, .control = no_points});
  if (!marked.known_lenses) {
    result.reason = "the camera model has coefficients that the adjustment does not know";
    return result;
  }
  if (marked.n_ties < kLeastTies) {
    result.reason = "the model has too few points with observations";
    return result;
  }
  for (bundle::BundleLens& lens : marked.bundle.lenses) lens.hold_focal = job.hold_focal;
  marked.Move(job.enu_from_model);
  const std::vector<bundle::BundlePhoto> photos_before = marked.bundle.photos;
  result.error_before = MedianError(marked);
  const geo::EnuFrame frame(job.origin);
  std::vector<ControlState> no_states;
  base::Progress progress("adjust to tags", kRounds * kUsualIterations, "iterations");
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector3d shift;
    if (!UseTagScatter(job.photos, frame, marked.bundle, &shift)) {
      result.reason = "too few GPS tags";
      return result;
    }
    // Without control points nothing else holds the frame.
    for (bundle::BundlePhoto& photo : marked.bundle.photos) {
      if (photo.gps) *photo.gps += shift;
    }
    const std::vector<bundle::BundlePhoto> photos_then = marked.bundle.photos;
    if (!AdjustWithControl(marked, no_states, nullptr, threads, [&] { progress.Advance(); }).ok) {
      result.reason = "the adjustment found no solution";
      return result;
    }
    if (Moved(photos_then, marked.bundle.photos) < kArrived) break;
  }
  progress.Finish();
  result.error_after = MedianError(marked);
  if (result.error_after > kMostError * result.error_before) {
    result.reason = "the photos contradict them";
    return result;
  }
  UpdateModel(marked, job.enu_from_model, photos_before, true, job.model);
  result.adjusted = true;
  return result;
}

}  // namespace skyquilt::prepare::control
