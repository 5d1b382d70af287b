#include "core/base/cancel.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

#include "core/base/errors.h"

namespace skyquilt::base {
namespace {

std::atomic<bool> cancel_requested{false};
std::atomic<bool> signal_received{false};
std::atomic<int> interrupt_count{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free, "used in a signal handler");

extern "C" void HandleSignal(int signal_number) {
  if (signal_number == SIGINT && interrupt_count.fetch_add(1) >= 1) _exit(130);
  signal_received.store(true);
}

}  // namespace

void InstallSignalHandlers() {
  struct sigaction action = {};
  action.sa_handler = HandleSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal_number : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal_number, &action, nullptr);
}

bool CancelRequested() {
  return cancel_requested.load(std::memory_order_relaxed) || signal_received.load(std::memory_order_relaxed);
}

void RequestCancel() {
  cancel_requested.store(true);
}

void WithdrawRequest() {
  cancel_requested.store(false);
}

void ClearCancel() {
  cancel_requested.store(false);
  signal_received.store(false);
  interrupt_count.store(0);
}

void ThrowIfCancelled() {
  if (CancelRequested()) throw Interrupted();
}

}  // namespace skyquilt::base
