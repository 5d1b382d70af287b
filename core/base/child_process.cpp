#include "core/base/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"

extern char** environ;

namespace skyquilt::base {
namespace {

namespace fs = std::filesystem;

constexpr int kPollMs = 200;
constexpr int kCannotExecute = 127;
constexpr std::chrono::seconds kGrace(5);

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> Environment(const std::vector<std::string>& additions) {
  std::vector<std::string> environment = additions;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('=') + 1);
    bool replaced = false;
    for (const std::string& addition : additions) replaced = replaced || addition.starts_with(name);
    if (!replaced) environment.push_back(text);
  }
  return environment;
}

class ChannelEnd {
 public:
  explicit ChannelEnd(int number) : number_(number) {}
  ~ChannelEnd() { Close(); }
  ChannelEnd(const ChannelEnd&) = delete;
  ChannelEnd& operator=(const ChannelEnd&) = delete;
  void Close() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }
  int get() const { return number_; }
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

ssize_t ReadAgain(int descriptor, void* bytes, size_t size) {
  ssize_t n_read = 0;
  do {
    n_read = read(descriptor, bytes, size);
  } while (n_read < 0 && errno == EINTR);
  return n_read;
}

// The child's errno when execve failed. 0 when it succeeded: execve then closes the child's end of the pipe.
int ExecutionError(int pipe) {
  int code = 0;
  return ReadAgain(pipe, &code, sizeof(code)) == static_cast<ssize_t>(sizeof(code)) ? code : 0;
}

ChildEnd WaitFor(pid_t process) {
  // waitpid would wait for any child.
  if (process <= 0) return {.wait_error = ECHILD};
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return {.wait_error = errno};
  }
  if (WIFSIGNALED(status)) return {.signal = WTERMSIG(status)};
  return {.status = WEXITSTATUS(status)};
}

void LogCommand(std::ofstream& log, const Command& command) {
  log << "$ " << command.program.string();
  for (const std::string& argument : command.arguments) log << " " << argument;
  log << std::endl;
}

int LogEnd(std::ofstream& log, int status) {
  log << "# exit status " << status << std::endl;
  return status;
}

// Takes the complete lines from the front of `text`; empty ones are left out.
void TakeLines(std::string* text, const std::function<void(const std::string& line)>& on_line) {
  size_t begin = 0;
  for (size_t end = text->find_first_of("\n\r"); end != std::string::npos; end = text->find_first_of("\n\r", begin)) {
    if (on_line && end > begin) on_line(text->substr(begin, end - begin));
    begin = end + 1;
  }
  text->erase(0, begin);
}

}  // namespace

fs::path FindProgram(const std::string& program) {
  const auto executable = [](const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
  };
  if (program.find('/') != std::string::npos) return executable(program) ? fs::absolute(program) : fs::path();
  const char* path = std::getenv("PATH");
  std::string rest = path == nullptr ? "/usr/local/bin:/usr/bin:/bin" : path;
  while (!rest.empty()) {
    const size_t colon = std::min(rest.find(':'), rest.size());
    const fs::path candidate = fs::path(rest.substr(0, colon)) / program;
    if (executable(candidate)) return fs::absolute(candidate);
    rest.erase(0, std::min(colon + 1, rest.size()));
  }
  return {};
}

StartError::StartError(Missing missing, int code) : std::runtime_error(std::strerror(code)), missing_(missing), code_(code) {}

std::string ChildEnd::Text(const std::string& name) const {
  if (wait_error != 0) return "waiting for " + name + " failed: " + std::strerror(wait_error);
  if (signal != 0) return name + " was ended by signal " + std::to_string(signal);
  return status == 0 ? "" : name + " ended with status " + std::to_string(status);
}

ChildProcess ChildProcess::StartReading(const Command& command) {
  return Start(command, Channels::kReading);
}

ChildProcess ChildProcess::StartReadingBoth(const Command& command) {
  return Start(command, Channels::kReadingBoth);
}

ChildProcess ChildProcess::StartWriting(const Command& command) {
  return Start(command, Channels::kWriting);
}

ChildProcess ChildProcess::Start(const Command& command, Channels channels) {
  const bool reading = channels != Channels::kWriting;
  std::array<int, 2> ends{}, pipe_ends{}, message_ends = {-1, -1};
  // For writing use a socket instead of a pipe: send() can be told not to raise SIGPIPE when the program has ended.
  if ((reading ? pipe2(ends.data(), O_CLOEXEC) : socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data())) != 0)
    throw StartError(StartError::Missing::kChannel, errno);
  ChannelEnd ours(ends[0]), its(ends[1]);
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) throw StartError(StartError::Missing::kChannel, errno);
  ChannelEnd failure(pipe_ends[0]), its_failure(pipe_ends[1]);
  if (channels == Channels::kReadingBoth && pipe2(message_ends.data(), O_CLOEXEC) != 0) throw StartError(StartError::Missing::kChannel, errno);
  ChannelEnd messages(message_ends[0]), its_messages(message_ends[1]);
  // Allocate before the fork: after it only async-signal-safe calls are allowed in the child, as other threads may have held locks.
  std::vector<std::string> arguments = {command.program.string()};
  arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
  std::vector<std::string> environment = Environment(command.environment);
  const std::vector<char*> argument_pointers = Pointers(arguments);
  const std::vector<char*> environment_pointers = Pointers(environment);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process < 0) throw StartError(StartError::Missing::kProcess, errno);
  if (process == 0) {
    if (reading) setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kCannotExecute);
    dup2(reading ? open("/dev/null", O_RDONLY) : its.get(), STDIN_FILENO);
    if (reading) {
      dup2(its.get(), STDOUT_FILENO);
      dup2(channels == Channels::kReadingBoth ? its_messages.get() : its.get(), STDERR_FILENO);
    }
    execve(argument_pointers[0], argument_pointers.data(), environment_pointers.data());
    const int code = errno;
    [[maybe_unused]] const ssize_t told = write(its_failure.get(), &code, sizeof(code));
    _exit(kCannotExecute);
  }
  its.Close();
  its_messages.Close();
  its_failure.Close();
  if (const int code = ExecutionError(failure.get()); code != 0) {
    WaitFor(process);
    throw StartError(StartError::Missing::kProgram, code);
  }
  return ChildProcess(process, ours.Release(), messages.Release(), reading);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      channel_(std::exchange(other.channel_, -1)),
      messages_(std::exchange(other.messages_, -1)),
      leads_group_(other.leads_group_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(channel_, other.channel_);
  std::swap(messages_, other.messages_);
  std::swap(leads_group_, other.leads_group_);
  return *this;
}

