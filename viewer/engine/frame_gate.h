// Lets frames through to one client: at most two that it has not acknowledged, none while many bytes are queued for it. What has to wait is replaced
// by what is newer.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "viewer/engine/frame_cache.h"

namespace skyquilt::viewer {

struct Frame {
  uint32_t seq = 0;
  int pass = 0;
  FrameBytes bytes;
};

class FrameGate {
 public:
  static constexpr size_t kMaxUnacknowledged = 2;
  static constexpr size_t kMaxQueuedBytes = 8U << 20U;

  // Frames older than the newest one offered are dropped.
  void Offer(Frame frame);
  // The waiting frame, when it may be sent now; it then counts as unacknowledged. queued_bytes: that wait for the client.
  std::optional<Frame> Take(size_t queued_bytes);
  // Unknown ones are ignored.
  void Acknowledge(uint32_t seq, int pass);
  // Forgets the waiting frame.
  void Drop() { waiting_.reset(); }
  bool Waiting() const { return waiting_.has_value(); }
  bool Full() const { return unacknowledged_.size() >= kMaxUnacknowledged; }

 private:
  std::optional<Frame> waiting_;
  std::optional<std::pair<uint32_t, int>> newest_;  // seq and pass
  std::deque<std::pair<uint32_t, int>> unacknowledged_;
};

}  // namespace skyquilt::viewer
