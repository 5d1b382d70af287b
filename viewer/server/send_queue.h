// Messages that wait to be sent to one client, up to a limit. Any thread adds, the server's thread takes out.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

class SendQueue {
 public:
  // wake: called from any thread when the server's thread should look (see BeginLook).
  SendQueue(size_t max_bytes, std::function<void()> wake);

  // Above the limit, which counts the message under way too, everything is dropped and overflowed() becomes true.
  void Push(OutMessage message);
  // To be called before looking after a wake: later messages wake again.
  void BeginLook();
  // Takes the next message out; it is under way until the next call.
  std::optional<OutMessage> Next();
  // Without the message under way.
  size_t waiting_bytes() const;
  bool overflowed() const;
  // Drops everything, now and later.
  void Close();

 private:
  const size_t max_bytes_;
  const std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::deque<OutMessage> messages_;
  size_t waiting_bytes_ = 0, under_way_bytes_ = 0;
  bool woken_ = false, overflowed_ = false, closed_ = false;
};

// The clients that said hello. Thread-safe.
class ClientTable {
 public:
  void Add(ClientId client, std::shared_ptr<SendQueue> queue);
  void Remove(ClientId client);
  // Null for unknown clients.
  std::shared_ptr<SendQueue> Find(ClientId client) const;
  int size() const;

 private:
  mutable std::mutex mutex_;
  std::unordered_map<ClientId, std::shared_ptr<SendQueue>> queues_;
};

}  // namespace skyquilt::viewer::server
