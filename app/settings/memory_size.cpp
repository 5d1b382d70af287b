#include "app/settings/memory_size.h"

#include <cctype>
#include <charconv>
#include <cstdio>
#include <map>

#include "core/base/errors.h"

namespace skyquilt::app {

double ParseBytes(const std::string& text) {
  static const std::map<std::string, double> kUnits = {{"", 1.0},
                                                       {"b", 1.0},
                                                       {"k", 1024.0},
                                                       {"m", 1048576.0},
                                                       {"g", 1073741824.0},
                                                       {"kb", 1e3},
                                                       {"mb", 1e6},
                                                       {"gb", 1e9},
                                                       {"tb", 1e12},
                                                       {"kib", 1024.0},
                                                       {"mib", 1048576.0},
                                                       {"gib", 1073741824.0},
                                                       {"t", 1099511627776.0},
                                                       {"tib", 1099511627776.0}};
  std::string compact;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) compact += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  size_t digits = 0;
  while (digits < compact.size() && (std::isdigit(static_cast<unsigned char>(compact[digits])) != 0 || compact[digits] == '.')) ++digits;
  double number = 0.0;
  const auto [end, error] = std::from_chars(compact.data(), compact.data() + digits, number);
  const bool read = error == std::errc() && end == compact.data() + digits;
  const auto unit = kUnits.find(compact.substr(digits));
  if (!read || unit == kUnits.end() || !(number > 0.0)) {
    throw base::UsageError("'" + text + "' is not an amount of memory. Write for instance 2GiB, 1500MB or plain bytes");
  }
  return number * unit->second;
}

std::string FormatGib(double bytes) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.9g", bytes / 1073741824.0);
  return text;
}

}  // namespace skyquilt::app
