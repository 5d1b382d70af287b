#include "products/photo_map/overlap_gains.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/order_statistics.h"

namespace skyquilt::products {
namespace {

constexpr double kStay = 1e-3;  // of the mean number of ratios per photo: weight of a gain of 0
constexpr int kMostRounds = 500;
constexpr double kSmallResidual = 1e-9;  // relative, squared

struct PhotoPair {
  Eigen::Index first, second;
  double weight;  // number of ratios
  double median;
};

std::vector<PhotoPair> PairsOf(const std::vector<OverlapRatio>& ratios, size_t color) {
  std::map<std::pair<int32_t, int32_t>, std::vector<double>> by_pair;
  for (const OverlapRatio& ratio : ratios) {
    const auto value = static_cast<double>(ratio.log_ratio[color]);
    if (!std::isfinite(value) || ratio.first == ratio.second) continue;
    const bool in_order = ratio.first < ratio.second;
    by_pair[{std::min(ratio.first, ratio.second), std::max(ratio.first, ratio.second)}].push_back(in_order ? value : -value);
  }
  std::vector<PhotoPair> pairs;
  for (auto& [photos, values] : by_pair) {
    const auto weight = static_cast<double>(values.size());
    pairs.push_back({photos.first, photos.second, weight, base::Median(std::move(values))});
  }
  return pairs;
}

// The gradient of the sum for gains g, without its constant part.
Eigen::VectorXd Apply(const std::vector<PhotoPair>& pairs, double stay, const Eigen::VectorXd& g) {
  Eigen::VectorXd result = stay * g;
  for (const PhotoPair& pair : pairs) {
    const double pull = pair.weight * (g[pair.first] - g[pair.second]);
    result[pair.first] += pull;
    result[pair.second] -= pull;
  }
  return result;
}

Eigen::VectorXd Solve(const std::vector<PhotoPair>& pairs, size_t photos) {
  const auto n = static_cast<Eigen::Index>(photos);
  Eigen::VectorXd gains = Eigen::VectorXd::Zero(n), residual = gains;
  double weight = 0.0;
  for (const PhotoPair& pair : pairs) {
    residual[pair.first] -= pair.weight * pair.median;
    residual[pair.second] += pair.weight * pair.median;
    weight += 2.0 * pair.weight;
  }
  const double stay = std::max(1e-9, kStay * weight / static_cast<double>(std::max<size_t>(photos, 1)));
  Eigen::VectorXd direction = residual;
  double squared = residual.squaredNorm();
  const double enough = kSmallResidual * squared;
  for (int round = 0; round < kMostRounds && squared > enough && squared > 0.0; ++round) {
    const Eigen::VectorXd applied = Apply(pairs, stay, direction);
    const double step = squared / direction.dot(applied);
    gains += step * direction;
    residual -= step * applied;
    const double next = residual.squaredNorm();
    direction = residual + next / squared * direction;
    squared = next;
  }
  return gains;
}

}  // namespace

std::vector<std::array<float, 3>> GainsOfOverlaps(size_t photos, const std::vector<OverlapRatio>& ratios) {
  std::vector<std::array<float, 3>> gains(photos, {0.0F, 0.0F, 0.0F});
  for (size_t color = 0; color < 3; ++color) {
    const Eigen::VectorXd solved = Solve(PairsOf(ratios, color), photos);
    for (size_t photo = 0; photo < photos; ++photo) gains[photo][color] = static_cast<float>(solved[static_cast<Eigen::Index>(photo)]);
  }
  return gains;
}

}  // namespace skyquilt::products
