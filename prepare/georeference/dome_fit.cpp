#include "prepare/georeference/dome_fit.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHuber = 1.345;  // 95 % efficient for normal errors
constexpr int kMaxRounds = 50;
constexpr double kEdgeShare = 0.95;
constexpr double kMinBreadth = 0.1;  // of the positions' length
// What 1, x and y leave of r^2 must be this share of its size at the edge, as standard deviation. A full square of photos has 0.3.
constexpr double kMinCurvature = 0.02;
constexpr Index kUnknowns = 4;

bool CoverAnArea(const Eigen::Matrix2Xd& centred) {
  const linear::EigenPairs<2> eigen = linear::SymmetricEigen<2>(centred * centred.transpose());
  // Eigenvalues are squares of singular values.
  const Eigen::Vector2d& squares = eigen.values;
  return eigen.found && squares[1] > 0.0 && squares[0] > kMinBreadth * kMinBreadth * squares[1];
}

double MadScale(const VectorXd& residual) {
  const VectorXd size = residual.cwiseAbs();
  return base::kMadToSigma * base::Median({size.begin(), size.end()});
}

// How many times the variance of a mean of neighbours exceeds that of independent values: 1 + 2 (r_1 + r_2 + ...) with the autocorrelations up to the
// first that is not positive (Geyer's initial sequence). For values that forget exponentially it is (1 + r_1) / (1 - r_1).
double CorrelationFactor(const VectorXd& values) {
  const VectorXd centred = values.array() - values.mean();
  const double power = centred.squaredNorm();
  if (!(power > 0.0)) return 1.0;
  double factor = 1.0;
  for (Index lag = 1; lag < centred.size() / 4; ++lag) {
    const double correlation = centred.head(centred.size() - lag).dot(centred.tail(centred.size() - lag)) / power;
    if (!(correlation > 0.0)) break;
    factor += 2.0 * correlation;
  }
  return factor;
}

}  // namespace

Dome FitDome(const std::vector<HeightDifference>& differences) {
  std::vector<HeightDifference> known;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(known),
               [](const HeightDifference& d) { return d.position_m.allFinite() && std::isfinite(d.up_m); });
  const auto n = static_cast<Index>(known.size());
  if (n < kMinDomeTags) return {};
  Eigen::Matrix2Xd centred(2, n);
  VectorXd up(n);
  for (Index i = 0; i < n; ++i) {
    centred.col(i) = known[static_cast<size_t>(i)].position_m;
    up[i] = known[static_cast<size_t>(i)].up_m;
  }
  centred.colwise() -= Eigen::Vector2d(centred.rowwise().mean());
  if (!CoverAnArea(centred)) return {};
  const VectorXd radius = centred.colwise().norm();
  const double edge_m = base::Quantile({radius.begin(), radius.end()}, kEdgeShare);
  if (!(edge_m > 0.0) || !std::isfinite(edge_m)) return {};

  // In units of the edge's distance the coefficient of r^2 is the height of the edge above the middle.
  MatrixXd design(n, kUnknowns);
  design.col(0).setOnes();
  design.middleCols(1, 2) = centred.transpose() / edge_m;
  design.col(3) = (radius / edge_m).cwiseAbs2();
  const MatrixXd plane = design.leftCols(3);
  const VectorXd curvature = design.col(3) - plane * linear::SolveLeastSquares(plane, design.col(3));
  if (curvature.norm() < kMinCurvature * std::sqrt(static_cast<double>(n))) return {};

  VectorXd solution = linear::SolveLeastSquares(design, up);
  VectorXd residual = up - design * solution;
  double scale = MadScale(residual);
  // Residuals of rounding size: an exact fit, where weights mean nothing.
  const double rounding = 1e-12 * (1.0 + up.cwiseAbs().maxCoeff());
  for (int round = 0; round < kMaxRounds && scale > rounding; ++round) {
    const VectorXd root_weight = (kHuber * scale * residual.cwiseAbs().cwiseMax(rounding).cwiseInverse()).cwiseMin(1.0).cwiseSqrt();
    const VectorXd next = linear::SolveLeastSquares(root_weight.asDiagonal() * design, root_weight.cwiseProduct(up));
    const double change = (next - solution).cwiseAbs().maxCoeff();
    solution = next;
    residual = up - design * solution;
    scale = MadScale(residual);
    if (change < 1e-9 * scale) break;
  }
  // Huber, Robust Statistics, 1981, equation 6.5: the residuals are cut where their weight is below 1.
  const double limit = std::max(kHuber * scale, rounding);
  const VectorXd cut = residual.cwiseMax(-limit).cwiseMin(limit);
  const double share_uncut = static_cast<double>((residual.cwiseAbs().array() <= limit).count()) / static_cast<double>(n);
  const double variance = cut.squaredNorm() / static_cast<double>(n - kUnknowns) / (share_uncut * share_uncut);
  const MatrixXd normal_inverse = linear::Inverse<Eigen::Dynamic>(design.transpose() * design);
  const double sigma = std::sqrt(variance * normal_inverse(3, 3) * CorrelationFactor(cut));
  if (!std::isfinite(solution[3]) || !std::isfinite(sigma)) return {};
  return {-solution[3], sigma};
}

}  // namespace skyquilt::prepare::georeference