ChildProcess::~ChildProcess() {
  CloseChannels();
  if (process_ <= 0) return;
  Signal(SIGKILL);
  WaitFor(process_);
}

bool ChildProcess::Receive(std::string* text) {
  pollfd waiting{channel_, POLLIN, 0};
  const int ready = poll(&waiting, 1, kPollMs);
  if (ready <= 0) return ready == 0 || errno == EINTR;
  std::array<char, 4096> buffer{};
  const ssize_t n_read = ReadAgain(channel_, buffer.data(), buffer.size());
  if (n_read <= 0) return false;
  text->append(buffer.data(), static_cast<size_t>(n_read));
  return true;
}

bool ChildProcess::ReceiveBoth(std::string* output, std::string* messages) {
  // poll ignores what is closed, which is -1.
  std::array<pollfd, 2> waiting = {pollfd{channel_, POLLIN, 0}, pollfd{messages_, POLLIN, 0}};
  if (channel_ < 0 && messages_ < 0) return false;
  const int ready = poll(waiting.data(), waiting.size(), kPollMs);
  if (ready <= 0) return ready == 0 || errno == EINTR;
  std::array<char, 65536> buffer{};
  const auto read_one = [&buffer](const pollfd& one, int* channel, std::string* text) {
    if ((one.revents & (POLLIN | POLLHUP | POLLERR)) == 0) return;
    const ssize_t n_read = ReadAgain(one.fd, buffer.data(), buffer.size());
    if (n_read > 0) {
      text->append(buffer.data(), static_cast<size_t>(n_read));
    } else {
      close(std::exchange(*channel, -1));
    }
  };
  // Messages first: they say what the data that follow are.
  read_one(waiting[1], &messages_, messages);
  read_one(waiting[0], &channel_, output);
  return channel_ >= 0 || messages_ >= 0;
}

bool ChildProcess::Send(std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(channel_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(sent));
  }
  return true;
}

ChildEnd ChildProcess::Wait() {
  CloseChannels();
  return WaitFor(std::exchange(process_, -1));
}

void ChildProcess::Terminate() {
  if (process_ <= 0) return;
  Signal(SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kGrace;
  while (std::chrono::steady_clock::now() < deadline) {
    const pid_t ended = waitpid(process_, nullptr, WNOHANG);
    if (ended == process_ || (ended < 0 && errno == ECHILD)) {
      process_ = -1;
      return;
    }
    usleep(20'000);
  }
  Signal(SIGKILL);
  WaitFor(std::exchange(process_, -1));
}

void ChildProcess::CloseChannels() {
  for (int* channel : {&channel_, &messages_}) {
    if (*channel >= 0) close(std::exchange(*channel, -1));
  }
}

void ChildProcess::Signal(int number) const {
  kill(leads_group_ ? -process_ : process_, number);
}

int RunLogged(const Command& command, const fs::path& log_file, const std::function<void(const std::string& line)>& on_line) {
  ThrowIfCancelled();
  std::ofstream log(log_file, std::ios::app | std::ios::binary);
  if (!log) throw InputError(log_file, "cannot be written", "Check permissions and free space");
  LogCommand(log, command);
  try {
    ChildProcess child = ChildProcess::StartReading(command);
    std::string unfinished;
    try {
      while (true) {
        ThrowIfCancelled();
        std::string text;
        if (!child.Receive(&text)) break;
        log << text << std::flush;
        unfinished += text;
        TakeLines(&unfinished, on_line);
      }
    } catch (...) {
      child.Terminate();
      throw;
    }
    if (on_line && !unfinished.empty()) on_line(unfinished);
    return LogEnd(log, child.Wait().ShellStatus());
  } catch (const StartError& error) {
    if (error.missing() == StartError::Missing::kProgram) return LogEnd(log, kCannotExecute);
    const bool channel = error.missing() == StartError::Missing::kChannel;
    throw InputError(command.program, std::string(channel ? "cannot be started, no pipe could be created: " : "cannot be started: ") + error.what(),
                     channel ? "Raise the limit of open files (ulimit -n) or close other programs" : "Close other programs or free memory");
  }
}

}  // namespace skyquilt::base
