// Another program, run while we live: it dies with us (with the thread that started it). Either we read what it says, or we write what it reads.
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

// A bare name is looked up on the PATH. Empty when there is no such executable.
std::filesystem::path FindProgram(const std::string& program);

struct Command {
  std::filesystem::path program;              // as FindProgram gives it
  std::vector<std::string> arguments;         // without the program's own name
  std::vector<std::string> environment = {};  // "NAME=value", in addition to our own
};

// Why a program does not run. what() is the system's word for it.
class StartError : public std::runtime_error {
 public:
  enum class Missing {
    kChannel,  // no pipe or socket to talk to it
    kProcess,  // no process to run it in
    kProgram,  // the file cannot be executed
  };
  StartError(Missing missing, int code);
  Missing missing() const { return missing_; }
  int code() const { return code_; }  // errno

 private:
  Missing missing_;
  int code_;
};

struct ChildEnd {
  int status = 0;      // exit status
  int signal = 0;      // that ended it, 0: none did
  int wait_error = 0;  // errno when nobody knows how it ended
  // As a shell counts: 128 + signal when a signal ended it.
  int ShellStatus() const { return signal == 0 ? status : 128 + signal; }
  // Empty when it went well, otherwise a sentence about `name`.
  std::string Text(const std::string& name) const;
};

class ChildProcess {
 public:
  // What it prints (stdout and stderr) comes to us, its input is empty. It leads a process group, so that what it starts ends with it.
  // Throws StartError.
  static ChildProcess StartReading(const Command& command);
  // We write its input; what it prints goes where our own does. It stays in our process group: a signal from the terminal reaches it too.
  // Throws StartError.
  static ChildProcess StartWriting(const Command& command);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();  // kills it if it still runs

  // Appends what it printed since, perhaps nothing: waits 0.2 s for it. False at the end of its output.
  bool Receive(std::string* text);
  // False when the program went away; Wait then tells why. Never raises SIGPIPE.
  bool Send(std::span<const uint8_t> bytes);
  // Closes our side of the channel and waits for the end.
  ChildEnd Wait();
  // Asks it to end, and kills it after 5 s.
  void Terminate();

 private:
  ChildProcess(pid_t process, int channel, bool leads_group) : process_(process), channel_(channel), leads_group_(leads_group) {}
  static ChildProcess Start(const Command& command, bool reading);
  void CloseChannel();
  void Signal(int number) const;

  pid_t process_ = -1;
  int channel_ = -1;
  bool leads_group_ = false;
};

// Runs a program to its end; what it prints is appended to `log` and told line by line (on_line may be empty). Exit status as a shell counts: 128 +
// signal, 127 for a file that cannot be executed. When CancelRequested() is seen (within 0.2 s) the program is terminated and Interrupted thrown.
// Throws InputError if it cannot be started or the log not be written.
int RunLogged(const Command& command, const std::filesystem::path& log, const std::function<void(const std::string& line)>& on_line);

}  // namespace skyquilt::base
