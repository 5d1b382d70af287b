#include "core/page/ticks.h"

#include <fmt/core.h>

#include <cmath>

#include "core/page/html.h"

namespace skyquilt::page {

std::vector<double> RoundTicks(double low, double high, int count) {
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high) || count < 1) return {};
  const double raw = (high - low) / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * magnitude;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * magnitude >= raw * 0.999) {
      step = factor * magnitude;
      break;
    }
  }
  std::vector<double> ticks;
  for (double index = std::ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; index += 1.0)
    ticks.push_back(index * step + 0.0);  // + 0.0 turns -0 into 0
  return ticks;
}

std::vector<double> LogTicks(double low_log10, double high_log10) {
  std::vector<double> ticks;
  const bool dense = high_log10 - low_log10 < 2.5;
  for (int decade = static_cast<int>(std::floor(low_log10)); decade <= static_cast<int>(std::ceil(high_log10)); ++decade) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (!dense && factor != 1.0) continue;
      const double tick = decade + std::log10(factor);
      if (tick >= low_log10 && tick <= high_log10) ticks.push_back(tick);
    }
  }
  if (ticks.size() >= 3 || high_log10 - low_log10 >= 1.0) return ticks;
  // In less than a decade there is at most one power of ten: use round numbers instead.
  ticks = RoundTicks(std::pow(10.0, low_log10), std::pow(10.0, high_log10), 5);
  for (double& tick : ticks) tick = std::log10(tick);
  return ticks;
}

std::string TickLabel(double value) {
  return std::abs(value) >= 1e4 ? FormatLarge(value) : fmt::format("{:.4g}", value);
}

}  // namespace skyquilt::page
