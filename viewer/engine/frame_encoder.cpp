#include "viewer/engine/frame_encoder.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace skyquilt::viewer {

FrameEncoder::FrameEncoder(Encode encode, bool own_thread, std::function<void()> on_done) : encode_(std::move(encode)), on_done_(std::move(on_done)) {
  if (own_thread) thread_ = std::thread([this] { Loop(); });
}

FrameEncoder::~FrameEncoder() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

uint64_t FrameEncoder::Add(RenderedPass pass) {
  std::unique_lock lock(mutex_);
  const uint64_t ticket = ++tickets_;
  Work work{ticket, std::move(pass)};
  if (!thread_.joinable()) {
    done_.push_back(Run(work));
    return ticket;
  }
  waiting_.push_back(std::move(work));
  lock.unlock();
  changed_.notify_all();
  return ticket;
}

std::vector<EncodedPass> FrameEncoder::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

size_t FrameEncoder::pending() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size() + (encoding_ ? 1 : 0);
}

EncodedPass FrameEncoder::Run(const Work& work) const {
  try {
    return {work.ticket, std::make_shared<const std::string>(encode_(work.pass)), {}};
  } catch (const std::exception& error) {
    return {work.ticket, nullptr, error.what()};
  }
}

void FrameEncoder::Loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (ending_) return;
    const auto smallest = std::min_element(waiting_.begin(), waiting_.end(),
                                           [](const Work& a, const Work& b) { return a.pass.depth_m.size() < b.pass.depth_m.size(); });
    const Work work = std::move(*smallest);
    waiting_.erase(smallest);
    encoding_ = true;
    lock.unlock();
    EncodedPass encoded = Run(work);
    lock.lock();
    encoding_ = false;
    done_.push_back(std::move(encoded));
    lock.unlock();
    if (on_done_) on_done_();
    lock.lock();
  }
}

}  // namespace skyquilt::viewer
