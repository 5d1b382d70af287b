#include "app/settings/duration.h"

#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

[[noreturn]] void ThrowNotADuration(const std::string& text) {
  throw base::UsageError("'" + text + "' is not a duration. Write for instance 90s, 10min, 1h30m or plain seconds");
}

// Digits with at most one decimal point, starting at *at; advances it. Nothing when there is no digit.
std::optional<double> ReadNumber(const std::string& text, size_t* at) {
  const size_t start = *at;
  bool digit = false;
  bool point = false;
  while (*at < text.size()) {
    const char c = text[*at];
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      digit = true;
    } else if (c == '.' && !point) {
      point = true;
    } else {
      break;
    }
    ++*at;
  }
  if (!digit || *at - start > 12) return std::nullopt;
  return std::stod(text.substr(start, *at - start));
}

std::optional<double> ParseClock(const std::string& text) {
  std::vector<double> fields;
  size_t at = 0;
  while (true) {
    const std::optional<double> number = ReadNumber(text, &at);
    if (!number) return std::nullopt;
    fields.push_back(*number);
    if (at == text.size()) break;
    if (text[at] != ':') return std::nullopt;
    ++at;
  }
  if (fields.size() < 2 || fields.size() > 3) return std::nullopt;
  double seconds = 0.0;
  for (size_t i = 0; i < fields.size(); ++i) {
    if (i > 0 && fields[i] >= 60.0) return std::nullopt;
    seconds = seconds * 60.0 + fields[i];
  }
  return seconds;
}

std::optional<double> ParseUnits(const std::string& text) {
  static const std::map<std::string, double> kUnits = {{"s", 1.0},    {"sec", 1.0},   {"m", 60.0},   {"min", 60.0},
                                                       {"h", 3600.0}, {"hr", 3600.0}, {"d", 86400.0}};
  double seconds = 0.0;
  double last_unit = 1e30;
  size_t at = 0;
  while (at < text.size()) {
    const std::optional<double> number = ReadNumber(text, &at);
    if (!number) return std::nullopt;
    std::string unit;
    while (at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) != 0) unit += text[at++];
    if (unit.empty()) {
      // A number without a unit must be the whole text: in "1h30" it could be minutes or seconds.
      if (last_unit < 1e30 || at != text.size()) return std::nullopt;
      return number;
    }
    const auto found = kUnits.find(unit);
    if (found == kUnits.end() || found->second >= last_unit) return std::nullopt;
    last_unit = found->second;
    seconds += *number * found->second;
  }
  return seconds;
}

}  // namespace

double ParseDurationSeconds(const std::string& text) {
  std::string compact;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) compact += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (compact.empty()) ThrowNotADuration(text);
  const std::optional<double> seconds = compact.find(':') != std::string::npos ? ParseClock(compact) : ParseUnits(compact);
  if (!seconds || !std::isfinite(*seconds) || *seconds <= 0.0) ThrowNotADuration(text);
  return *seconds;
}

}  // namespace skyquilt::app
