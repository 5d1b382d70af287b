#include "core/base/deflate.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace skyquilt::base {
namespace {

TEST(Deflate, ComesBack) {
  std::string bytes;
  for (int i = 0; i < 100'000; ++i) bytes.push_back(static_cast<char>(i * i / 300));
  for (const size_t size : {size_t{0}, size_t{1}, bytes.size()}) {
    const std::string some = bytes.substr(0, size);
    EXPECT_EQ(Inflate(Deflate(some), size), some);
  }
}

// RFC 1951 itself: browsers refuse a zlib header. A block of stored bytes, as any encoder may write it.
TEST(Deflate, ReadsRawBlocks) {
  EXPECT_EQ(Inflate(std::string("\x01\x02\x00\xFD\xFFhi", 7), 2), "hi");
}

TEST(Deflate, RefusesOtherSizesAndBytes) {
  const std::string packed = Deflate("some bytes, some bytes, some bytes");
  EXPECT_THROW(Inflate(packed, 33), std::runtime_error);
  EXPECT_THROW(Inflate(packed, 35), std::runtime_error);
  EXPECT_THROW(Inflate(packed + "x", 34), std::runtime_error);
  EXPECT_THROW(Inflate(packed.substr(0, packed.size() - 2), 34), std::runtime_error);
}

}  // namespace
}  // namespace skyquilt::base
