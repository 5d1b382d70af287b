#include "core/base/amounts.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace skyquilt::base {

std::string FormatDuration(double seconds, const DurationUnits& units) {
  if (!std::isfinite(seconds) || seconds < 0.0) return "?";
  if (seconds < 59.95) return fmt::format("{:.1f}{}", seconds, units.second);
  const auto two = [&](double whole, std::string_view unit, std::string_view part) {
    return fmt::format("{:.0f}{}{}{:02.0f}{}", std::floor(whole / 60.0), unit, units.between, std::fmod(whole, 60.0), part);
  };
  const double rounded = std::round(seconds);
  return rounded < 3600.0 ? two(rounded, units.minute, units.second) : two(std::round(seconds / 60.0), units.hour, units.minute);
}

ScaledCount ScaleCount(double count) {
  static constexpr std::array<std::string_view, 5> kPrefixes = {"", "k", "M", "G", "T"};
  size_t prefix = 0;
  // 999.5 would be rounded to 1000 in the smaller unit.
  while (std::abs(count) >= 999.5 && prefix + 1 < kPrefixes.size()) {
    count /= 1000.0;
    ++prefix;
  }
  return {count, kPrefixes[prefix]};
}

std::string FormatCount(double count) {
  if (!std::isfinite(count)) return "?";
  const ScaledCount scaled = ScaleCount(count);
  if (scaled.prefix.empty() && scaled.value == std::round(scaled.value)) return fmt::format("{:.0f}", scaled.value);
  const int decimals = std::abs(scaled.value) < 9.995 ? 2 : std::abs(scaled.value) < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}{}{}", scaled.value, decimals, scaled.prefix.empty() ? "" : " ", scaled.prefix);
}

std::string GroupDigits(int64_t value, std::string_view between) {
  std::string digits = std::to_string(value);
  const size_t first = digits.front() == '-' ? 1 : 0;
  for (size_t at = digits.size(); at > first + 3;) digits.insert(at -= 3, between);
  return digits;
}

std::string CountText(int64_t count, const std::string& unit) {
  return GroupDigits(count) + " " + unit + (count == 1 ? "" : "s");
}

}  // namespace skyquilt::base
