#include "core/base/log.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>
#include <string>

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

}  // namespace skyquilt::base
