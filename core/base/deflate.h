// Raw deflate (RFC 1951), which browsers unpack with DecompressionStream("deflate-raw"), and the CRC-32 of files with compressed data.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace skyquilt::base {

// Fast rather than small.
std::string Deflate(std::string_view bytes);
// Throws std::runtime_error unless the result has exactly this size and all of `packed` belongs to it.
std::string Inflate(std::string_view packed, size_t size);

// CRC-32 as PNG and gzip use it (ISO 3309, polynomial 0x04C11DB7 reflected).
uint32_t Crc32(std::string_view bytes);

}  // namespace skyquilt::base
