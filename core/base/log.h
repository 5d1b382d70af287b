// Logging: to standard error and, once opened, to the project's log.txt. Formats are fmt's: base::LogInfo("{} of {} blocks", done, all).
// spdlog writes; its header, whose templates cost every file that uses them three seconds of compiling, is included in log.cpp only.
#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace skyquilt::base {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

// Sets the line format and the level (debug if verbose, else info). `prefix` (for instance "rank 1") is shown on every line when not empty.
void InitLog(bool verbose, const std::string& prefix = "");
// Also appends all later messages to this file. Throws InputError if it cannot be opened.
void AddLogFile(const std::filesystem::path& file);

// Messages below this level are dropped.
LogLevel GetLogLevel();
void SetLogLevel(LogLevel level);
void FlushLog();

// A message as it is, and one to be formatted. Safe from several threads.
void WriteLog(LogLevel level, std::string_view message);
void WriteLog(LogLevel level, fmt::string_view format, fmt::format_args arguments);

inline void LogDebug(std::string_view message) {
  WriteLog(LogLevel::kDebug, message);
}
inline void LogInfo(std::string_view message) {
  WriteLog(LogLevel::kInfo, message);
}
inline void LogWarning(std::string_view message) {
  WriteLog(LogLevel::kWarning, message);
}
inline void LogError(std::string_view message) {
  WriteLog(LogLevel::kError, message);
}

template <typename First, typename... Rest>
void LogDebug(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  WriteLog(LogLevel::kDebug, format, fmt::make_format_args(first, rest...));
}
template <typename First, typename... Rest>
void LogInfo(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  WriteLog(LogLevel::kInfo, format, fmt::make_format_args(first, rest...));
}
template <typename First, typename... Rest>
void LogWarning(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  WriteLog(LogLevel::kWarning, format, fmt::make_format_args(first, rest...));
}
template <typename First, typename... Rest>
void LogError(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  WriteLog(LogLevel::kError, format, fmt::make_format_args(first, rest...));
}

}  // namespace skyquilt::base
