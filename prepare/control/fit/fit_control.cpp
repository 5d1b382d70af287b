#include "prepare/control/fit/fit_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/geo/enu_frame.h"
#include "prepare/bundle/adjustment_accuracy.h"
#include "prepare/bundle/entry_term.h"
#include "prepare/bundle/triangulate.h"
#include "prepare/control/fit/control_adjustment.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/fit/control_problems.h"
#include "prepare/control/fit/control_similarity.h"
#include "prepare/control/fit/tag_noise.h"
#include "prepare/control/fit/update_model.h"

namespace skyquilt::prepare::control {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Marks that agree before there is an adjustment, pixels of a photo of 1600 pixels width: right marks of a model that bends a little, but not another
// object.
constexpr double kRoughThreshold = 6.0;

// A height for the conversion of points without: a plausible one moves the others by less than a millimetre.
double UsualHeight(const ControlPoints& control) {
  std::vector<double> heights;
  for (const ControlPoint& point : control.points) {
    if (std::isfinite(point.place.height_m)) heights.push_back(point.place.height_m);
  }
  return heights.empty() ? 0.0 : base::Median(std::move(heights));
}

// The median of the control points, so that a wrong one does not tilt the frame.
geo::Geodetic MiddleOfControl(const ControlPoints& control) {
  geo::Geodetic first{};
  const double height_m = UsualHeight(control);
  std::vector<double> east, north;
  for (const ControlPoint& point : control.points) {
    if (point.check) continue;
    if (east.empty()) first = {point.place.latitude_deg, point.place.longitude_deg, height_m};
    const Vector3d x = geo::EnuFrame(first).EnuFromGeodetic({point.place.latitude_deg, point.place.longitude_deg, height_m});
    east.push_back(x.x());
    north.push_back(x.y());
  }
  geo::Geodetic middle = geo::EnuFrame(first).GeodeticFromEnu({base::Median(east), base::Median(north), 0.0});
  middle.height_m = height_m;
  return middle;
}

std::vector<ControlState> StatesOf(const ControlPoints& control, const ControlBundle& marked, const geo::Geodetic& origin) {
  const geo::EnuFrame frame(origin);
  const double height_m = UsualHeight(control);
  std::vector<ControlState> states;
  for (size_t i = 0; i < control.points.size(); ++i) {
    const ControlPoint& point = control.points[i];
    ControlState state{.as_read = &point, .track = marked.TrackOfPoint(i), .entries = marked.mark[i]};
    geo::Geodetic place = point.place;
    const bool has_height = std::isfinite(place.height_m);
    if (!has_height) place.height_m = height_m;
    state.given = frame.EnuFromGeodetic(place);
    state.sigma_m = {point.horizontal_sigma_m, point.horizontal_sigma_m, point.vertical_sigma_m};
    if (!has_height) {
      state.given.z() = 0.0;
      state.sigma_m.z() = std::numeric_limits<double>::infinity();
    }
    states.push_back(std::move(state));
  }
  return states;
}

class Fitter {
 public:
  Fitter(const ControlJob& job, base::ThreadPool& threads) : job_(job), threads_(threads), marked_(MakeControlBundle(job)), bundle_(marked_.bundle) {}

