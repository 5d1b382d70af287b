// Ranks as threads of one process, to test without MPI: a Communicator that sends messages through queues in memory.
#pragma once

#include <cstdlib>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

struct FakeNetwork {
  explicit FakeNetwork(int size) : inbox(static_cast<size_t>(size)) {}
  std::mutex mutex;
  std::vector<std::deque<comm::Message>> inbox;
};

class FakeRank : public comm::Communicator {
 public:
  FakeRank(FakeNetwork& network, int rank) : network_(network), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(network_.inbox.size()); }
  int local_size() const override { return size(); }
  std::string HostOf(int rank) const override { return "node" + std::to_string(rank); }
  void Send(int destination, int tag, const std::string& bytes) override {
    const std::lock_guard lock(network_.mutex);
    network_.inbox[static_cast<size_t>(destination)].push_back({rank_, tag, bytes});
    bytes_sent_ += static_cast<int64_t>(bytes.size());
  }
  std::optional<comm::Message> TryReceive() override {
    const std::lock_guard lock(network_.mutex);
    std::deque<comm::Message>& inbox = network_.inbox[static_cast<size_t>(rank_)];
    if (inbox.empty()) return std::nullopt;
    comm::Message message = inbox.front();
    inbox.pop_front();
    return message;
  }
  std::string Broadcast(const std::string& bytes_on_root) override { return bytes_on_root; }
  void Barrier() override {}
  int64_t bytes_sent() const override { return bytes_sent_; }
  [[noreturn]] void Abort(int exit_status) override { std::exit(exit_status); }

 private:
  FakeNetwork& network_;
  int rank_;
  int64_t bytes_sent_ = 0;
};

}  // namespace skyquilt::coordinator
