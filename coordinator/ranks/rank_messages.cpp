#include "coordinator/ranks/rank_messages.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::coordinator {

comm::Message WaitForMessage(comm::Communicator& comm) {
  using Clock = std::chrono::steady_clock;
  auto pause = std::chrono::microseconds(200);
  std::optional<Clock::time_point> cancelled;
  while (true) {
    if (std::optional<comm::Message> message = comm.TryReceive()) return *std::move(message);
    if (base::CancelRequested()) {
      if (!cancelled) cancelled = Clock::now();
      if (std::chrono::duration<double>(Clock::now() - *cancelled).count() > 60.0) throw base::Interrupted();
    }
    std::this_thread::sleep_for(std::min(pause, comm.PollInterval() * 20));
    pause = std::min(pause * 2, std::chrono::microseconds(20000));
  }
}

}  // namespace skyquilt::coordinator
