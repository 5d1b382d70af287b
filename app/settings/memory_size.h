// Amounts of memory as people write them: "2GiB", "1500MB", "1.5G" (binary) and plain bytes "2147483648".
#pragma once

#include <string>

namespace skyquilt::app {

// Bytes, > 0. Throws base::UsageError quoting the text and showing examples.
double ParseBytes(const std::string& text);
// The size in GiB as decimal text with 9 significant digits.
std::string FormatGib(double bytes);

}  // namespace skyquilt::app
