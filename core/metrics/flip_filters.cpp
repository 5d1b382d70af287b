#include "core/metrics/flip_filters.h"

#include <cmath>
#include <numbers>

namespace skyquilt::metrics {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPixelsPerDegree = 3840.0 * kPi / 180.0;  // a screen as wide as its distance
constexpr double kFeatureWidth_deg = 0.082;                // from peak to trough of the edge detector
// Gaussians a sqrt(pi / b) exp(-pi^2 d^2 / b) of the distance d in degrees, which model the contrast sensitivity of the eye.
constexpr double kAchromaticB = 0.0047;
constexpr double kRedGreenB = 0.0053;
constexpr double kBroadA = 34.1, kBroadB = 0.04;
constexpr double kNarrowA = 13.5, kNarrowB = 0.025;

template <typename Value>
std::vector<double> Sampled(int radius, const Value& value) {
  std::vector<double> taps;
  for (int i = -radius; i <= radius; ++i) taps.push_back(value(static_cast<double>(i)));
  return taps;
}

// Positive taps are scaled to sum to 1, negative ones to -1. *scale: what the positive ones were divided by.
Taps Normalised(const std::vector<double>& taps, double* scale = nullptr) {
  double positive = 0.0, negative = 0.0;
  for (const double tap : taps) (tap > 0.0 ? positive : negative) += std::abs(tap);
  if (scale != nullptr) *scale = positive;
  Taps normalised;
  for (const double tap : taps) normalised.push_back(static_cast<float>(tap > 0.0 ? tap / positive : negative > 0.0 ? tap / negative : 0.0));
  return normalised;
}

FlipFilters MakeFilters() {
  FlipFilters filters;
  filters.color_radius = static_cast<int>(std::ceil(3.0 * std::sqrt(kBroadB / (2.0 * kPi * kPi)) * kPixelsPerDegree));
  const auto Gaussian = [&](double b, double* scale) {
    return Normalised(Sampled(filters.color_radius, [&](double x) { return std::exp(-std::pow(kPi * x / kPixelsPerDegree, 2) / b); }), scale);
  };
  filters.achromatic = Gaussian(kAchromaticB, nullptr);
  filters.red_green = Gaussian(kRedGreenB, nullptr);
  double broad_sum = 0.0, narrow_sum = 0.0;
  filters.blue_yellow_broad = Gaussian(kBroadB, &broad_sum);
  filters.blue_yellow_narrow = Gaussian(kNarrowB, &narrow_sum);
  const double broad = kBroadA * std::sqrt(kPi / kBroadB) * broad_sum * broad_sum;
  const double narrow = kNarrowA * std::sqrt(kPi / kNarrowB) * narrow_sum * narrow_sum;
  filters.broad_weight = static_cast<float>(broad / (broad + narrow));
  filters.narrow_weight = static_cast<float>(narrow / (broad + narrow));

  const double sigma = 0.5 * kFeatureWidth_deg * kPixelsPerDegree;
  filters.feature_radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto Bell = [&](double x) { return std::exp(-x * x / (2.0 * sigma * sigma)); };
  filters.smooth = Normalised(Sampled(filters.feature_radius, Bell));
  filters.edge = Normalised(Sampled(filters.feature_radius, [&](double x) { return -x * Bell(x); }));
  filters.point = Normalised(Sampled(filters.feature_radius, [&](double x) { return (x * x / (sigma * sigma) - 1.0) * Bell(x); }));
  return filters;
}

}  // namespace

const FlipFilters& FiltersOfFlip() {
  static const FlipFilters filters = MakeFilters();
  return filters;
}

}  // namespace skyquilt::metrics