  PlacedByControl Run() {
    for (size_t i = 0; i < job_.control.points.size(); ++i) {
      bundle::TriangulateTrack(bundle_, marked_.TrackOfPoint(i), kRoughThreshold);
      bundle::RefineByMarks(bundle_, marked_.TrackOfPoint(i));
    }
    const bool any_control =
        std::any_of(job_.control.points.begin(), job_.control.points.end(), [](const ControlPoint& point) { return !point.check; });
    if (job_.otherwise && (job_.otherwise->exact || !any_control)) return Compare();
    if (!any_control) Refuse(WhyNoControl(SimilarityFailure::kTooFew, {}));
    const geo::Geodetic origin = MiddleOfControl(job_.control);
    states_ = StatesOf(job_.control, marked_, origin);
    std::vector<ControlPair> pairs;
    std::vector<ControlState*> of_pair;
    for (ControlState& state : states_) {
      if (state.as_read->check || bundle_.has_point[state.track] == 0) continue;
      pairs.push_back(PairOf(state));
      of_pair.push_back(&state);
    }
    const ControlSimilarity similarity = FitControlSimilarity(pairs);
    if (similarity.failure != SimilarityFailure::kNone) return WithoutControl(similarity.failure);
    for (size_t k = 0; k < of_pair.size(); ++k) {
      of_pair[k]->used = similarity.agrees[k] != 0;
      of_pair[k]->contradicts = similarity.agrees[k] == 0;
    }
    marked_.Move(similarity.enu_from_model);
    RecoverByMarks();
    const std::vector<bundle::BundlePhoto> photos_before = bundle_.photos;
    PlacedByControl placed;
    placed.origin = origin;
    placed.scale = similarity.enu_from_model.scale;
    const geo::EnuFrame frame(origin);
    ControlAdjustment adjustment;
    NotAdjusted not_adjusted = WhyNotAdjusted();
    if (not_adjusted == NotAdjusted::kNo) {
      Vector3d shift = Vector3d::Zero();
      const bool tagged = job_.use_tags && UseTagScatter(job_.photos, frame, bundle_, &shift);
      base::Progress progress("adjust to control points", kUsualIterations, "iterations");
      adjustment = AdjustWithControl(marked_, states_, tagged ? &shift : nullptr, threads_, [&] { progress.Advance(); });
      progress.Finish();
      if (!adjustment.ok) not_adjusted = NotAdjusted::kNoSolution;
    }
    if (!adjustment.ok) adjustment = BySimilarity(similarity);
    placed.accuracy = adjustment.accuracy;
    UpdateModel(marked_, similarity.enu_from_model, photos_before, not_adjusted == NotAdjusted::kNo, job_.model);
    placed.fit = Report();
    placed.fit.placed = true;
    placed.fit.adjusted = not_adjusted == NotAdjusted::kNo;
    placed.problems = ControlProblems(job_.control, placed.fit, not_adjusted, adjustment.misfit);
    return placed;
  }

 private:
  [[noreturn]] void Refuse(const NoControl& why) const { throw base::InputError(job_.control.file, why.finding, why.advice); }

  // Metres, or units of the model, per pixel: mean over the agreeing marks.
  double GsdOf(const ControlState& state) const {
    const uint32_t t = state.track;
    double sum = 0.0;
    int n = 0;
    for (uint32_t e = bundle_.tracks.first[t]; e < bundle_.tracks.first[t + 1]; ++e) {
      if (bundle_.agrees[e] == 0) continue;
      const bundle::BundlePhoto& photo = bundle_.photos[bundle_.tracks.entries[e].photo];
      const double depth = (photo.cam_from_enu * (bundle_.point[t] - photo.centre)).z();
      sum += depth / bundle_.lenses[static_cast<size_t>(photo.lens)].numbers[0];
      ++n;
    }
    return n > 0 && bundle_.has_point[t] != 0 ? sum / n : kNan;
  }

  // For a point with a place in the model.
  ControlPair PairOf(const ControlState& state) const { return {bundle_.point[state.track], state.given, state.sigma_m, GsdOf(state)}; }

  NotAdjusted WhyNotAdjusted() const {
    if (!marked_.known_lenses) return NotAdjusted::kUnknownLens;
    return marked_.n_ties < kLeastTies ? NotAdjusted::kNoObservations : NotAdjusted::kNo;
  }

  // Three marks of which one is wrong may agree in pairs anywhere; the coordinates tell which two are right. Wrong coordinates do not agree with two
  // marks.
  void RecoverByMarks() {
    for (ControlState& state : states_) {
      const uint32_t t = state.track, first = bundle_.tracks.first[t], last = bundle_.tracks.first[t + 1];
      if (state.as_read->check || state.used || !state.HasHeight() || last - first < 3) continue;
      std::vector<char> agrees(last - first, 0);
      for (uint32_t e = first; e < last; ++e) {
        const double error = bundle_.Error(e, state.given);
        agrees[e - first] = error >= 0.0 && error <= 2.0 * kRoughThreshold ? 1 : 0;
      }
      if (std::count(agrees.begin(), agrees.end(), 1) < 2) continue;
      std::copy(agrees.begin(), agrees.end(), bundle_.agrees.begin() + first);
      bundle_.point[t] = state.given;
      bundle_.has_point[t] = 1;
      state.used = true;
      state.contradicts = false;
    }
  }

