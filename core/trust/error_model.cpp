#include "core/trust/error_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/errors.h"
#include "core/linear/linear.h"

namespace skyquilt::trust {
namespace {

constexpr size_t kFewest = 100;      // pixels that a model is fitted to
constexpr size_t kMostGroups = 32;   // of pixels whose mean error is a knot
constexpr size_t kGroupPixels = 50;  // at least
constexpr double kUnseenLog = -6.0;  // log residual of places that no photo shows; its own feature makes up for what is wrong with it
constexpr float kThickest = 64.0F;   // pixels
constexpr float kThinnest = 0.125F;

constexpr double kBeyond = 0.25;  // slope of the logarithm beyond the outermost groups
constexpr double kLeastLog = -16.0;

struct Group {
  double value = 0.0;  // mean value of the linear model
  double error = 0.0;  // mean squared error
  double pixels = 0.0;
};

// Pools neighbours until errors ascend.
std::vector<Group> Monotone(const std::vector<Group>& groups) {
  std::vector<Group> pooled;
  for (const Group& group : groups) {
    pooled.push_back(group);
    while (pooled.size() > 1 && pooled[pooled.size() - 2].error >= pooled.back().error) {
      const Group last = pooled.back();
      pooled.pop_back();
      Group& before = pooled.back();
      const double pixels = before.pixels + last.pixels;
      before.value = (before.value * before.pixels + last.value * last.pixels) / pixels;
      before.error = (before.error * before.pixels + last.error * last.pixels) / pixels;
      before.pixels = pixels;
    }
  }
  return pooled;
}

}  // namespace

std::array<double, ErrorModel::kFeatures> ErrorModel::FeaturesOf(const PixelFacts& facts) {
  const float spread = std::isfinite(facts.spread_pixels) ? std::clamp(facts.spread_pixels, kThinnest, kThickest) : kThickest;
  const float opacity = std::clamp(std::isfinite(facts.opacity) ? facts.opacity : 0.0F, 0.0F, 1.0F);
  const float gradient = std::isfinite(facts.gradient) ? std::max(facts.gradient, 0.0F) : 0.0F;
  const bool seen = facts.evidence.seen;
  return {1.0,
          seen ? static_cast<double>(facts.evidence.log_residual) : kUnseenLog,
          std::log1p(static_cast<double>(facts.evidence.photos)),
          seen ? 0.0 : 1.0,
          std::log(static_cast<double>(spread)),
          std::log(1.0 - static_cast<double>(opacity) + 1e-3),
          std::log(static_cast<double>(gradient + kLeastError))};
}

double ErrorModel::Value(const PixelFacts& facts) const {
  const std::array<double, kFeatures> features = FeaturesOf(facts);
  return std::inner_product(features.begin(), features.end(), weights_.begin(), 0.0);
}

ErrorModel::ErrorModel(std::span<const PixelFacts> facts, std::span<const float> squared_error) {
  SKYQUILT_CHECK(facts.size() == squared_error.size(), "one error per pixel");
  if (facts.empty()) return;
  const double n = static_cast<double>(facts.size());
  const double mean = std::accumulate(squared_error.begin(), squared_error.end(), 0.0) / n;
  const double least = static_cast<double>(kLeastError) * static_cast<double>(kLeastError);
  log_error_ = {std::log(mean + 0.1 * least)};
  if (facts.size() < kFewest) return;
  constexpr auto kRows = static_cast<Eigen::Index>(kFeatures);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kRows, kRows);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kRows);
  for (size_t i = 0; i < facts.size(); ++i) {
    const std::array<double, kFeatures> features = FeaturesOf(facts[i]);
    const double wanted = std::log(static_cast<double>(squared_error[i]) + least);
    for (Eigen::Index a = 0; a < kRows; ++a) {
      const double at = features[static_cast<size_t>(a)];
      for (Eigen::Index b = 0; b < kRows; ++b) normal(a, b) += at * features[static_cast<size_t>(b)];
      right[a] += at * wanted;
    }
  }
  // Features that are the same for all pixels, such as "unseen", get no weight.
  normal.diagonal().array() += 1e-6 * n;
  const Eigen::VectorXd weights = linear::SolvePositive(normal, right);
  if (!weights.allFinite()) return;
  for (size_t i = 0; i < kFeatures; ++i) weights_[i] = weights[static_cast<Eigen::Index>(i)];

  std::vector<std::pair<double, double>> order(facts.size());
  for (size_t i = 0; i < facts.size(); ++i) order[i] = {Value(facts[i]), static_cast<double>(squared_error[i])};
  std::ranges::sort(order);
  const size_t n_groups = std::clamp<size_t>(order.size() / kGroupPixels, 1, kMostGroups);
  std::vector<Group> groups(n_groups);
  for (size_t g = 0; g < n_groups; ++g) {
    const size_t begin = g * order.size() / n_groups, end = (g + 1) * order.size() / n_groups;
    for (size_t i = begin; i < end; ++i) {
      groups[g].value += order[i].first;
      groups[g].error += order[i].second;
    }
    groups[g].pixels = static_cast<double>(end - begin);
    groups[g].value /= groups[g].pixels;
    groups[g].error /= groups[g].pixels;
  }
  knots_.clear();
  log_error_.clear();
  for (const Group& group : Monotone(groups)) {
    if (!knots_.empty() && !(group.value > knots_.back())) continue;
    knots_.push_back(group.value);
    log_error_.push_back(std::log(group.error + 0.1 * least));
  }
}

float ErrorModel::RmsError(const PixelFacts& facts) const {
  const double value = Value(facts);
  const auto above = std::upper_bound(knots_.begin(), knots_.end(), value);
  double log_error = 0.0;
  if (above == knots_.end() || above == knots_.begin()) {
    // Beyond the pixels that were measured errors go on growing, but slower than the model says.
    const size_t end = above == knots_.end() ? knots_.size() - 1 : 0;
    log_error = std::clamp(log_error_[end] + kBeyond * (value - knots_[end]), kLeastLog, 0.0);
  } else {
    const auto i = static_cast<size_t>(above - knots_.begin());
    const double share = (value - knots_[i - 1]) / (knots_[i] - knots_[i - 1]);
    log_error = log_error_[i - 1] + share * (log_error_[i] - log_error_[i - 1]);
  }
  return static_cast<float>(std::exp(0.5 * log_error));
}

void ErrorModel::Put(checkpoint::ArchiveWriter& writer) const {
  writer.Put("error_model/weights", std::span<const double>(weights_));
  writer.Put("error_model/knots", std::span<const double>(knots_));
  writer.Put("error_model/log_error", std::span<const double>(log_error_));
}

ErrorModel ErrorModel::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  ErrorModel model;
  const std::vector<double> weights = reader.Doubles("error_model/weights");
  model.knots_ = reader.Doubles("error_model/knots");
  model.log_error_ = reader.Doubles("error_model/log_error");
  const auto finite = [](const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  if (weights.size() != kFeatures || model.knots_.empty() || model.knots_.size() != model.log_error_.size() || !finite(weights) ||
      !finite(model.knots_) || !finite(model.log_error_) || !std::ranges::is_sorted(model.knots_)) {
    throw base::InputError(file, "is damaged: its error model is not of the form that this program writes",
                           "Merge the scene again: skyquilt merge PROJECT --restart");
  }
  std::ranges::copy(weights, model.weights_.begin());
  return model;
}

}  // namespace skyquilt::trust
