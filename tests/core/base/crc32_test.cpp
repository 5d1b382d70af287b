#include <gtest/gtest.h>

#include "core/base/deflate.h"

namespace skyquilt::base {
namespace {

// The check value of the catalogue of CRC algorithms (CRC-32/ISO-HDLC), and the checksum of every PNG's empty last chunk.
TEST(Crc32, KnownValues) {
  EXPECT_EQ(Crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(Crc32("IEND"), 0xAE426082U);
  EXPECT_EQ(Crc32(""), 0U);
}

}  // namespace
}  // namespace skyquilt::base
