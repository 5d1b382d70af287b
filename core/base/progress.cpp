#include "core/base/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <utility>

#include "core/base/amounts.h"

namespace skyquilt::base {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kTerminalInterval_s = 0.2;
constexpr double kFileInterval_s = 8.0;  // a log is never silent for ten seconds
constexpr int kBarWidth = 24;

std::atomic<bool> quiet_everywhere{false};

std::atomic<bool> has_listener{false};
std::mutex listener_mutex;
std::function<void(const std::string& label, double share)> progress_listener;

// All progress lines share standard error: guards line_drawn, which is true while a terminal's current line shows one.
std::mutex terminal_mutex;
bool line_drawn = false;

template <typename... Args>
std::string Format(const char* format, Args... args) {
  std::array<char, 128> text;
  const int n = std::snprintf(text.data(), text.size(), format, args...);
  return {text.data(), static_cast<size_t>(std::clamp(n, 0, static_cast<int>(text.size()) - 1))};
}

size_t TerminalWidth() {
  struct winsize size = {};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

}  // namespace

struct Progress::State {
  std::mutex mutex;
  std::string label;
  double total = 0.0;
  std::string unit;
  std::string detail;
  double done = 0.0;
  double done_before = 0.0;
  Clock::time_point start = Clock::now();
  Clock::time_point last_draw = start;
  bool is_terminal = isatty(STDERR_FILENO) != 0;
  bool finished = false;
  Clock::time_point last_told = start;

  void Tell() {
    if (!has_listener.load() || total <= 0.0) return;
    const Clock::time_point now = Clock::now();
    if (!finished && std::chrono::duration<double>(now - last_told).count() < kTerminalInterval_s) return;
    last_told = now;
    const std::lock_guard lock(listener_mutex);
    if (progress_listener) progress_listener(label, finished ? 1.0 : std::clamp(done / total, 0.0, 1.0));
  }

  std::string Line(double elapsed_s) const {
    const double rate = elapsed_s > 0.0 ? std::max(0.0, done - done_before) / elapsed_s : 0.0;
    std::string line = label + " ";
    if (total > 0.0) {
      const double share = std::clamp(done / total, 0.0, 1.0);
      const auto n_full = static_cast<size_t>(share * kBarWidth);
      line.append("[").append(n_full, '#').append(kBarWidth - n_full, '.').append("] ").append(Format("%3.0f %%", std::floor(share * 100.0)));
    } else {
      line += FormatCount(done) + " " + unit;
    }
    line.append("  ").append(FormatCount(rate)).append(" ").append(unit).append("/s  ").append(FormatDuration(elapsed_s));
    if (total > 0.0 && !finished && rate > 0.0) line.append(", ").append(FormatDuration(std::max(0.0, total - done) / rate)).append(" left");
    if (!detail.empty()) line += "  " + detail;
    return line;
  }

  void Draw(bool force) {
    if (quiet_everywhere.load()) return;
    const Clock::time_point now = Clock::now();
    const double since_last_s = std::chrono::duration<double>(now - last_draw).count();
    if (!force && since_last_s < (is_terminal ? kTerminalInterval_s : kFileInterval_s)) return;
    last_draw = now;
    std::string line = Line(std::chrono::duration<double>(now - start).count());
    const std::lock_guard lock(terminal_mutex);
    if (is_terminal) {
      // A line that wraps could not be redrawn in place.
      line.resize(std::min(line.size(), TerminalWidth() - 1));
      line.insert(0, 1, '\r');
      line += "\x1b[K";
      if (finished) line += "\n";
      line_drawn = !finished;
    } else {
      line += "\n";
    }
    std::fwrite(line.data(), 1, line.size(), stderr);
    std::fflush(stderr);
  }
};

Progress::Progress(const std::string& label, double total, const std::string& unit, double done_before) : state_(std::make_unique<State>()) {
  state_->label = label;
  state_->total = total;
  state_->unit = unit;
  state_->done = state_->done_before = done_before;
}

Progress::~Progress() {
  if (state_->finished) return;
  // Finish was not called, because of an exception: the line keeps its last state.
  const std::lock_guard lock(terminal_mutex);
  if (state_->is_terminal && line_drawn) std::fputc('\n', stderr);
  line_drawn = false;
}

void Progress::Update(double done, const std::string& detail) {
  const std::lock_guard lock(state_->mutex);
  if (state_->finished) return;
  state_->done = done;
  if (!detail.empty()) state_->detail = detail;
  state_->Draw(false);
  state_->Tell();
}

void Progress::Advance(double by, const std::string& detail) {
  const std::lock_guard lock(state_->mutex);
  if (state_->finished) return;
  state_->done += by;
  if (!detail.empty()) state_->detail = detail;
  state_->Draw(false);
  state_->Tell();
}

void Progress::Finish(const std::string& detail) {
  const std::lock_guard lock(state_->mutex);
  if (state_->finished) return;
  state_->finished = true;
  if (!detail.empty()) state_->detail = detail;
  state_->Draw(true);
  state_->Tell();
}

void Progress::SetQuiet(bool quiet) {
  quiet_everywhere.store(quiet);
}

void Progress::SetListener(std::function<void(const std::string& label, double share)> listener) {
  const std::lock_guard lock(listener_mutex);
  has_listener.store(static_cast<bool>(listener));
  progress_listener = std::move(listener);
}

void ClearProgressLine() {
  const std::lock_guard lock(terminal_mutex);
  if (!line_drawn) return;
  std::fputs("\r\x1b[K", stderr);
  line_drawn = false;
}

}  // namespace skyquilt::base
