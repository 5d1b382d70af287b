#include "prepare/georeference/horizontal_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include "core/base/random.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector2d;

constexpr int kRefitRounds = 5;
// A lag must explain the tags better than this share to be preferred to a smaller one.
constexpr double kSameCost = 1.02;
// The same, per tag, where all tags fit exactly.
constexpr double kRounding_m2 = 1e-9;

// Least squares of a similarity on the chosen pairs: in complex numbers, b = m a + t.
std::optional<HorizontalSimilarity> LeastSquares(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b, const std::vector<size_t>& chosen) {
  Vector2d mean_a = Vector2d::Zero(), mean_b = Vector2d::Zero();
  for (const size_t k : chosen) {
    mean_a += a[k];
    mean_b += b[k];
  }
  mean_a /= static_cast<double>(chosen.size());
  mean_b /= static_cast<double>(chosen.size());
  std::complex<double> product = 0.0;
  double square = 0.0;
  for (const size_t k : chosen) {
    const Vector2d da = a[k] - mean_a, db = b[k] - mean_b;
    product += std::conj(std::complex<double>(da.x(), da.y())) * std::complex<double>(db.x(), db.y());
    square += da.squaredNorm();
  }
  if (!(square > 0.0) || !(std::abs(product) > 0.0)) return std::nullopt;
  HorizontalSimilarity fit{.scale = std::abs(product) / square, .angle = std::arg(product)};
  fit.translation = mean_b - fit * mean_a;
  if (!std::isfinite(fit.scale) || !fit.translation.allFinite()) return std::nullopt;
  return fit;
}

void Score(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b, double threshold_m, HorizontalFit& fit) {
  fit.cost = 0.0;
  fit.n_inliers = 0;
  fit.inlier.assign(a.size(), 0);
  const double limit = threshold_m * threshold_m;
  for (size_t k = 0; k < a.size(); ++k) {
    const double squared = (fit.enu_from_level * a[k] - b[k]).squaredNorm();
    fit.cost += std::min(squared, limit);
    if (squared > limit) continue;
    fit.inlier[k] = 1;
    ++fit.n_inliers;
  }
}

HorizontalFit FitWithLag(const std::vector<Vector2d>& level, const std::vector<Vector2d>& tags, const std::vector<std::vector<size_t>>& samples,
                         double threshold_m) {
  HorizontalFit best;
  best.cost = std::numeric_limits<double>::infinity();
  const auto improve = [&](const std::vector<size_t>& chosen) {
    const std::optional<HorizontalSimilarity> similarity = LeastSquares(level, tags, chosen);
    if (!similarity) return false;
    HorizontalFit fit{.ok = true, .enu_from_level = *similarity};
    Score(level, tags, threshold_m, fit);
    if (!(fit.cost < best.cost)) return false;
    best = std::move(fit);
    return true;
  };
  for (const std::vector<size_t>& sample : samples) improve(sample);
  for (int round = 0; round < kRefitRounds && best.ok; ++round) {
    std::vector<size_t> inliers;
    inliers.reserve(level.size());
    for (size_t k = 0; k < level.size(); ++k) {
      if (best.inlier[k] != 0) inliers.push_back(k);
    }
    if (inliers.size() < 2 || !improve(inliers)) break;
  }
  return best;
}

}  // namespace

Vector2d HorizontalSimilarity::operator*(const Vector2d& x) const {
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  return {c * x.x() - s * x.y() + translation.x(), s * x.x() + c * x.y() + translation.y()};
}

HorizontalFit FitHorizontally(const std::vector<Vector2d>& tags, const std::function<Vector2d(size_t, double)>& level,
                              const HorizontalFitOptions& options) {
  HorizontalFit best;
  best.inlier.assign(tags.size(), 0);
  if (tags.size() < 2) return best;
  base::Random random(options.seed);
  std::vector<std::vector<size_t>> samples;
  samples.reserve(static_cast<size_t>(options.draws) + 1);
  std::vector<size_t> all(tags.size());
  for (size_t k = 0; k < all.size(); ++k) all[k] = k;
  samples.push_back(all);
  for (int draw = 0; draw < options.draws; ++draw) {
    const size_t first = random.Below(static_cast<uint32_t>(tags.size()));
    const size_t second = random.Below(static_cast<uint32_t>(tags.size()));
    if (first != second) samples.push_back({first, second});
  }
  const double rounding_m2 = kRounding_m2 * static_cast<double>(tags.size());
  std::vector<double> lags = options.lags_s;
  std::stable_sort(lags.begin(), lags.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  for (const double lag_s : lags) {
    std::vector<Vector2d> moved(tags.size());
    for (size_t k = 0; k < tags.size(); ++k) moved[k] = level(k, lag_s);
    HorizontalFit fit = FitWithLag(moved, tags, samples, options.threshold_m);
    fit.lag_s = lag_s;
    if (fit.ok && (!best.ok || fit.cost * kSameCost + rounding_m2 < best.cost)) best = std::move(fit);
  }
  return best;
}

}  // namespace skyquilt::prepare::georeference
