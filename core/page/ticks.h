// Positions and labels of the ticks of an axis.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::page {

// About `count` round numbers (multiples of 1, 2 or 5 times a power of ten) inside [low, high]. Empty for an empty or infinite range.
std::vector<double> RoundTicks(double low, double high, int count);
// Decimal logarithms of round numbers inside the range: powers of ten, and numbers between them when there are only few.
std::vector<double> LogTicks(double low_log10, double high_log10);
// "10", "0.05", "25.0 k": as many digits as the number needs.
std::string TickLabel(double value);

}  // namespace skyquilt::page
