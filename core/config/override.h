// Single options as typed on a command line, in place of a file's.
#pragma once

#include <string>

#include "core/config/options.h"

namespace skyquilt::config {

// An option as typed: "train.steps=4000".
struct Override {
  std::string key;    // "section.key"
  std::string value;  // as in TOML; texts may stand without quotes, lists without brackets
};
// Throws base::UsageError when the text has no '='.
Override ParseOverride(const std::string& text);
// Reads it as the line "key = value" of a TOML file would be. Throws base::UsageError for an unknown section or key (naming the nearest), a value
// of the wrong type, or one that is not allowed.
void ApplyOverride(const Override& entry, const Sections& sections);

}  // namespace skyquilt::config
