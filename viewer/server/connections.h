// All open connections, at most a fixed number. When a new one comes and there is no room, the oldest that can be spared is closed: first those that
// have shown no valid cookie, then those that wait between two requests. WebSockets and running answers are never closed for others, so that
// strangers can neither lock people out nor disturb them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>

namespace skyquilt::viewer::server {

enum class Standing { kStranger, kWaiting, kBusy };

class Connections;

// Place of one connection; given back when it is destroyed.
class ConnectionSlot {
 public:
  ConnectionSlot(Connections& connections, uint64_t id) : connections_(&connections), id_(id) {}
  ~ConnectionSlot();
  ConnectionSlot(ConnectionSlot&& other) noexcept : connections_(other.connections_), id_(other.id_) { other.connections_ = nullptr; }
  ConnectionSlot(const ConnectionSlot&) = delete;
  ConnectionSlot& operator=(const ConnectionSlot&) = delete;

  void Set(Standing standing);
  // Another object has taken the connection over.
  void SetClose(std::function<void()> close);

 private:
  Connections* connections_;
  uint64_t id_;
};

// On the server's thread only. Must outlive the slots.
class Connections {
 public:
  explicit Connections(int max) : max_(static_cast<size_t>(max)) {}

  // close: ends the connection at once; called at most once. Nothing when there is no room.
  std::optional<ConnectionSlot> Admit(std::function<void()> close);
  // Closes the oldest that can be spared; false when there is none.
  bool CloseOne();
  void CloseAll();

 private:
  friend class ConnectionSlot;
  struct Entry {
    Standing standing = Standing::kStranger;
    std::function<void()> close;
  };
  const size_t max_;
  uint64_t next_id_ = 0;
  std::map<uint64_t, Entry> entries_;  // oldest first
};

}  // namespace skyquilt::viewer::server
