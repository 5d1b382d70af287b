// Durations and counts as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace skyquilt::base {

struct DurationUnits {
  std::string_view second = "s", minute = "m", hour = "h";
  std::string_view between = "";
};
// "1h02m", "3m20s", "12.3s"; "?" for what is none.
std::string FormatDuration(double seconds, const DurationUnits& units = {});

struct ScaledCount {
  double value = 0.0;       // below 999.5 in size, unless it is larger than all prefixes
  std::string_view prefix;  // "", "k", "M", "G", "T"
};
ScaledCount ScaleCount(double count);
// "1.50 M", "12.3 k"
std::string FormatCount(double count);

// "335,120"
std::string GroupDigits(int64_t value, std::string_view between = ",");
// "335,120 triangles"; "1 triangle": adds an s to the unit for other counts than 1.
std::string CountText(int64_t count, const std::string& unit);

}  // namespace skyquilt::base
