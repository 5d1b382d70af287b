// Writes text, numbers with units and table cells as HTML.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace skyquilt::page {

// Text for element content and quoted attributes: & < > " ' are replaced, control characters dropped, bytes that are not UTF-8 become U+FFFD.
std::string EscapeHtml(std::string_view text);
// Fixed decimals; an en dash for NaN, the infinity sign for infinity. The unit follows a thin no-break space, a degree sign
// directly; it is left out without a number.
std::string FormatFixed(double value, int decimals, std::string_view unit = "");
// "0.93" as "93.0 %".
std::string FormatPercent(double share, int decimals = 1);
// "1.53 GiB"; an en dash for 0.
std::string FormatBytes(int64_t bytes);
// "24.5 s", "10 min 24 s", "2 h 05 min", with thin no-break spaces before the units; an en dash for NaN.
std::string FormatDuration(double seconds);
// "12 345 678" with thin no-break spaces.
std::string FormatInteger(int64_t value);
// Large counts as "1.53 M"; an en dash for NaN.
std::string FormatLarge(double value, std::string_view unit = "");
// Right-aligned table cell with the text `shown`; the table sorts by `value`.
std::string NumberCell(double value, const std::string& shown);
std::string TextCell(std::string_view text);

}  // namespace skyquilt::page
