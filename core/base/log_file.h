// A log file for a part of a process: for programs that work on one project after the other.
#pragma once

#include <filesystem>
#include <memory>

namespace skyquilt::base {

// Messages are appended to the file too, as AddLogFile does, until this object is gone.
class LogFile {
 public:
  // Throws InputError if the file cannot be opened.
  explicit LogFile(const std::filesystem::path& file);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace skyquilt::base
