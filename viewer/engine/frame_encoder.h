// Encodes finished passes on a thread of its own, because a large PNG takes longer than anyone should wait for the next batch of rays.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "viewer/engine/frame_cache.h"
#include "viewer/engine/frame_job.h"

namespace skyquilt::viewer {

struct EncodedPass {
  uint64_t ticket = 0;
  FrameBytes bytes;   // null: it failed
  std::string error;  // then
};

class FrameEncoder {
 public:
  using Encode = std::function<std::string(const RenderedPass&)>;
  // on_done is called on the encoder's thread. Without own_thread, Add encodes at once (for tests).
  FrameEncoder(Encode encode, bool own_thread, std::function<void()> on_done = {});
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  // Returns the ticket under which it comes back. The smallest pass is encoded first.
  uint64_t Add(RenderedPass pass);
  std::vector<EncodedPass> Take();
  size_t pending() const;

 private:
  struct Work {
    uint64_t ticket = 0;
    RenderedPass pass;
  };
  EncodedPass Run(const Work& work) const;
  void Loop();

  Encode encode_;
  std::function<void()> on_done_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Work> waiting_;
  std::vector<EncodedPass> done_;
  bool encoding_ = false;
  bool ending_ = false;
  uint64_t tickets_ = 0;
  std::thread thread_;
};

}  // namespace skyquilt::viewer
