// Settings from what a user chose: a configuration by its file or by the name of a preset, and single options.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/project/settings.h"
#include "core/config/override.h"

namespace skyquilt::app {

struct Choice {
  std::string config;                            // a TOML file, or the name of a preset; empty: neither
  std::vector<config::Override> overrides = {};  // later ones win
};

// In this order, later ones win: defaults, `files` (but not with the configuration "default"), the configuration, the overrides. All throw
// base::InputError for a file that cannot be read and for a configuration that is neither file nor preset, base::UsageError for wrong options.
coordinator::Settings ChosenSettings(const std::vector<std::filesystem::path>& files, const Choice& choice);
// The given settings (defaults with the configuration "default"), changed by the choice.
coordinator::Settings ChosenOver(coordinator::Settings settings, const Choice& choice);
// What ChosenSettings({}, choice) gives if the photos look level (coordinator::Pipeline::level_settings): with the preset "level" below all else that
// is given. Not checked, as most photos do not; none when the configuration is "default" or "level".
std::optional<coordinator::Settings> ChosenForLevelPhotos(const Choice& choice);

}  // namespace skyquilt::app
