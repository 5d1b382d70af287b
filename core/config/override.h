// Single options as typed on a command line, in place of a file's.
#pragma once

#include <string>

#include "core/config/options.h"

namespace skyquilt::config {

// An option as typed: "train.steps=4000".
struct Override {
  std::string key;    // "section.key"
  std::string value;  // as in TOML, strings without quotes; lists separated by commas
};
// Throws base::UsageError when the text has no '='.
Override ParseOverride(const std::string& text);
// Throws base::UsageError for an unknown section or key (naming the nearest) and for a value of the wrong type.
void ApplyOverride(const Override& entry, Sections& sections);

}  // namespace skyquilt::config
