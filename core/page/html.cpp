#include "core/page/html.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "core/base/amounts.h"

namespace skyquilt::page {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
constexpr std::string_view kDash = "\xE2\x80\x93";
constexpr std::string_view kDegree = "\xC2\xB0";
constexpr std::string_view kThinSpace = "\xE2\x80\xAF";

// Length of the well-formed UTF-8 sequence at the start of `text`, 0 when there is none.
size_t Utf8Length(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const auto follows = [&](size_t i) { return i < text.size() && (byte(i) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0);
  if (first < 0x80U) return 1;
  if (first >= 0xC2U && first < 0xE0U) return follows(1) ? 2 : 0;
  if (first >= 0xE0U && first < 0xF0U) {
    if (!follows(1) || !follows(2)) return 0;
    const bool overlong = first == 0xE0U && byte(1) < 0xA0U;
    const bool surrogate = first == 0xEDU && byte(1) >= 0xA0U;
    return overlong || surrogate ? 0 : 3;
  }
  if (first >= 0xF0U && first < 0xF5U) {
    if (!follows(1) || !follows(2) || !follows(3)) return 0;
    const bool overlong = first == 0xF0U && byte(1) < 0x90U;
    const bool too_large = first == 0xF4U && byte(1) >= 0x90U;
    return overlong || too_large ? 0 : 4;
  }
  return 0;
}

std::string WithUnit(std::string number, std::string_view unit) {
  if (!unit.empty() && unit != kDegree) number.append(kThinSpace);
  return number.append(unit);
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size() + text.size() / 8);
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    if (length == 0) {
      escaped += kReplacement;
      text.remove_prefix(1);
      continue;
    }
    const char c = text.front();
    if (length > 1) {
      escaped += text.substr(0, length);
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&#39;";
    } else if (static_cast<unsigned char>(c) >= 0x20U || c == '\n' || c == '\t') {
      escaped += c;
    }
    text.remove_prefix(length);
  }
  return escaped;
}

std::string FormatFixed(double value, int decimals, std::string_view unit) {
  if (std::isnan(value)) return std::string(kDash);
  if (std::isinf(value)) return value > 0 ? "\xE2\x88\x9E" : "\xE2\x88\x92\xE2\x88\x9E";
  std::string number = fmt::format("{:.{}f}", value, decimals);
  if (number.front() == '-') {
    // No minus sign for "-0.00".
    const bool zero = number.find_first_of("123456789") == std::string::npos;
    number.replace(0, 1, zero ? "" : "\xE2\x88\x92");
  }
  return WithUnit(std::move(number), unit);
}

std::string FormatPercent(double share, int decimals) {
  return FormatFixed(share * 100.0, decimals, "%");
}

std::string FormatBytes(int64_t bytes) {
  if (bytes <= 0) return std::string(kDash);
  constexpr std::array<std::string_view, 5> kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto value = static_cast<double>(bytes);
  size_t unit = 0;
  while (value >= 1024.0 && unit + 1 < kUnits.size()) {
    value /= 1024.0;
    ++unit;
  }
  return FormatFixed(value, unit == 0 ? 0 : value < 10.0 ? 2 : 1, kUnits[unit]);
}

std::string FormatDuration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 59.95) return FormatFixed(seconds, 1, "s");
  const std::string second = WithUnit("", "s"), minute = WithUnit("", "min"), hour = WithUnit("", "h");
  return base::FormatDuration(seconds, {second, minute, hour, " "});
}

std::string FormatInteger(int64_t value) {
  return base::GroupDigits(value, kThinSpace);
}

std::string FormatLarge(double value, std::string_view unit) {
  if (!std::isfinite(value)) return FormatFixed(value, 0);
  const base::ScaledCount scaled = base::ScaleCount(value);
  const int decimals = scaled.prefix.empty() ? 0 : std::abs(scaled.value) < 10.0 ? 2 : std::abs(scaled.value) < 100.0 ? 1 : 0;
  return FormatFixed(scaled.value, decimals, std::string(scaled.prefix) + std::string(unit));
}

std::string NumberCell(double value, const std::string& shown) {
  return fmt::format("<td class=\"num\" data-v=\"{}\">{}</td>", std::isfinite(value) ? fmt::format("{}", value) : "", shown);
}

std::string TextCell(std::string_view text) {
  return "<td>" + EscapeHtml(text) + "</td>";
}

}  // namespace skyquilt::page
