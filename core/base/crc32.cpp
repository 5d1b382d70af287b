#include "core/base/crc32.h"

#include <zlib.h>

namespace skyquilt::base {

uint32_t Crc32(std::string_view bytes) {
  // crc32_z takes sizes of 64 bits.
  return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace skyquilt::base
