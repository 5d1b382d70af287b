#include "odm/stage_lines.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/base/progress.h"

namespace skyquilt::odm {
namespace {

constexpr double kSecondsBetween = 1.0;
// A step shows several bars one after the other, of unknown number: each takes this share of what is left of the step, but for those that are nearly
// all of it.
constexpr double kBarShare = 0.5, kMainBarShare = 0.95;

bool IsMainBar(const std::string& label) {
  return label == "blocks" || label == "surface texture" || label == "orthophoto" || label == "evaluate";
}

}  // namespace

StageLines::StageLines(std::string dataset, int port)
    : dataset_(std::move(dataset)), socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)), port_(port) {
  base::Progress::SetListener([this](const std::string& label, double share) { Report(label, share); });
}

StageLines::~StageLines() {
  base::Progress::SetListener({});
  if (socket_ >= 0) close(socket_);
}

void StageLines::Begin(const Step& step) {
  for (const std::string& name : step.odm_stages) Say("Running " + name + " stage");
  const std::lock_guard lock(mutex_);
  step_ = &step;
  label_.clear();
  begin_ = step.progress_from;
  Send(step.progress_from, true);
}

void StageLines::End(const Step& step) {
  for (const std::string& name : step.odm_stages) Say("Finished " + name + " stage");
  const std::lock_guard lock(mutex_);
  step_ = nullptr;
  Send(step.progress_to, true);
}

void StageLines::Say(const std::string& line) {
  base::ClearProgressLine();
  fmt::print("[INFO]    {}\n", line);
  std::fflush(stdout);
}

void StageLines::Report(const std::string& label, double share) {
  const std::lock_guard lock(mutex_);
  if (step_ == nullptr) return;
  if (label != label_) {
    label_ = label;
    begin_ = percent_;
  }
  const double left = std::max(0.0, step_->progress_to - begin_);
  Send(begin_ + left * share * (IsMainBar(label) ? kMainBarShare : kBarShare), false);
}

void StageLines::Send(double percent, bool now) {
  percent_ = std::max(percent_, percent);
  const auto time = std::chrono::steady_clock::now();
  if (socket_ < 0 || (!now && std::chrono::duration<double>(time - last_sent_).count() < kSecondsBetween)) return;
  last_sent_ = time;
  const std::string text = fmt::format("PGUP/{}/{}/{:.2f}", getpid(), dataset_, percent_);
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<uint16_t>(port_));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  // Nobody may be listening.
  [[maybe_unused]] const ssize_t sent = sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

}  // namespace skyquilt::odm
