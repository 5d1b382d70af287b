// The presets: named configurations, stored in configs/ and built into the program. Most trade training time for quality; one is for photos that look
// level.
#pragma once

#include <string>
#include <vector>

#include "coordinator/project/settings.h"

namespace skyquilt::app {

constexpr const char* kLevelPreset = "level";

// "fast", "default", "quality": from the fastest to the best result.
std::vector<std::string> QualityPresets();
// These, and kLevelPreset.
std::vector<std::string> PresetNames();
// The options in which a preset differs from the defaults, without those that follow from others. Throws base::UsageError for an unknown name.
std::vector<config::Override> PresetOverrides(const std::string& name);

}  // namespace skyquilt::app
