#include "buildings/fit/fit_shape.h"

#include <algorithm>
#include <cmath>

#include "buildings/fit/fit_parameters.h"
#include "buildings/fit/fit_points.h"
#include "buildings/fit/ground_level.h"
#include "buildings/fit/observations.h"
#include "buildings/fit/roof_groups.h"
#include "buildings/fit/solve.h"
#include "buildings/fit/wall_groups.h"
#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr int kRounds = 8;        // of choosing points and solving
constexpr int kCoarseRounds = 3;  // with wide windows
constexpr double kSettled_m = 1e-3;
constexpr double kTurn_m = 5.0;       // what a change of yaw moves is judged at this distance
constexpr double kNarrowest_m = 0.3;  // between neighbouring lines
constexpr size_t kLeastRoofPoints = 8;
constexpr double kUsualOverhang_m = 0.3;  // where rims are looked for first

// Where walls were seen, they tell the overhang, and an assumed one nothing.
constexpr double kFreeOverhang_m = 1.0;

// What the first guess is worth; holds parameters that no points tell about.
constexpr double kGuessedLine_m = 1.5, kGuessedHeight_m = 1.5, kGuessedYaw = 0.1;

// Errors that whole surfaces have (from towns simulated with other seeds than those on which accuracy is reported): a part in GSD that is always
// there, and a share of the scatter of their points, since a blurred field is also biased.
struct Common {
  double gsd, share;
};
constexpr Common kRoofCommon{0.3, 0.6}, kWallCommon{0.55, 0.5}, kRimCommon{0.3, 0.4}, kFlatRimCommon{0.45, 0.4};
constexpr Common kEndCommon{1.3, 0.0};   // rims by counting points
constexpr double kSmallRoof_gsd2 = 6.0;  // over the square root of its area
constexpr double kFlatRim_gsd = 0.3;     // that all rims of a flat roof have in common
constexpr double kLeastNoise_gsd = 0.25;

Group Prior(int parameter, double value, double sigma) {
  Observation o;
  o.kind = ObservationKind::kPrior;
  o.parameter = parameter;
  o.value = value;
  Group group;
  group.observations.push_back(o);
  group.sigma_m = sigma;
  return group;
}

class Fitter {
 public:
  Fitter(const Shape& guess, const Candidate& candidate, const PointCloud& cloud, const FitOptions& options)
      : guess_(guess),
        options_(options),
        points_(PointsFor(guess, candidate, cloud)),
        parameters_(guess),
        shape_(guess),
        values_(parameters_.Of(guess)) {
    overhang_ = std::max(kUsualOverhang_m, options.default_overhang_m);
    SetLevels(points_, options.gsd_m, &shape_);
    values_ = parameters_.Of(shape_);
    values_[parameters_.overhang(true)] = overhang_;
  }

  FittedShape Fit() {
    FittedShape fitted;
    fitted.converged = points_.roof.size() >= kLeastRoofPoints;
    if (fitted.converged) fitted.converged = Iterate();
    if (!fitted.converged) ChooseGroups(kRounds);
    fitted.shape = shape_;
    Describe(&fitted);
    return fitted;
  }

 private:
  bool Iterate() {
    for (int round = 0; round < kRounds; ++round) {
      ChooseGroups(round);
      Eigen::VectorXd values = values_;
      if (!Solve(all_, parameters_, &values) || !IsOrdered(values)) return false;
      Eigen::VectorXd change = (values - values_).cwiseAbs();
      change[parameters_.yaw()] *= kTurn_m;
      values_ = values;
      parameters_.Set(values_, &shape_);
      if (walls_pitched_) overhang_ = std::clamp(values_[parameters_.overhang(true)], 0.0, 2.0);
      if (round >= kCoarseRounds && change.maxCoeff() < kSettled_m) break;
    }
    ChooseGroups(kRounds);
    return true;
  }

  bool IsOrdered(const Eigen::VectorXd& values) const {
    for (const int axis : {0, 1}) {
      const auto n = static_cast<int>((axis == 0 ? guess_.u : guess_.v).size());
      for (int i = 0; i + 1 < n; ++i) {
        if (values[parameters_.line(axis, i + 1)] - values[parameters_.line(axis, i)] < kNarrowest_m) return false;
      }
    }
    return true;
  }

