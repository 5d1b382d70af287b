// Every option of the program, read in this order: defaults, the project's config.toml (commands that continue a project), --config FILE,
// --set section.key=value, command-line flags.
#pragma once

#include <filesystem>
#include <vector>

#include "coordinator/project/settings.h"
#include "core/config/override.h"

namespace skyquilt::app {

// Later files and overrides win. The result is checked. Throws base::InputError for a missing or unreadable file, base::UsageError for a wrong
// option.
coordinator::Settings LoadSettings(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& overrides);

}  // namespace skyquilt::app
