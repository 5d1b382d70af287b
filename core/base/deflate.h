// Raw deflate (RFC 1951), which browsers unpack with DecompressionStream("deflate-raw").
#pragma once

#include <string>
#include <string_view>

namespace skyquilt::base {

// Fast rather than small.
std::string Deflate(std::string_view bytes);
// Throws std::runtime_error unless the result has exactly this size and all of `packed` belongs to it.
std::string Inflate(std::string_view packed, size_t size);

}  // namespace skyquilt::base
