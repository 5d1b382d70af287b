// The newest finished passes as bytes, up to a limit, so that a view that returns or is shared by clients is sent at once.
#pragma once

#include <list>
#include <memory>
#include <string>
#include <unordered_map>

namespace skyquilt::viewer {

using FrameBytes = std::shared_ptr<const std::string>;

class FrameCache {
 public:
  explicit FrameCache(size_t max_bytes) : max_bytes_(max_bytes) {}

  // Null when it is not there.
  FrameBytes Find(const std::string& key);
  bool Has(const std::string& key) const { return by_key_.contains(key); }
  // A frame larger than the limit is not kept.
  void Put(const std::string& key, FrameBytes frame);
  void Clear();
  size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    std::string key;
    FrameBytes frame;
  };
  size_t max_bytes_;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  // the most recently used first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_key_;
};

// The frame as an answer to this request: a copy when seq or revision differ.
FrameBytes Readdressed(const FrameBytes& frame, uint32_t seq, uint32_t revision);

}  // namespace skyquilt::viewer
