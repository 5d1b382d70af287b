// Another program, run to its end while its output is read line by line.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace skyquilt::prepare {

// A bare name is looked up on the PATH. Empty when there is no such executable.
std::filesystem::path FindProgram(const std::string& program);

struct ChildProcess {
  std::filesystem::path program;
  std::vector<std::string> arguments;                    // without the program's own name
  std::vector<std::string> environment;                  // "NAME=value", in addition to our own
  std::filesystem::path log;                             // stdout and stderr are appended
  std::function<void(const std::string& line)> on_line;  // may be empty
};

// Exit status, or 128 + signal when a signal ended it. The child dies with us, and when base::CancelRequested() is seen (within 0.2 s) it is
// terminated, after 5 s killed, and base::Interrupted is thrown. Throws base::InputError if it cannot be started or the log not be written.
int RunChild(const ChildProcess& child);

}  // namespace skyquilt::prepare
