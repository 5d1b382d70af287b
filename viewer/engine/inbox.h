// What the server's thread leaves for the engine's thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <variant>
#include <vector>

#include "viewer/protocol/messages.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

struct Opened {
  bool greeted = false;  // the welcome was sent
};
struct Closed {};
struct Event {
  ClientId client = 0;
  std::variant<Opened, ClientMessage, Closed> what;
};

// Thread-safe.
class Inbox {
 public:
  void Put(Event event);
  // Makes Wait return.
  void Wake();
  // All events, in order.
  std::vector<Event> Take();
  // Until there is an event, Wake was called, or this time has passed.
  void Wait(std::chrono::milliseconds most);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Event> events_;
  bool woken_ = false;
};

}  // namespace skyquilt::viewer
