#include "core/base/log.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <mutex>

#include "core/base/errors.h"
#include "core/base/log_file.h"
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

// The log files: a sink to which others may be added while messages are written.
using Files = spdlog::sinks::dist_sink_mt;

std::shared_ptr<Files>& FilesOfLog() {
  static std::shared_ptr<Files> files = [] {
    // Until InitLog makes a logger of ours.
    auto of_default_logger = std::make_shared<Files>();
    spdlog::default_logger()->sinks().push_back(of_default_logger);
    return of_default_logger;
  }();
  return files;
}

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
  // Tests run ranks as threads, which may come here at the same time.
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  FilesOfLog() = std::make_shared<Files>();
  const auto logger = std::make_shared<spdlog::logger>(prefix, spdlog::sinks_init_list{sink, FilesOfLog()});
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

namespace {

std::shared_ptr<spdlog::sinks::sink> OpenLogFile(const std::filesystem::path& file) {
  try {
    const auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), false);
    sink->set_pattern(Pattern("%Y-%m-%d %H:%M:%S", !spdlog::default_logger()->name().empty()));
    return sink;
  } catch (const spdlog::spdlog_ex& error) {
    throw InputError(file, std::string("cannot open the log: ") + error.what(), "Choose an output folder with write permission (-o)");
  }
}

}  // namespace

void AddLogFile(const std::filesystem::path& file) {
  FilesOfLog()->add_sink(OpenLogFile(file));
}

struct LogFile::State {
  std::shared_ptr<Files> files;
  std::shared_ptr<spdlog::sinks::sink> sink;
};

LogFile::LogFile(const std::filesystem::path& file) : state_(std::make_unique<State>(State{FilesOfLog(), OpenLogFile(file)})) {
  state_->files->add_sink(state_->sink);
}

LogFile::~LogFile() {
  state_->files->remove_sink(state_->sink);
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
