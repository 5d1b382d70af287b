#include "buildings/fit/height_mode.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::buildings {
namespace {

constexpr double kStepsPerBandwidth = 4.0;
constexpr size_t kMostBins = 100000;

struct Histogram {
  double first = 0.0, step = 1.0;
  std::vector<double> mass;
};

Histogram HistogramOf(std::span<const double> values, std::span<const double> weights, double bandwidth) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  Histogram histogram;
  histogram.step = std::max(bandwidth / kStepsPerBandwidth, (*high - *low) / static_cast<double>(kMostBins));
  const double beyond = 2.0 * (bandwidth + histogram.step);
  histogram.first = *low - beyond;
  histogram.mass.resize(static_cast<size_t>(std::ceil((*high + beyond - histogram.first) / histogram.step)) + 1);
  for (size_t i = 0; i < values.size(); ++i) {
    // Shared between the two nearest bins, so that the peak moves smoothly with the values.
    const double place = (values[i] - histogram.first) / histogram.step;
    const auto bin = std::min(static_cast<size_t>(place), histogram.mass.size() - 2);
    const double part = place - static_cast<double>(bin);
    const double weight = weights.empty() ? 1.0 : weights[i];
    histogram.mass[bin] += (1.0 - part) * weight;
    histogram.mass[bin + 1] += part * weight;
  }
  return histogram;
}

std::vector<double> Smoothed(const std::vector<double>& mass, int reach) {
  std::vector<double> density(mass.size(), 0.0);
  const auto n = static_cast<int>(mass.size());
  for (int i = 0; i < n; ++i) {
    for (int k = std::max(0, i - reach); k <= std::min(n - 1, i + reach); ++k) {
      density[static_cast<size_t>(i)] += mass[static_cast<size_t>(k)] * static_cast<double>(reach + 1 - std::abs(i - k));
    }
  }
  return density;
}

}  // namespace

std::vector<Mode> Modes(std::span<const double> values, std::span<const double> weights, double bandwidth) {
  if (values.empty()) return {};
  const Histogram histogram = HistogramOf(values, weights, bandwidth);
  const int reach = std::max(1, static_cast<int>(std::lround(bandwidth / histogram.step)));
  const std::vector<double> density = Smoothed(histogram.mass, reach);
  std::vector<Mode> modes;
  for (size_t i = 1; i + 1 < density.size(); ++i) {
    if (!(density[i] > density[i - 1] && density[i] >= density[i + 1])) continue;
    // The top of the parabola through three bins.
    const double bend = density[i - 1] - 2.0 * density[i] + density[i + 1];
    const double shift = bend < 0.0 ? 0.5 * (density[i - 1] - density[i + 1]) / bend : 0.0;
    Mode mode;
    mode.at = histogram.first + (static_cast<double>(i) + shift) * histogram.step;
    for (size_t k = 0; k < values.size(); ++k) {
      if (std::abs(values[k] - mode.at) <= 2.0 * bandwidth) mode.mass += weights.empty() ? 1.0 : weights[k];
    }
    modes.push_back(mode);
  }
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.mass > b.mass; });
  return modes;
}

std::optional<Mode> LowestStrongMode(std::span<const double> values, double bandwidth, double share) {
  const std::vector<Mode> modes = Modes(values, {}, bandwidth);
  if (modes.empty()) return std::nullopt;
  Mode lowest = modes.front();
  for (const Mode& mode : modes) {
    if (mode.mass >= share * modes.front().mass && mode.at < lowest.at) lowest = mode;
  }
  return lowest;
}

}  // namespace skyquilt::buildings
