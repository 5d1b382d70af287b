// Figures that may not be known: NaN means "not measured".
#pragma once

#include <limits>
#include <vector>

namespace skyquilt::evaluate {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// Mean of the finite values; NaN when there is none. An infinite value makes the mean infinite.
double MeanOfMeasured(const std::vector<double>& values);
// Median of the finite values; NaN when there is none.
double MedianOfMeasured(std::vector<double> values);

}  // namespace skyquilt::evaluate
