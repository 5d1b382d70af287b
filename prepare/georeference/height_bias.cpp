#include "prepare/georeference/height_bias.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/bundle/robust.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Index;

constexpr Index kMaxKnots = 12;
constexpr Index kTagsPerKnot = 8;
constexpr double kSmallestSigma_m = 1e-4;
// No tags are better than this, even if they fit better by chance.
constexpr double kLeastHeightNoise_m = 0.02;
// A larger hypothesis must be this much more likely (natural logarithm) per quantity that it enlarges.
constexpr double kPenalty = 3.0;
constexpr int kBiasRounds = 12;

double ScaleOf(const Eigen::VectorXd& residual, const Eigen::VectorXd& sigma) {
  std::vector<double> sizes;
  for (Index k = 0; k < residual.size(); ++k) {
    if (std::isfinite(sigma[k])) sizes.push_back(std::abs(residual[k]) / sigma[k]);
  }
  return sizes.empty() ? 1.0 : base::kMadToSigma * base::Median(sizes);
}

// The noise by differences of neighbours in time, less their median, which is the drift: no curve can follow it. Over the relative accuracy, like
// ScaleOf.
double LocalScale(const HeightObservations& observations) {
  std::vector<double> steps;
  Index last = -1;
  for (Index k = 0; k < observations.sigma.size(); ++k) {
    if (!std::isfinite(observations.sigma[k])) continue;
    if (last >= 0) {
      steps.push_back((observations.height_m[k] - observations.height_m[last]) / std::hypot(observations.sigma[k], observations.sigma[last]));
    }
    last = k;
  }
  if (steps.empty()) return 0.0;
  return base::Nmad(std::move(steps));
}

// The linear model of all hypotheses: columns one, two tilts, bias.
struct Design {
  Eigen::MatrixXd columns;
  Eigen::MatrixXd normal;  // columns^T W columns
  Eigen::VectorXd right;   // columns^T W heights
  double square = 0.0;     // heights^T W heights

  Design(const HeightObservations& observations, const HeightBias& bias) {
    const Index n = observations.height_m.size();
    columns.resize(n, 3 + bias.size());
    columns.col(0).setOnes();
    columns.middleCols(1, 2) = observations.tilt;
    if (bias.size() > 0) columns.rightCols(bias.size()) = bias.basis();
  }
  void Weigh(const Eigen::VectorXd& weight, const Eigen::VectorXd& heights) {
    const Eigen::MatrixXd weighted = weight.asDiagonal() * columns;
    normal = columns.transpose() * weighted;
    right = weighted.transpose() * heights;
    square = (weight.array() * heights.array().square()).sum();
  }
};

Eigen::MatrixXd Prior(const HeightObservations& observations, const HeightBias& bias, const BiasSigmas& sigmas) {
  constexpr double kAnyHeight_m = 1e4;
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(3 + bias.size(), 3 + bias.size());
  prior(0, 0) = 1.0 / (kAnyHeight_m * kAnyHeight_m);
  prior.block<2, 2>(1, 1) = observations.tilt_information + 1e-6 * Eigen::Matrix2d::Identity();
  const Eigen::VectorXd sigma = bias.Sigmas(sigmas);
  for (Index j = 0; j < bias.size(); ++j) prior(3 + j, 3 + j) = 1.0 / (sigma[j] * sigma[j]);
  return prior;
}

// Logarithm of the likelihood with all parameters integrated out, up to a constant. The weights in `design` are inverse variances.
double MarginalLikelihood(const Design& design, const Eigen::MatrixXd& prior) {
  const Eigen::MatrixXd posterior = design.normal + prior;
  const Eigen::VectorXd solution = linear::SolvePositive(posterior, design.right);
  return -0.5 * (design.square - design.right.dot(solution)) - 0.5 * linear::LogDeterminant(posterior) + 0.5 * linear::LogDeterminant(prior);
}

}  // namespace

HeightBias::HeightBias(const std::vector<int>& flight, const std::vector<double>& phase, int reference_flight) {
  const auto n = static_cast<Index>(flight.size());
  const int n_flights = flight.empty() ? 0 : *std::max_element(flight.begin(), flight.end()) + 1;
  std::vector<Eigen::VectorXd> columns;
  for (int f = 0; f < n_flights; ++f) {
    Eigen::VectorXd member = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd along = Eigen::VectorXd::Zero(n);  // 0 to 1
    for (Index k = 0; k < n; ++k) {
      if (flight[static_cast<size_t>(k)] != f) continue;
      member[k] = 1.0;
      along[k] = phase[static_cast<size_t>(k)] + 0.5;
    }
    const double count = member.sum();
    if (count == 0.0) continue;
    const auto add = [&](Eigen::VectorXd column, Kind kind, double share) {
      if (kind != Kind::kOffset) column -= column.sum() / count * member;
      columns.push_back(std::move(column));
      kind_.push_back(kind);
      share_.push_back(share);
    };
    if (f != reference_flight) add(member, Kind::kOffset, 1.0);
    if (count < 3.0) continue;
    add(along, Kind::kDrift, 1.0);
    const Index knots = std::min(kMaxKnots, static_cast<Index>(count) / kTagsPerKnot);
    for (Index j = 0; j < knots; ++j) {
      const double share = 1.0 / static_cast<double>(knots);
      const Eigen::VectorXd ramp = (along.array() / share - static_cast<double>(j)).max(0.0).min(1.0) * member.array();
      add(ramp, Kind::kWander, share);
    }
  }
  basis_.resize(n, static_cast<Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j) basis_.col(static_cast<Index>(j)) = columns[j];
}

