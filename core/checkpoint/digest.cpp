#include "core/checkpoint/digest.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace skyquilt::checkpoint {
namespace {

constexpr uint64_t kPrime1 = 0x9E3779B185EBCA87ULL;
constexpr uint64_t kPrime2 = 0xC2B2AE3D27D4EB4FULL;
constexpr uint64_t kPrime3 = 0x165667B19E3779F9ULL;
constexpr uint64_t kPrime4 = 0x85EBCA77C2B2AE63ULL;
constexpr uint64_t kPrime5 = 0x27D4EB2F165667C5ULL;

template <typename T>
T LoadLittleEndian(const uint8_t* bytes) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

uint64_t Round(uint64_t lane, uint64_t input) {
  return std::rotl(lane + input * kPrime2, 31) * kPrime1;
}
uint64_t Merge(uint64_t hash, uint64_t lane) {
  return (hash ^ Round(0, lane)) * kPrime1 + kPrime4;
}

}  // namespace

void Digest::Consume(const uint8_t* stripe) {
  for (size_t i = 0; i < 4; ++i) lanes_[i] = Round(lanes_[i], LoadLittleEndian<uint64_t>(stripe + 8 * i));
}

void Digest::Update(std::span<const uint8_t> bytes) {
  n_bytes_ += bytes.size();
  if (n_pending_ > 0) {
    const size_t n = std::min(bytes.size(), pending_.size() - n_pending_);
    std::copy_n(bytes.begin(), n, pending_.begin() + static_cast<std::ptrdiff_t>(n_pending_));
    n_pending_ += n;
    bytes = bytes.subspan(n);
    if (n_pending_ < pending_.size()) return;
    Consume(pending_.data());
    n_pending_ = 0;
  }
  for (; bytes.size() >= 32; bytes = bytes.subspan(32)) Consume(bytes.data());
  std::copy(bytes.begin(), bytes.end(), pending_.begin());
  n_pending_ = bytes.size();
}

uint64_t Digest::Value() const {
  uint64_t hash = kPrime5;
  if (n_bytes_ >= 32) {
    hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) + std::rotl(lanes_[3], 18);
    for (const uint64_t lane : lanes_) hash = Merge(hash, lane);
  }
  hash += n_bytes_;
  const uint8_t* at = pending_.data();
  const uint8_t* const end = at + n_pending_;
  for (; end - at >= 8; at += 8) hash = std::rotl(hash ^ Round(0, LoadLittleEndian<uint64_t>(at)), 27) * kPrime1 + kPrime4;
  if (end - at >= 4) {
    hash = std::rotl(hash ^ (LoadLittleEndian<uint32_t>(at) * kPrime1), 23) * kPrime2 + kPrime3;
    at += 4;
  }
  for (; at != end; ++at) hash = std::rotl(hash ^ (*at * kPrime5), 11) * kPrime1;
  hash = (hash ^ (hash >> 33U)) * kPrime2;
  hash = (hash ^ (hash >> 29U)) * kPrime3;
  return hash ^ (hash >> 32U);
}

}  // namespace skyquilt::checkpoint