  // Errors and accuracies where the similarity is all there is. The refits without a point start anew, for they are cheap.
  ControlAdjustment BySimilarity(const ControlSimilarity& similarity) {
    PlaceUnusedPoints(marked_, states_, kRoughThreshold);
    ControlAdjustment result;
    std::vector<ControlPair> agreeing;
    std::vector<ControlState*> of_pair;
    for (ControlState& state : states_) {
      SetError(state, similarity.CovarianceAt(bundle_.point[state.track]));
      if (!state.used) continue;
      agreeing.push_back(PairOf(state));
      of_pair.push_back(&state);
    }
    for (size_t k = 0; k < agreeing.size(); ++k) {
      std::vector<ControlPair> others = agreeing;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const ControlSimilarity without = FitControlSimilarity(others);
      if (without.failure != SimilarityFailure::kNone) continue;
      ControlState& state = *of_pair[k];
      const Vector3d x = without.enu_from_model * agreeing[k].in_model;
      state.left_out_error_m = x - state.given;
      const auto of_marks = bundle::CovarianceByMarks(bundle_, state.track);
      const Matrix3d covariance = without.CovarianceAt(x) + (of_marks ? *of_marks : Matrix3d::Zero());
      state.left_out_sigma_m = (covariance.diagonal() + state.sigma_m.cwiseAbs2()).cwiseSqrt();
      if (!state.HasHeight()) state.left_out_error_m.z() = state.left_out_sigma_m.z() = kNan;
    }
    result.misfit = MisfitOf(states_);
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const auto& covariance = similarity.covariance;
    result.accuracy = {.scale_percent = 100.0 * std::sqrt(covariance(6, 6)),
                       .tilt_deg = kDegrees * std::sqrt(covariance(3, 3) + covariance(4, 4)),
                       .yaw_deg = kDegrees * std::sqrt(covariance(5, 5)),
                       .horizontal_m = std::sqrt(covariance(0, 0) + covariance(1, 1)),
                       .vertical_m = std::sqrt(covariance(2, 2))};
    return result;
  }

  // Of an estimate that the point's own coordinates hardly influence; `place` is the covariance of the frame there.
  void SetError(ControlState& state, const Matrix3d& place) {
    if (bundle_.has_point[state.track] == 0) return;
    state.error_m = bundle_.point[state.track] - state.given;
    if (const auto of_marks = bundle::CovarianceByMarks(bundle_, state.track)) {
      state.error_sigma_m = ((place + *of_marks).diagonal() + state.sigma_m.cwiseAbs2()).cwiseSqrt();
    }
    if (!state.HasHeight()) state.error_m.z() = state.error_sigma_m.z() = kNan;
  }

  // The place is known without control points: what they say of it.
  PlacedByControl Compare() {
    const PlaceWithoutControl& place = *job_.otherwise;
    states_ = StatesOf(job_.control, marked_, place.origin);
    marked_.Move(place.enu_from_model);
    Vector3d middle = Vector3d::Zero();
    for (const bundle::BundlePhoto& photo : bundle_.photos) middle += photo.centre / static_cast<double>(bundle_.photos.size());
    const geo::PlaceAccuracy& accuracy = place.accuracy;
    const auto square = [](double sigma) { return std::isfinite(sigma) ? sigma * sigma : 0.0; };
    constexpr double kRadians = std::numbers::pi / 180.0;
    // As the accuracies count axes: both of horizontal position and of tilt together.
    Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
    covariance(0, 0) = covariance(1, 1) = 0.5 * square(accuracy.horizontal_m);
    covariance(2, 2) = square(accuracy.vertical_m);
    covariance(3, 3) = covariance(4, 4) = 0.5 * square(kRadians * accuracy.tilt_deg);
    covariance(5, 5) = square(kRadians * accuracy.yaw_deg);
    covariance(6, 6) = square(0.01 * accuracy.scale_percent);
    for (ControlState& state : states_) {
      const Eigen::Matrix<double, 3, 7> jacobian = bundle::SimilarityJacobian(bundle_.point[state.track] - middle);
      SetError(state, jacobian * covariance * jacobian.transpose());
    }
    PlacedByControl compared;
    compared.origin = place.origin;
    compared.accuracy = accuracy;
    compared.fit = Report();
    compared.problems = ControlProblems(job_.control, compared.fit, NotAdjusted::kNo, kNan);
    return compared;
  }

