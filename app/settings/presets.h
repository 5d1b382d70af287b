// The presets: named configurations, stored in configs/ and built into the program. Most trade training time for quality; one is for photos that look
// level; those in configs/methods/ make the field that of a published method.
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
// Networks first, the program's own field last. All name the same options, so that one method leaves nothing of another.
std::vector<std::string> MethodNames();
// All of these: what --config takes beside a file.
std::vector<std::string> ConfigNames();
// The options that a preset names, also where they have the default's value. Throws base::UsageError for an unknown name.
std::vector<config::Override> PresetOverrides(const std::string& name);

}  // namespace skyquilt::app
