#include "evaluate/measured.h"

#include <cmath>
#include <utility>

#include "core/base/order_statistics.h"

namespace skyquilt::evaluate {

double MeanOfMeasured(const std::vector<double>& values) {
  double sum = 0.0;
  int n = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNotMeasured;
}

double MedianOfMeasured(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? kNotMeasured : base::Median(std::move(values));
}

}  // namespace skyquilt::evaluate
