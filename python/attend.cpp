#include "python/attend.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "core/base/cancel.h"

namespace skyquilt::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};

}  // namespace

void Attention::Stop(pybind11::error_already_set error) {
  if (!error_) error_.emplace(std::move(error));
  base::RequestCancel();
}

void Attention::Run(const std::function<void()>& work) {
  std::exception_ptr failure;
  {
    const pybind11::gil_scoped_release release;
    std::mutex mutex;
    std::condition_variable ended;
    bool has_ended = false;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      has_ended = true;
      ended.notify_all();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, kBetweenLooks, [&] { return has_ended; })) {
      lock.unlock();
      {
        const pybind11::gil_scoped_acquire acquire;
        if (PyErr_CheckSignals() != 0) Stop(pybind11::error_already_set());
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  // A signal that came after the last look.
  if (!error_ && PyErr_CheckSignals() != 0) error_.emplace();
  if (error_) {
    base::WithdrawRequest();
    throw pybind11::error_already_set(*error_);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace skyquilt::python
