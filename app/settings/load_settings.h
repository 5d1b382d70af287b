// Every option of the program, read in this order: defaults, the project's config.toml (commands that continue a project), --config FILE,
// --set section.key=value, command-line flags.
#pragma once

#include <filesystem>
#include <vector>

#include "coordinator/project/settings.h"
#include "core/config/override.h"

namespace skyquilt::app {

// `files` in order; ones that are not there are base::InputError. The result is checked.
coordinator::Settings LoadSettings(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& overrides);

}  // namespace skyquilt::app
