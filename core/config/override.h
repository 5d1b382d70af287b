// Sets single options from the command line (--set section.key=value); they win over configuration files.
#pragma once

#include <string>

#include "core/config/options.h"

namespace skyquilt::config {

// From the text "train.steps=4000".
struct Override {
  std::string key;    // "section.key"
  std::string value;  // as in TOML; texts may be without quotes, lists without brackets, switches 1, 0, yes or no
};
// Throws base::UsageError when the text has no '=' or nothing before it.
Override ParseOverride(const std::string& text);
// Sets the option as the line "key = value" of a TOML file would. Throws base::UsageError for an unknown section or key (with the nearest known one),
// a value of the wrong type, or one outside its range.
void ApplyOverride(const Override& entry, const Sections& sections);

}  // namespace skyquilt::config
