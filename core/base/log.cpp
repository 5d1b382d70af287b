#include "core/base/log.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "core/base/errors.h"
#include "core/base/progress.h"

namespace skyquilt::base {
namespace {

class StderrSink : public spdlog::sinks::stderr_color_sink_mt {
 public:
  void log(const spdlog::details::log_msg& message) override {
    ClearProgressLine();
    spdlog::sinks::stderr_color_sink_mt::log(message);
  }
};

// The prefix is stored as the logger's name (%n).
std::string Pattern(const std::string& time, bool with_name) {
  return "[" + time + "] " + (with_name ? "%n " : "") + "%^%l%$: %v";
}

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

}  // namespace

void InitLog(bool verbose, const std::string& prefix) {
  const auto sink = std::make_shared<StderrSink>();
  sink->set_pattern(Pattern("%H:%M:%S", !prefix.empty()));
  const auto logger = std::make_shared<spdlog::logger>(prefix, sink);
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

void AddLogFile(const std::filesystem::path& file) {
  const std::shared_ptr<spdlog::logger> logger = spdlog::default_logger();
  try {
    const auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), false);
    sink->set_pattern(Pattern("%Y-%m-%d %H:%M:%S", !logger->name().empty()));
    logger->sinks().push_back(sink);
  } catch (const spdlog::spdlog_ex& error) {
    throw InputError(file, std::string("cannot open the log: ") + error.what(), "Choose an output folder with write permission (-o)");
  }
}

LogLevel GetLogLevel() {
  for (const LogLevel level : {LogLevel::kDebug, LogLevel::kInfo, LogLevel::kWarning}) {
    if (spdlog::should_log(SpdlogLevel(level))) return level;
  }
  return LogLevel::kError;
}

void SetLogLevel(LogLevel level) {
  spdlog::set_level(SpdlogLevel(level));
}

void FlushLog() {
  spdlog::default_logger()->flush();
}

void WriteLog(LogLevel level, std::string_view message) {
  spdlog::default_logger_raw()->log(SpdlogLevel(level), spdlog::string_view_t(message.data(), message.size()));
}

void WriteLog(LogLevel level, fmt::string_view format, fmt::format_args arguments) {
  if (!spdlog::should_log(SpdlogLevel(level))) return;
  try {
    WriteLog(level, fmt::vformat(format, arguments));
  } catch (const std::exception& error) {  // as spdlog does: a message that cannot be written ends no work
    WriteLog(LogLevel::kError, std::string("cannot format a message: ") + error.what());
  }
}

}  // namespace skyquilt::base
