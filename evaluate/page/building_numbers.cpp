#include "evaluate/page/building_numbers.h"

#include <algorithm>
#include <cmath>

#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr const char* kPlusMinus = "\xE2\x80\xAF\xC2\xB1\xE2\x80\xAF";
constexpr int kMostDecimals = 6;

// Decimals that show two digits; negative: tens, hundreds, ... are rounded away.
int DecimalsOfTwoDigits(double sigma) {
  const int exponent = static_cast<int>(std::floor(std::log10(sigma)));
  // 0.0996 becomes 0.10, not 0.100.
  const bool carries = std::round(sigma / std::pow(10.0, exponent - 1)) >= 100.0;
  return 1 - exponent - (carries ? 1 : 0);
}

}  // namespace

BuildingUnits BuildingUnits::Of(const skyquilt::buildings::BuildingSet& set) {
  return set.metric ? BuildingUnits{} : BuildingUnits{"", "", ""};
}

std::string ShownMeasure(const skyquilt::buildings::Measure& measure, const char* unit) {
  if (!std::isfinite(measure.value) || !std::isfinite(measure.sigma) || !(measure.sigma > 0.0)) return FormatFixed(measure.value, 2, unit);
  const int decimals = std::min(DecimalsOfTwoDigits(measure.sigma), kMostDecimals);
  const double step = decimals < 0 ? std::pow(10.0, -decimals) : 1.0;
  const auto rounded = [step](double x) { return step * std::round(x / step); };
  const bool coarse = decimals < 0;
  return FormatFixed(coarse ? rounded(measure.value) : measure.value, std::max(decimals, 0)) + kPlusMinus +
         FormatFixed(coarse ? rounded(measure.sigma) : measure.sigma, std::max(decimals, 0), unit);
}

std::string MeasureCell(const skyquilt::buildings::Measure& measure, const char* unit) {
  return NumberCell(measure.value, ShownMeasure(measure, unit));
}

}  // namespace skyquilt::evaluate::page
