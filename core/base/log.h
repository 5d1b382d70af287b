// Logging: spdlog's default logger, to standard error and, once opened, to the project's log.txt.
// Use spdlog::info / warn / error after including this header.
#pragma once

#include <spdlog/spdlog.h>

#include <filesystem>

namespace skyquilt::base {

// Sets the line format and the level (debug if verbose, else info). `prefix` (for instance "rank 1") is shown on every line when not empty.
void InitLog(bool verbose, const std::string& prefix = "");
// Also appends all later messages to this file. Throws InputError if it cannot be opened.
void AddLogFile(const std::filesystem::path& file);

}  // namespace skyquilt::base