  PlacedByControl WithoutControl(SimilarityFailure failure) {
    std::vector<std::string> usable;
    for (const ControlState& state : states_) {
      if (!state.as_read->check && state.HasHeight() && bundle_.has_point[state.track] != 0) usable.push_back(state.as_read->label);
    }
    const NoControl why = WhyNoControl(failure, usable);
    if (!job_.otherwise) Refuse(why);
    PlacedByControl compared = Compare();
    survey::Problem problem{failure == SimilarityFailure::kOnLine ? "control_on_line" : "control_too_few",
                            "The place comes from GPS tags, because " + why.finding, why.advice + " (" + job_.control.file + ")", true};
    compared.problems.insert(compared.problems.begin(), std::move(problem));
    return compared;
  }

  survey::ControlUse UseOf(const ControlState& state) const {
    if (bundle_.has_point[state.track] == 0) return survey::ControlUse::kUnseen;
    if (state.used) return survey::ControlUse::kControl;
    return state.contradicts ? survey::ControlUse::kRejected : survey::ControlUse::kCheck;
  }

  survey::ControlFit Report() const {
    survey::ControlFit fit;
    fit.file = job_.control.file;
    fit.crs = job_.control.crs;
    fit.heights = job_.control.heights;
    for (const ControlState& state : states_) {
      survey::ControlPointFit point;
      point.label = state.as_read->label;
      point.use = UseOf(state);
      point.given_in_enu = state.given;
      point.given_sigma_m = {state.sigma_m.x(), state.HasHeight() ? state.sigma_m.z() : kNan};
      if (!state.HasHeight()) point.given_in_enu.z() = kNan;
      const bool seen = point.use != survey::ControlUse::kUnseen;
      if (seen) {
        point.error_m = state.error_m;
        point.sigma_m = state.error_sigma_m;
        point.gsd_m = GsdOf(state);
      }
      if (point.use == survey::ControlUse::kControl) point.left_out_error_m = state.left_out_error_m;
      double squares = 0.0;
      int n = 0;
      for (size_t k = 0; k < state.entries.size(); ++k) {
        survey::ControlMarkFit mark;
        mark.photo = state.as_read->marks[k].photo;
        mark.pixel = state.as_read->marks[k].pixel;
        if (const auto entry = state.entries[k]; entry && seen) {
          const double error = bundle_.Error(*entry, bundle_.point[state.track]);
          if (error >= 0.0)
            mark.error_px = error * bundle_.lenses[static_cast<size_t>(bundle_.photos[bundle_.tracks.entries[*entry].photo].lens)].unit_px;
          mark.used = error >= 0.0 && bundle_.agrees[*entry] != 0;
        }
        if (mark.used) {
          squares += mark.error_px * mark.error_px;
          ++n;
        }
        point.marks.push_back(std::move(mark));
      }
      if (n > 0) point.error_px = std::sqrt(squares / n);
      fit.points.push_back(std::move(point));
    }
    return fit;
  }

  const ControlJob& job_;
  base::ThreadPool& threads_;
  ControlBundle marked_;
  bundle::BundleProblem& bundle_;
  std::vector<ControlState> states_;
};

}  // namespace

PlacedByControl FitControl(const ControlJob& job, base::ThreadPool& threads) {
  return Fitter(job, threads).Run();
}

}  // namespace skyquilt::prepare::control
