// The least-squares problem over groups of observations (Ceres), and the covariance of its solution.
#pragma once

#include <Eigen/Core>
#include <span>

#include "buildings/fit/fit_parameters.h"
#include "buildings/fit/observations.h"

namespace skyquilt::buildings {

// Sets sigma_m, scale_m and n_eff of a group from its residuals at these values. least_m: of sigma_m.
void EstimateNoise(const Parameters& parameters, const Eigen::VectorXd& values, double least_m, Group* group);

// Improves the values; false when there is no usable solution, and then they stay.
bool Solve(std::span<const Group> groups, const Parameters& parameters, Eigen::VectorXd* values);

// Of all parameters at the solution. With observations of weight w, Cauchy loss and Jacobian J: H = sum w E[psi'] J^T J, and H^-1 M H^-1 with
// M = sum w^2 E[psi^2] n / n_eff J^T J + (error that a group has in common)^2 b b^T, b = sum w E[psi'] J (Huber 1981, section 7.6).
Eigen::MatrixXd CovarianceOf(std::span<const Group> groups, const Parameters& parameters, const Eigen::VectorXd& values);

}  // namespace skyquilt::buildings
