// Fields of the tables that `prepare` writes (CSV, RFC 4180).
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace skyquilt::prepare::tables {

// With fixed decimals; empty for what is unknown (not finite).
inline std::string CsvNumber(double value, int digits) {
  if (!std::isfinite(value)) return "";
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
  return buffer;
}

// Quoted where it must be.
inline std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char character : text) quoted += character == '"' ? std::string("\"\"") : std::string(1, character);
  return quoted + "\"";
}

}  // namespace skyquilt::prepare::tables
