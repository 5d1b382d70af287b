#include "viewer/engine/frame_gate.h"

#include <algorithm>

namespace skyquilt::viewer {

void FrameGate::Offer(Frame frame) {
  const std::pair<uint32_t, int> number(frame.seq, frame.pass);
  if (newest_ && number <= *newest_) return;
  newest_ = number;
  waiting_ = std::move(frame);
}

std::optional<Frame> FrameGate::Take(size_t queued_bytes) {
  if (!waiting_ || Full() || queued_bytes > kMaxQueuedBytes) return {};
  unacknowledged_.emplace_back(waiting_->seq, waiting_->pass);
  return std::exchange(waiting_, std::nullopt);
}

void FrameGate::Acknowledge(uint32_t seq, int pass) {
  const auto at = std::find(unacknowledged_.begin(), unacknowledged_.end(), std::pair(seq, pass));
  if (at != unacknowledged_.end()) unacknowledged_.erase(at);
}

}  // namespace skyquilt::viewer
