// The presets of configs/, built into the program.
#pragma once

#include <string>
#include <vector>

#include "coordinator/project/settings.h"

namespace skyquilt::app {

// "fast", "default", "quality": from the quickest to the best.
std::vector<std::string> PresetNames();
// What a preset sets differently from the defaults. Throws base::UsageError for an unknown name.
std::vector<config::Override> PresetOverrides(const std::string& name);

}  // namespace skyquilt::app
