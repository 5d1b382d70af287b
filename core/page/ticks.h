// Where an axis has its ticks, and what is written at them.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::page {

// At most about `count` round numbers (1, 2, 5 times a power of ten) inside [low, high].
std::vector<double> RoundTicks(double low, double high, int count);
// Decimal logarithms of round numbers between two decimal logarithms: powers of ten, and what lies between where there are few of them.
std::vector<double> LogTicks(double low_log10, double high_log10);
// "10", "0.05", "25.0 k": as many digits as the number needs.
std::string TickLabel(double value);

}  // namespace skyquilt::page
