#include "viewer/engine/inbox.h"

#include <utility>

namespace skyquilt::viewer {

void Inbox::Put(Event event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  changed_.notify_one();
}

void Inbox::Wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  changed_.notify_one();
}

std::vector<Event> Inbox::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

void Inbox::Wait(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, most, [this] { return woken_ || !events_.empty(); });
  woken_ = false;
}

}  // namespace skyquilt::viewer
