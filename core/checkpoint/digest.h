// The XXH64 hash with seed 0, computed piece by piece, to find damaged files. About as fast as reading memory; not safe against attackers.
// A change within one 8-byte word always changes the digest, any other change with probability 1 - 2^-64.
// Source: Y. Collet, xxHash fast digest algorithm, specification 0.1.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace skyquilt::checkpoint {

class Digest {
 public:
  void Update(std::span<const uint8_t> bytes);
  uint64_t Value() const;

 private:
  void Consume(const uint8_t* stripe);

  static constexpr uint64_t kPrime1 = 0x9E3779B185EBCA87ULL;
  static constexpr uint64_t kPrime2 = 0xC2B2AE3D27D4EB4FULL;
  std::array<uint64_t, 4> lanes_ = {kPrime1 + kPrime2, kPrime2, 0, 0 - kPrime1};
  std::array<uint8_t, 32> pending_ = {};
  size_t n_pending_ = 0;
  uint64_t n_bytes_ = 0;
};

}  // namespace skyquilt::checkpoint
