#include "viewer/engine/frame_cache.h"

#include <array>
#include <utility>

#include "viewer/protocol/frame.h"

namespace skyquilt::viewer {
namespace {

constexpr size_t kSeqAt = 8;  // of the header: seq, then revision

std::array<char, 8> AddressBytes(uint32_t seq, uint32_t revision) {
  std::array<char, 8> bytes{};
  for (size_t i = 0; i < 4; ++i) {
    bytes[i] = static_cast<char>(seq >> (8 * i) & 0xFFU);
    bytes[4 + i] = static_cast<char>(revision >> (8 * i) & 0xFFU);
  }
  return bytes;
}

}  // namespace

FrameBytes FrameCache::Find(const std::string& key) {
  const auto at = by_key_.find(key);
  if (at == by_key_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, at->second);
  return at->second->frame;
}

void FrameCache::Put(const std::string& key, FrameBytes frame) {
  if (const auto at = by_key_.find(key); at != by_key_.end()) {
    bytes_ -= at->second->frame->size();
    entries_.erase(at->second);
    by_key_.erase(at);
  }
  if (frame == nullptr || frame->size() > max_bytes_) return;
  bytes_ += frame->size();
  entries_.push_front({key, std::move(frame)});
  by_key_[key] = entries_.begin();
  while (bytes_ > max_bytes_) {
    bytes_ -= entries_.back().frame->size();
    by_key_.erase(entries_.back().key);
    entries_.pop_back();
  }
}

void FrameCache::Clear() {
  entries_.clear();
  by_key_.clear();
  bytes_ = 0;
}

FrameBytes Readdressed(const FrameBytes& frame, uint32_t seq, uint32_t revision) {
  const std::array<char, 8> address = AddressBytes(seq, revision);
  const std::string_view wanted(address.data(), address.size());
  if (frame->size() < kFrameHeaderBytes || std::string_view(*frame).substr(kSeqAt, wanted.size()) == wanted) return frame;
  auto copy = std::make_shared<std::string>(*frame);
  copy->replace(kSeqAt, wanted.size(), wanted);
  return copy;
}

}  // namespace skyquilt::viewer
