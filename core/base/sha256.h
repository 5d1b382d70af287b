// The SHA-256 digest of bytes, computed piece by piece. Names files after their content: nobody can make two contents with one digest.
// Source: FIPS 180-4, Secure Hash Standard, 2015.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace skyquilt::base {

class Sha256 {
 public:
  void Update(std::span<const uint8_t> bytes);
  // Of all bytes so far, as 64 lower-case hexadecimal digits. More can be added afterwards.
  std::string Hex() const;

 private:
  void Consume(const uint8_t* block);

  std::array<uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<uint8_t, 64> pending_ = {};
  size_t n_pending_ = 0;
  uint64_t n_bytes_ = 0;
};

std::string Sha256Hex(std::span<const uint8_t> bytes);
std::string Sha256Hex(std::string_view bytes);

}  // namespace skyquilt::base
