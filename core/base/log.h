// Logging: spdlog's default logger, to standard error and, once opened, to the project's log.txt.
// Use spdlog::info / warn / error after including this header.
#pragma once

#include <spdlog/spdlog.h>

#include <filesystem>

namespace skyquilt::base {

// Sets pattern and level. `prefix` (for instance "rank 1") is shown with every line when not empty.
void InitLog(bool verbose, const std::string& prefix = "");
// Adds a file that receives everything from here on (appended). Throws InputError if it cannot be opened.
void AddLogFile(const std::filesystem::path& file);

}  // namespace skyquilt::base
