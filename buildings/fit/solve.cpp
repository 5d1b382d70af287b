#include "buildings/fit/solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "buildings/fit/correlation.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastSlope = 0.2;  // of the mean derivative of the loss, so that a group of outliers does not weigh negatively

// All parameters are one block: a shape has some twenty, and each residual depends on a few of them.
class ObservationCost : public ceres::CostFunction {
 public:
  ObservationCost(const Observation& observation, const Parameters& parameters, double factor)
      : observation_(observation), parameters_(parameters), factor_(factor) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(parameters.size());
  }
  bool Evaluate(double const* const* values, double* residuals, double** jacobians) const override {
    double* gradient = jacobians != nullptr ? jacobians[0] : nullptr;
    residuals[0] = factor_ * Residual(observation_, parameters_, values[0], gradient);
    if (gradient != nullptr) std::transform(gradient, gradient + parameters_.size(), gradient, [this](double g) { return factor_ * g; });
    return std::isfinite(residuals[0]);
  }

 private:
  const Observation& observation_;
  const Parameters& parameters_;
  double factor_;
};

std::vector<double> ResidualsOf(const Group& group, const Parameters& parameters, const Eigen::VectorXd& values) {
  std::vector<double> residuals;
  residuals.reserve(group.observations.size());
  for (const Observation& o : group.observations) residuals.push_back(Residual(o, parameters, values.data(), nullptr));
  return residuals;
}

}  // namespace

void EstimateNoise(const Parameters& parameters, const Eigen::VectorXd& values, double least_m, Group* group) {
  std::vector<double> residuals = ResidualsOf(*group, parameters, values);
  if (residuals.empty()) return;
  const double middle = base::Median(residuals);
  group->sigma_m = std::max(least_m, base::Nmad(residuals));
  group->scale_m = 2.0 * group->sigma_m;
  const auto n = static_cast<double>(residuals.size());
  if (!(group->area_m2 > 0.0)) {
    group->n_eff = n;
    return;
  }
  // As the loss sees them: far outliers would hide the correlation.
  for (double& r : residuals) r = std::clamp(r - middle, -group->scale_m, group->scale_m);
  group->n_eff = std::clamp(group->area_m2 / CorrelationArea(group->at, residuals, group->area_m2), 1.0, n);
}

bool Solve(std::span<const Group> groups, const Parameters& parameters, Eigen::VectorXd* values) {
  // Ceres would write to the log.
  for (const Group& group : groups) {
    for (const double r : ResidualsOf(group, parameters, *values)) {
      if (!std::isfinite(r)) return false;
    }
  }
  Eigen::VectorXd solution = *values;
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddParameterBlock(solution.data(), parameters.size());
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;
  for (const Group& group : groups) {
    const double weight = group.Weight();
    ceres::LossFunction* loss = nullptr;
    if (group.scale_m > 0.0) {
      losses.push_back(std::make_unique<ceres::CauchyLoss>(group.scale_m * std::sqrt(weight)));
      loss = losses.back().get();
    }
    for (const Observation& o : group.observations) {
      problem.AddResidualBlock(new ObservationCost(o, parameters, std::sqrt(weight * o.trust)), loss, solution.data());
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 30;
  options.num_threads = 1;  // buildings are fitted in parallel, and sums keep their order
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable() || !solution.allFinite()) return false;
  *values = solution;
  return true;
}

Eigen::MatrixXd CovarianceOf(std::span<const Group> groups, const Parameters& parameters, const Eigen::VectorXd& values) {
  const int size = parameters.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size), scatter = information;
  Eigen::VectorXd gradient(size);
  for (const Group& group : groups) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(size);
    double slope = 0.0, square = 0.0;
    for (const Observation& o : group.observations) {
      const double r = Residual(o, parameters, values.data(), gradient.data());
      const double t = group.scale_m > 0.0 ? o.trust * r * r / (group.scale_m * group.scale_m) : 0.0;
      slope += (1.0 - t) / ((1.0 + t) * (1.0 + t));
      square += o.trust * r * r / ((1.0 + t) * (1.0 + t));
      products += o.trust * gradient * gradient.transpose();
      shift += o.trust * gradient;
    }
    const auto n = static_cast<double>(group.observations.size());
    if (!(n > 0.0)) continue;
    slope = std::max(slope / n, kLeastSlope);
    // Of one observation of full trust; few points tell little about their own scatter.
    square = std::max(square / n, group.scale_m > 0.0 ? 0.5 * group.sigma_m * group.sigma_m : group.sigma_m * group.sigma_m);
    const double weight = group.Weight();
    information += weight * slope * products;
    scatter += weight * weight * square * n / std::max(group.n_eff, 1.0) * products;
    scatter += weight * weight * slope * slope * group.common_m * group.common_m * shift * shift.transpose();
  }
  const Eigen::MatrixXd inverse = linear::SolveSymmetric(information, Eigen::MatrixXd::Identity(size, size));
  const Eigen::MatrixXd covariance = inverse * scatter * inverse.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace skyquilt::buildings
