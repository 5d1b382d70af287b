// Parallel loops: a fixed set of threads that run the tasks of one loop at a time.
// Which thread runs a task changes from run to run. For reproducible results write to places indexed by task, not by thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace skyquilt::base {

class ThreadPool {
 public:
  // n_threads <= 0: one per usable core. The thread that calls ParallelFor counts as one of them.
  explicit ThreadPool(int n_threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const;
  // Runs body(task, thread) for task in [0, n_tasks), thread in [0, size()); returns when all are done.
  // The first exception thrown by a task is rethrown here. Not reentrant.
  void ParallelFor(int64_t n_tasks, const std::function<void(int64_t task, int thread)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace skyquilt::base
