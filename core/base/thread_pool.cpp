#include "core/base/thread_pool.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/system.h"

namespace skyquilt::base {
namespace {

// Loops are often about a millisecond long and follow each other closely: waiting actively for a moment avoids most sleeps.
constexpr std::chrono::microseconds kSpin{20};

void Relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

template <typename Condition>
void SpinUntil(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kSpin;
  while (!condition() && std::chrono::steady_clock::now() < end) {
    for (int i = 0; i < 16 && !condition(); ++i) Relax();
  }
}

}  // namespace

struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable start;
  std::condition_variable done;
  std::atomic<uint64_t> generation{0};  // one more per loop
  std::atomic<bool> stop{false};
  std::atomic<bool> running{false};
  std::atomic<int> n_active{0};  // threads inside the open loop, the caller not counted; changed under the mutex
  bool open = false;             // threads may still join the loop; under the mutex
  int64_t n_tasks = 0;
  const std::function<void(int64_t, int)>* body = nullptr;
  std::exception_ptr error;  // the first; under the mutex
  alignas(64) std::atomic<int64_t> next{0};
  std::vector<std::thread> threads;

  void RunTasks(int thread) {
    for (int64_t task = next.fetch_add(1); task < n_tasks; task = next.fetch_add(1)) {
      try {
        (*body)(task, thread);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next.store(n_tasks);
      }
    }
  }

  void Serve(int thread) {
    uint64_t seen = 0;
    for (;;) {
      const auto called = [&] { return stop.load() || generation.load() != seen; };
      SpinUntil(called);
      {
        std::unique_lock lock(mutex);
        start.wait(lock, called);
        if (stop.load()) return;
        seen = generation.load();
        // The other threads have already finished this loop.
        if (!open) continue;
        n_active.fetch_add(1);
      }
      RunTasks(thread);
      const std::lock_guard lock(mutex);
      if (n_active.fetch_sub(1) == 1) done.notify_one();
    }
  }

  void Stop() {
    {
      const std::lock_guard lock(mutex);
      stop.store(true);
    }
    start.notify_all();
    for (std::thread& thread : threads) thread.join();
    threads.clear();
  }
};

ThreadPool::ThreadPool(int n_threads) : state_(std::make_unique<State>()) {
  const int n = n_threads > 0 ? n_threads : UsableCores();
  try {
    for (int thread = 1; thread < n; ++thread) state_->threads.emplace_back(&State::Serve, state_.get(), thread);
  } catch (...) {
    state_->Stop();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  state_->Stop();
}

int ThreadPool::size() const {
  return static_cast<int>(state_->threads.size()) + 1;
}

void ThreadPool::ParallelFor(int64_t n_tasks, const std::function<void(int64_t task, int thread)>& body) {
  State& state = *state_;
  if (n_tasks <= 0) return;
  SKYQUILT_CHECK(!state.running.exchange(true), "ParallelFor is not reentrant");
  struct Release {
    std::atomic<bool>& running;
    ~Release() { running.store(false); }
  } const release{state.running};

  if (state.threads.empty() || n_tasks == 1) {
    for (int64_t task = 0; task < n_tasks; ++task) body(task, 0);
    return;
  }
  {
    const std::lock_guard lock(state.mutex);
    state.n_tasks = n_tasks;
    state.body = &body;
    state.error = nullptr;
    state.next.store(0);
    state.open = true;
    state.generation.fetch_add(1);
  }
  state.start.notify_all();
  state.RunTasks(0);
  {
    const std::lock_guard lock(state.mutex);
    state.open = false;
  }
  const auto finished = [&] { return state.n_active.load() == 0; };
  SpinUntil(finished);
  std::unique_lock lock(state.mutex);
  state.done.wait(lock, finished);
  state.body = nullptr;
  if (state.error) std::rethrow_exception(std::exchange(state.error, nullptr));
}

}  // namespace skyquilt::base
