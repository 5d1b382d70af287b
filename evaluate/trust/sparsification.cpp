#include "evaluate/trust/sparsification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/errors.h"

namespace skyquilt::evaluate::trust {
namespace {

constexpr size_t kShares = 100;
constexpr std::array kLists = {&TrustPixels::squared_error, &TrustPixels::expected, &TrustPixels::photos, &TrustPixels::gradient,
                               &TrustPixels::opacity};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Indices from the least to the most doubtful.
std::vector<size_t> OrderOf(std::span<const float> doubt) {
  std::vector<size_t> order(doubt.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return doubt[a] < doubt[b]; });
  return order;
}

// Mean over the shares taken away of the root mean square error of what is left.
double MeanCurve(std::span<const float> doubt, std::span<const float> squared_error) {
  const std::vector<size_t> order = OrderOf(doubt);
  std::vector<double> sum_to(order.size() + 1, 0.0);
  for (size_t i = 0; i < order.size(); ++i) sum_to[i + 1] = sum_to[i] + static_cast<double>(squared_error[order[i]]);
  double sum = 0.0;
  for (size_t share = 0; share < kShares; ++share) {
    const size_t left = std::max<size_t>(1, order.size() - share * order.size() / kShares);
    sum += std::sqrt(sum_to[left] / static_cast<double>(left));
  }
  return sum / static_cast<double>(kShares);
}

double Mean(std::span<const size_t> order, std::span<const float> values) {
  double sum = 0.0;
  for (const size_t i : order) sum += static_cast<double>(values[i]);
  return sum / static_cast<double>(order.size());
}

std::vector<float> Negative(std::span<const float> values) {
  std::vector<float> negative(values.begin(), values.end());
  for (float& value : negative) value = -value;
  return negative;
}

double RootMean(const std::vector<float>& squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size()));
}

}  // namespace

void TrustPixels::Add(const TrustPixels& more) {
  for (const auto list : kLists) (this->*list).insert((this->*list).end(), (more.*list).begin(), (more.*list).end());
}

void TrustPixels::Save(base::BytePacker* out) const {
  for (const auto list : kLists) out->Add(this->*list);
}

void TrustPixels::Load(base::ByteUnpacker* in) {
  for (const auto list : kLists) in->Take(&(this->*list));
  for (const auto list : kLists) {
    if ((this->*list).size() != squared_error.size()) in->Fail();
  }
}

double Ause(std::span<const float> doubt, std::span<const float> squared_error) {
  SKYQUILT_CHECK(doubt.size() == squared_error.size(), "one error per pixel");
  if (doubt.empty()) return kNaN;
  const double all = std::sqrt(std::accumulate(squared_error.begin(), squared_error.end(), 0.0) / static_cast<double>(squared_error.size()));
  if (!(all > 0.0)) return kNaN;
  return (MeanCurve(doubt, squared_error) - MeanCurve(squared_error, squared_error)) / all;
}

TrustScores ScoreTrust(const TrustPixels& pixels) {
  TrustScores scores{pixels.squared_error.size(), kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  const std::vector<float>& error = pixels.squared_error;
  if (error.empty()) return scores;
  scores.ause = Ause(pixels.expected, error);
  scores.ause_photos = Ause(Negative(pixels.photos), error);
  scores.ause_gradient = Ause(pixels.gradient, error);
  scores.ause_opacity = Ause(Negative(pixels.opacity), error);
  const std::vector<size_t> order = OrderOf(pixels.expected);
  const size_t tenth = std::max<size_t>(1, order.size() / 10);
  const double most = Mean(std::span(order).first(tenth), error);
  scores.least_over_most = most > 0.0 ? Mean(std::span(order).last(tenth), error) / most : kNaN;
  std::vector<float> squares = pixels.expected;
  for (float& value : squares) value *= value;
  scores.expected_rms = RootMean(squares);
  scores.found_rms = RootMean(error);
  return scores;
}

}  // namespace skyquilt::evaluate::trust