  // The points that the present shape explains, and the weights that they deserve.
  void ChooseGroups(int round) {
    const double gsd = options_.gsd_m;
    const double window = round < kCoarseRounds ? std::max(1.2, 5.0 * gsd) * std::pow(0.8, round) : std::max(0.6, 3.0 * gsd);
    roofs_ = RoofGroups(points_, shape_, {gsd, overhang_, window});
    walls_ = WallGroups(points_, shape_, parameters_, {gsd, overhang_, window});
    edges_ = EdgeGroups(points_, shape_, parameters_, {gsd, overhang_, window});
    walls_pitched_ = false;
    for (Group& group : roofs_) {
      Weigh(kRoofCommon, kLeastNoise_gsd, &group);
      group.common_m = std::hypot(group.common_m, kSmallRoof_gsd2 * gsd * gsd / std::sqrt(group.area_m2));
    }
    for (Group& group : walls_) {
      Weigh(kWallCommon, 2.0 * kLeastNoise_gsd, &group);
      walls_pitched_ = walls_pitched_ || IsPitched(PartOf(group));
    }
    for (Group& group : edges_) {
      const bool counted = !(group.area_m2 > 0.0);
      Weigh(counted ? kEndCommon : IsPitched(PartOf(group)) ? kRimCommon : kFlatRimCommon, counted ? 1.0 : kLeastNoise_gsd, &group);
    }
    all_ = Priors();
    for (const std::vector<Group>* list : {&roofs_, &walls_, &edges_}) all_.insert(all_.end(), list->begin(), list->end());
  }
  const Part& PartOf(const Group& group) const { return shape_.parts[static_cast<size_t>(group.observations.front().part)]; }
  void Weigh(const Common& common, double least_gsd, Group* group) const {
    EstimateNoise(parameters_, values_, least_gsd * options_.gsd_m, group);
    group->common_m = std::hypot(common.gsd * options_.gsd_m, common.share * group->sigma_m);
  }

  std::vector<Group> Priors() const {
    std::vector<Group> priors;
    const Eigen::VectorXd guess = parameters_.Of(guess_);
    const int first_height = parameters_.line(1, static_cast<int>(guess_.v.size()));
    priors.push_back(Prior(parameters_.yaw(), guess[parameters_.yaw()], kGuessedYaw));
    for (int i = 1; i < first_height; ++i) priors.push_back(Prior(i, guess[i], kGuessedLine_m));
    for (int i = first_height; i < parameters_.shape_size(); ++i) priors.push_back(Prior(i, values_[i], kGuessedHeight_m));
    const double sigma = walls_pitched_ ? kFreeOverhang_m : options_.overhang_sigma_m;
    priors.push_back(Prior(parameters_.overhang(true), options_.default_overhang_m, sigma));
    priors.push_back(Prior(parameters_.overhang(false), 0.0, kFlatRim_gsd * options_.gsd_m));
    return priors;
  }

  void Describe(FittedShape* fitted) const {
    const double gsd = options_.gsd_m;
    fitted->u_seen.assign(guess_.u.size(), false);
    fitted->v_seen.assign(guess_.v.size(), false);
    for (const Group& group : walls_) MarkSeen(group, fitted);
    for (const Group& group : edges_) {
      if (group.area_m2 > 0.0 && !IsPitched(PartOf(group))) MarkSeen(group, fitted);
    }
    for (const Group& group : roofs_) fitted->roof_points += static_cast<int64_t>(group.observations.size());
    for (const Group& group : walls_) fitted->wall_points += static_cast<int64_t>(group.observations.size());
    fitted->overhang_m = MeasuredOverhang(*fitted);
    const RoofAgreement agreement = AgreementOf(points_, shape_, overhang_, 2.0 * gsd);
    fitted->share_within = agreement.share_within;
    fitted->residual_m = agreement.residual_m;

    const Eigen::Vector2d low(shape_.u.front(), shape_.v.front()), high(shape_.u.back(), shape_.v.back());
    const Eigen::Vector2d middle = shape_.EnuFrom(0.5 * (low + high)) - shape_.origin;
    const Measure ground = GroundLevel(points_.ground, middle, gsd, points_.spacing_m);
    if (std::isfinite(ground.value)) fitted->shape.ground_z = ground.value;
    const int n = parameters_.shape_size();
    fitted->covariance = Eigen::MatrixXd::Zero(n + 1, n + 1);
    fitted->covariance.topLeftCorner(n, n) = CovarianceOf(all_, parameters_, values_).topLeftCorner(n, n);
    fitted->covariance(n, n) = std::isfinite(ground.sigma) ? ground.sigma * ground.sigma : kGuessedHeight_m * kGuessedHeight_m;
  }

  static void MarkSeen(const Group& group, FittedShape* fitted) {
    const Observation& o = group.observations.front();
    (o.axis == 0 ? fitted->u_seen : fitted->v_seen)[static_cast<size_t>(o.line)] = true;
  }

  double MeasuredOverhang(const FittedShape& fitted) const {
    std::vector<double> distances;
    for (const Group& group : edges_) {
      const Observation& o = group.observations.front();
      if (!IsPitched(PartOf(group)) || !(o.axis == 0 ? fitted.u_seen : fitted.v_seen)[static_cast<size_t>(o.line)]) continue;
      for (const Observation& one : group.observations) {
        distances.push_back(Residual(one, parameters_, values_.data(), nullptr) + values_[one.parameter]);
      }
    }
    return distances.empty() ? kUnknown : base::Median(std::move(distances));
  }

  const Shape& guess_;
  const FitOptions& options_;
  FitPoints points_;
  Parameters parameters_;
  Shape shape_;
  Eigen::VectorXd values_;
  double overhang_ = 0.0;  // where rims are looked for
  bool walls_pitched_ = false;
  std::vector<Group> roofs_, walls_, edges_, all_;
};

}  // namespace

FittedShape FitShape(const Shape& guess, const Candidate& candidate, const PointCloud& cloud, const FitOptions& options) {
  return Fitter(guess, candidate, cloud, options).Fit();
}

}  // namespace skyquilt::buildings
