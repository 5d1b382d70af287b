// Runs another program (for instance COLMAP or ffmpeg) and either reads its output or writes its input. The program is killed when the thread that
// started it ends, so that nothing keeps running after us.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace skyquilt::base {

// Full path of an executable; a name without '/' is looked up on the PATH. Empty when there is none.
std::filesystem::path FindProgram(const std::string& program);

struct Command {
  std::filesystem::path program;              // full path, from FindProgram
  std::vector<std::string> arguments;         // without the program's own name
  std::vector<std::string> environment = {};  // "NAME=value", in addition to our own
};

// A program could not be started; what() is the system's error message.
class StartError : public std::runtime_error {
 public:
  enum class Missing {
    kChannel,  // the pipe or socket for its data could not be created
    kProcess,  // fork failed
    kProgram,  // the file cannot be executed
  };
  StartError(Missing missing, int code);
  Missing missing() const { return missing_; }
  int code() const { return code_; }  // errno

 private:
  Missing missing_;
  int code_;
};

// How a program ended.
struct ChildEnd {
  int status = 0;      // exit status
  int signal = 0;      // the signal that ended it; 0: none
  int wait_error = 0;  // errno when waiting for it failed, so that its status is unknown
  // The status that a shell would show: 128 + signal when a signal ended it.
  int ShellStatus() const { return signal == 0 ? status : 128 + signal; }
  // Empty on success, otherwise the reason of the failure in words; `name` is the program's name.
  std::string Text(const std::string& name) const;
};

class ChildProcess {
 public:
  // Its output (stdout and stderr) is read with Receive, its input is empty. It leads a process group of its own, so that the processes it starts are
  // ended with it. Throws StartError.
  static ChildProcess StartReading(const Command& command);
  // The same, but stdout and stderr are read apart, with ReceiveBoth: for programs that write data to one and messages to the other. Throws
  // StartError.
  static ChildProcess StartReadingBoth(const Command& command);
  // Its input is written with Send, its output goes where our own goes. It stays in our process group: a signal from the terminal (Ctrl-C) reaches it
  // too. Throws StartError.
  static ChildProcess StartWriting(const Command& command);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();  // kills the program if it still runs

  // Appends new output to `text`; waits at most 0.2 s for it, so it may append nothing. False at the end of the output.
  bool Receive(std::string* text);
  // Appends new output and new messages, of whichever there is some; waits at most 0.2 s, so it may append nothing. False at the end of both. Only
  // after StartReadingBoth.
  bool ReceiveBoth(std::string* output, std::string* messages);
  // Blocks until all bytes are written. False when the program has ended; Wait then tells why. Never raises SIGPIPE.
  bool Send(std::span<const uint8_t> bytes);
  // Closes our end of the pipe or socket and waits until the program ends.
  ChildEnd Wait();
  // Sends SIGTERM, and SIGKILL if the program still runs after 5 s.
  void Terminate();

 private:
  enum class Channels { kWriting, kReading, kReadingBoth };

  ChildProcess(pid_t process, int channel, int messages, bool leads_group)
      : process_(process), channel_(channel), messages_(messages), leads_group_(leads_group) {}
  static ChildProcess Start(const Command& command, Channels channels);
  void CloseChannels();
  void Signal(int number) const;

  pid_t process_ = -1;
  int channel_ = -1;
  int messages_ = -1;  // its stderr, where that is read apart
  bool leads_group_ = false;
};

// Runs a program to its end. Its output is appended to the file `log`, and every line of it is passed to on_line (may be empty). Returns the exit
// status as a shell shows it: 128 + signal, or 127 for a file that cannot be executed. When CancelRequested() becomes true, the program is terminated
// (within 0.2 s plus the 5 s of Terminate) and Interrupted thrown. Throws InputError if the program cannot be started or the log cannot be written.
int RunLogged(const Command& command, const std::filesystem::path& log, const std::function<void(const std::string& line)>& on_line);

}  // namespace skyquilt::base
