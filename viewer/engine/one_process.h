// A communicator of this process alone, for a scene that rank 0 renders by itself while the other ranks hold another one.
#pragma once

#include <cstdlib>
#include <deque>
#include <optional>
#include <string>

#include "core/comm/communicator.h"

namespace skyquilt::viewer {

class OneProcess : public comm::Communicator {
 public:
  // ranks: the real communicator, which ends the other ranks when this one fails. Must outlive it.
  explicit OneProcess(comm::Communicator& ranks) : ranks_(ranks) {}

  int rank() const override { return 0; }
  int size() const override { return 1; }
  int local_size() const override { return 1; }
  void Send(int /*destination*/, int tag, const std::string& bytes) override {
    messages_.push_back({0, tag, bytes});
    bytes_sent_ += static_cast<int64_t>(bytes.size());
  }
  std::optional<comm::Message> TryReceive() override {
    if (messages_.empty()) return {};
    comm::Message message = std::move(messages_.front());
    messages_.pop_front();
    return message;
  }
  std::string Broadcast(const std::string& bytes_on_root) override { return bytes_on_root; }
  void Barrier() override {}
  int64_t bytes_sent() const override { return bytes_sent_; }
  [[noreturn]] void Abort(int exit_status) override {
    ranks_.Abort(exit_status);
    std::abort();  // not reached, which the compiler does not see
  }

 private:
  comm::Communicator& ranks_;
  std::deque<comm::Message> messages_;
  int64_t bytes_sent_ = 0;
};

}  // namespace skyquilt::viewer
