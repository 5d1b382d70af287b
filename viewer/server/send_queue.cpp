#include "viewer/server/send_queue.h"

#include <utility>

namespace skyquilt::viewer::server {
namespace {

// Bounds the memory of very short messages, whose own bytes are less than what it takes to queue them.
constexpr size_t kMaxWaitingMessages = 16384;

}  // namespace

SendQueue::SendQueue(size_t max_bytes, std::function<void()> wake) : max_bytes_(max_bytes), wake_(std::move(wake)) {}

void SendQueue::Push(OutMessage message) {
  if (message.bytes == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || overflowed_) return;
    const size_t bytes = message.bytes->size();
    if (bytes > max_bytes_ || waiting_bytes_ + under_way_bytes_ + bytes > max_bytes_ || messages_.size() >= kMaxWaitingMessages) {
      overflowed_ = true;
      messages_.clear();
      waiting_bytes_ = 0;
    } else {
      waiting_bytes_ += bytes;
      messages_.push_back(std::move(message));
    }
    if (std::exchange(woken_, true)) return;
  }
  wake_();
}

void SendQueue::BeginLook() {
  const std::lock_guard lock(mutex_);
  woken_ = false;
}

std::optional<OutMessage> SendQueue::Next() {
  const std::lock_guard lock(mutex_);
  under_way_bytes_ = 0;
  if (messages_.empty()) return {};
  OutMessage message = std::move(messages_.front());
  messages_.pop_front();
  under_way_bytes_ = message.bytes->size();
  waiting_bytes_ -= under_way_bytes_;
  return message;
}

size_t SendQueue::waiting_bytes() const {
  const std::lock_guard lock(mutex_);
  return waiting_bytes_;
}

bool SendQueue::overflowed() const {
  const std::lock_guard lock(mutex_);
  return overflowed_;
}

void SendQueue::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  messages_.clear();
  waiting_bytes_ = 0;
}

void ClientTable::Add(ClientId client, std::shared_ptr<SendQueue> queue) {
  const std::lock_guard lock(mutex_);
  queues_[client] = std::move(queue);
}

void ClientTable::Remove(ClientId client) {
  const std::lock_guard lock(mutex_);
  queues_.erase(client);
}

std::shared_ptr<SendQueue> ClientTable::Find(ClientId client) const {
  const std::lock_guard lock(mutex_);
  const auto found = queues_.find(client);
  return found == queues_.end() ? nullptr : found->second;
}

int ClientTable::size() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(queues_.size());
}

}  // namespace skyquilt::viewer::server