Eigen::VectorXd HeightBias::Sigmas(const BiasSigmas& sigmas) const {
  Eigen::VectorXd sigma(size());
  for (Index j = 0; j < size(); ++j) {
    const auto at = static_cast<size_t>(j);
    const double value = kind_[at] == Kind::kOffset ? sigmas.offset_m : kind_[at] == Kind::kDrift ? sigmas.drift_m : sigmas.wander_m;
    sigma[j] = std::max(kSmallestSigma_m, value * std::sqrt(share_[at]));
  }
  return sigma;
}

BiasChoice ChooseBias(const HeightObservations& observations, const HeightBias& bias) {
  BiasChoice choice;
  const Index n = observations.height_m.size();
  choice.solution = Eigen::VectorXd::Zero(3 + bias.size());
  const auto used = static_cast<double>((observations.sigma.array() < std::numeric_limits<double>::infinity()).count());
  if (used == 0.0) return choice;
  Design design(observations, bias);
  // Noise and outliers by the most flexible hypothesis, so that no drift is taken for noise.
  constexpr BiasSigmas kFlexible{.offset_m = 1000.0, .drift_m = 1000.0, .wander_m = 100.0};
  const Eigen::VectorXd inverse_sigma = observations.sigma.cwiseInverse();  // 0 where not used
  Eigen::VectorXd weight = inverse_sigma.array().square();
  double scale = 1.0;
  std::vector<double> sigmas(observations.sigma.data(), observations.sigma.data() + n);
  std::erase_if(sigmas, [](double sigma) { return !std::isfinite(sigma); });
  const double typical_m = base::Median(sigmas);
  // Outliers make the local estimate a little too large.
  constexpr double kLocalShare = 0.8;
  const double least = kLocalShare * LocalScale(observations);
  for (int round = 0; round < kBiasRounds; ++round) {
    design.Weigh(weight, observations.height_m);
    const Eigen::MatrixXd posterior = design.normal + Prior(observations, bias, kFlexible);
    const Eigen::VectorXd residual = design.columns * linear::SolvePositive(posterior, design.right) - observations.height_m;
    scale = std::max(least, ScaleOf(residual, observations.sigma));
    for (Index k = 0; k < n; ++k) {
      const double sigma_m = std::max(scale * observations.sigma[k], kLeastHeightNoise_m);
      const double r = std::abs(residual[k]) / sigma_m;
      // Least absolute values first: they do not need a good start.
      const double robust = round < kBiasRounds / 2 ? 1.0 / std::max(r, 0.1) : bundle::TukeyWeight(r);
      weight[k] = robust / (sigma_m * sigma_m);
    }
  }
  // The flexible curve follows the noise a little.
  const double freedom = std::max(1.0, used - static_cast<double>(design.columns.cols()));
  const double widen = scale > least ? std::sqrt(used / freedom) : 1.0;
  weight /= widen * widen;
  design.Weigh(weight, observations.height_m);
  const double noise_m = std::max(widen * scale * typical_m, kLeastHeightNoise_m);
  const auto larger = [&](double factor) { return factor * noise_m; };
  choice.sigmas = {.offset_m = noise_m, .drift_m = noise_m, .wander_m = 0.0};
  double best = -std::numeric_limits<double>::infinity();
  for (const double offset : {1.0, 10.0, 100.0}) {
    for (const double drift : {1.0, 5.0, 25.0, 125.0}) {
      for (const double wander : {0.0, 1.0, 5.0, 25.0}) {
        const BiasSigmas tried{.offset_m = larger(offset), .drift_m = larger(drift), .wander_m = larger(wander)};
        const double penalty = kPenalty * ((offset > 1.0 ? 1.0 : 0.0) + (drift > 1.0 ? 1.0 : 0.0) + (wander > 0.0 ? 1.0 : 0.0));
        const double likelihood = MarginalLikelihood(design, Prior(observations, bias, tried)) - penalty;
        if (!(likelihood > best)) continue;
        best = likelihood;
        choice.sigmas = tried;
      }
    }
  }
  const Eigen::MatrixXd posterior = design.normal + Prior(observations, bias, choice.sigmas);
  choice.solution = linear::SolvePositive(posterior, design.right);
  return choice;
}

}  // namespace skyquilt::prepare::georeference
