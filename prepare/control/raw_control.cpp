#include "prepare/control/raw_control.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::prepare {

std::optional<double> ParseControlNumber(const std::string& text, bool decimal_comma) {
  std::string number = text.starts_with('+') ? text.substr(1) : text;
  if (decimal_comma && number.find('.') == std::string::npos && std::count(number.begin(), number.end(), ',') == 1) {
    number[number.find(',')] = '.';
  }
  double value = 0.0;
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  if (result.ec != std::errc() || result.ptr != number.data() + number.size() || !(std::abs(value) <= 1e9)) return std::nullopt;
  return value;
}

void FailControlLine(const std::filesystem::path& file, int line, const std::string& found, const std::string& fix) {
  throw base::InputError(file, (line > 0 ? "line " + std::to_string(line) + ": " : "") + found, fix);
}

}  // namespace skyquilt::prepare
