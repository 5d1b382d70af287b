// Appends numbers to a buffer in the byte order of all our formats, little endian.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace skyquilt::surface {

static_assert(std::endian::native == std::endian::little, "files are written in the byte order of the machine");

template <typename T>
void Put(std::vector<uint8_t>* bytes, T value) {
  static_assert(std::is_arithmetic_v<T>);
  const auto* begin = reinterpret_cast<const uint8_t*>(&value);
  bytes->insert(bytes->end(), begin, begin + sizeof(T));
}

// Exactly `length` bytes: cut, or filled with zeros.
inline void PutText(std::vector<uint8_t>* bytes, std::string_view text, size_t length) {
  const std::string_view cut = text.substr(0, length);
  bytes->insert(bytes->end(), cut.begin(), cut.end());
  bytes->insert(bytes->end(), length - cut.size(), uint8_t{0});
}

inline std::span<const uint8_t> AsBytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace skyquilt::surface
