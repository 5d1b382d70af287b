#include "core/base/deflate.h"

#include <zlib.h>

#include <limits>
#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::base {

namespace {

constexpr int kRaw = -15;  // window bits: 2^15 bytes, negative for no zlib header
constexpr int kFast = 1;
constexpr int kMemoryLevel = 9;

// zlib takes bytes that it does not change without const.
Bytef* Unchanged(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
}

uInt Size(size_t size) {
  SKYQUILT_CHECK(size <= std::numeric_limits<uInt>::max(), "too much at once for zlib");
  return static_cast<uInt>(size);
}

}  // namespace

std::string Deflate(std::string_view bytes) {
  z_stream stream{};
  SKYQUILT_CHECK(deflateInit2(&stream, kFast, Z_DEFLATED, kRaw, kMemoryLevel, Z_DEFAULT_STRATEGY) == Z_OK, "zlib could not be started");
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = Unchanged(bytes);
  stream.avail_in = Size(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = Size(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  SKYQUILT_CHECK(result == Z_STREAM_END, "zlib could not compress");
  return packed;
}

std::string Inflate(std::string_view packed, size_t size) {
  z_stream stream{};
  SKYQUILT_CHECK(inflateInit2(&stream, kRaw) == Z_OK, "zlib could not be started");
  std::string bytes(size, '\0');
  stream.next_in = Unchanged(packed);
  stream.avail_in = Size(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = Size(bytes.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool complete = result == Z_STREAM_END && stream.avail_in == 0 && stream.total_out == size;
  inflateEnd(&stream);
  if (!complete) throw std::runtime_error("the compressed bytes are damaged");
  return bytes;
}

uint32_t Crc32(std::string_view bytes) {
  // crc32_z takes sizes of 64 bits.
  return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace skyquilt::base
