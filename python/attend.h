// Long work of a Python call: without the interpreter's lock, so that other Python threads run meanwhile, and ended by Ctrl-C at its next safe point.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>

namespace skyquilt::python {

class Attention {
 public:
  Attention() = default;
  ~Attention() = default;  // with the lock, as Python errors are inside
  Attention(const Attention&) = delete;
  Attention& operator=(const Attention&) = delete;

  // Call it with the interpreter's lock. `work` runs on a thread of its own without the lock, while the calling thread looks for signals some times a
  // second. A signal whose Python handler raises (Ctrl-C: KeyboardInterrupt) cancels the work (base::RequestCancel, which is the process's: work of
  // other threads ends too, with base::Interrupted); the error is thrown when the work has ended, finished or not. Otherwise what `work` throws.
  void Run(const std::function<void()>& work);

  // From inside the work, with the lock: cancels it, and Run throws this error.
  void Stop(pybind11::error_already_set error);

 private:
  std::optional<pybind11::error_already_set> error_;  // guarded by the interpreter's lock
};

// The same for work that calls nothing of Python.
inline void Attend(const std::function<void()>& work) {
  Attention().Run(work);
}

}  // namespace skyquilt::python
