// CRC-32 as PNG and gzip use it (ISO 3309, polynomial 0x04C11DB7 reflected).
#pragma once

#include <cstdint>
#include <string_view>

namespace skyquilt::base {

uint32_t Crc32(std::string_view bytes);

}  // namespace skyquilt::base
