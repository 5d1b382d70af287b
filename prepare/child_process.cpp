#include "prepare/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/base/cancel.h"
#include "core/base/errors.h"

extern char** environ;

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

constexpr int kPollMs = 200;
constexpr int kCannotExecute = 127;
constexpr std::chrono::seconds kGrace(5);

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
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

int ExitStatus(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

int WaitFor(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

// The child leads its own process group, so that what it started ends too.
void Terminate(pid_t pid) {
  // Both: a child that has not yet made its group is reached by its own number only.
  kill(pid, SIGTERM);
  kill(-pid, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kGrace;
  int status = 0;
  while (std::chrono::steady_clock::now() < deadline) {
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    if (ended == pid || (ended < 0 && errno == ECHILD)) return;
    usleep(20'000);
  }
  kill(-pid, SIGKILL);
  WaitFor(pid);
}

class PipeEnd {
 public:
  explicit PipeEnd(int descriptor) : descriptor_(descriptor) {}
  ~PipeEnd() { Close(); }
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

pid_t Start(const ChildProcess& child, int output) {
  // Everything the child needs is made before the fork: after it only async-signal-safe calls are allowed, as other threads may hold locks.
  std::vector<std::string> arguments = {child.program.string()};
  arguments.insert(arguments.end(), child.arguments.begin(), child.arguments.end());
  std::vector<std::string> environment = Environment(child.environment);
  const std::vector<char*> argument_pointers = Pointers(arguments);
  const std::vector<char*> environment_pointers = Pointers(environment);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid > 0) setpgid(pid, pid);  // in both, so that the group exists whoever comes first
  if (pid != 0) return pid;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCannotExecute);
  const int input = open("/dev/null", O_RDONLY);
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execve(argument_pointers[0], argument_pointers.data(), environment_pointers.data());
  _exit(kCannotExecute);
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

int RunChild(const ChildProcess& child) {
  base::ThrowIfCancelled();
  std::ofstream log(child.log, std::ios::app | std::ios::binary);
  if (!log) throw base::InputError(child.log, "cannot be written", "Check permissions and free space");
  log << "$ " << child.program.string();
  for (const std::string& argument : child.arguments) log << " " << argument;
  log << std::endl;

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw base::InputError(child.program, std::string("no pipe: ") + std::strerror(errno), "Close other programs");
  PipeEnd read_end(ends[0]);
  PipeEnd write_end(ends[1]);
  const pid_t pid = Start(child, write_end.get());
  if (pid < 0)
    throw base::InputError(child.program, std::string("cannot be started: ") + std::strerror(errno), "Close other programs or free memory");
  write_end.Close();

  std::string line;
  try {
    std::array<char, 4096> buffer{};
    while (true) {
      if (base::CancelRequested()) throw base::Interrupted();
      pollfd waiting{read_end.get(), POLLIN, 0};
      const int ready = poll(&waiting, 1, kPollMs);
      if (ready < 0 && errno != EINTR) break;
      if (ready <= 0) continue;
      const ssize_t n_read = read(read_end.get(), buffer.data(), buffer.size());
      if (n_read < 0 && errno == EINTR) continue;
      if (n_read <= 0) break;
      log.write(buffer.data(), n_read);
      log.flush();
      for (ssize_t i = 0; i < n_read; ++i) {
        const char character = buffer[static_cast<size_t>(i)];
        if (character != '\n' && character != '\r') {
          line += character;
          continue;
        }
        if (child.on_line && !line.empty()) child.on_line(line);
        line.clear();
      }
    }
  } catch (...) {
    Terminate(pid);
    throw;
  }
  if (child.on_line && !line.empty()) child.on_line(line);
  const int status = ExitStatus(WaitFor(pid));
  log << "# exit status " << status << std::endl;
  return status;
}

}  // namespace skyquilt::prepare
