#include "core/checkpoint/digest.h"

#include <gtest/gtest.h>

#include <string>

namespace skyquilt::checkpoint {
namespace {

uint64_t DigestOf(const std::string& text) {
  Digest digest;
  digest.Update({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  return digest.Value();
}

// Values of the reference implementation (xxHash 0.8, XXH64, seed 0).
TEST(Digest, AgreesWithTheReference) {
  EXPECT_EQ(DigestOf(""), 0xEF46DB3751D8E999ULL);
  EXPECT_EQ(DigestOf("a"), 0xD24EC4F1A98C6E5BULL);
  EXPECT_EQ(DigestOf("abc"), 0x44BC2CF5AD770999ULL);
  EXPECT_EQ(DigestOf("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1ULL);
}

TEST(Digest, DoesNotDependOnHowBytesAreDivided) {
  std::string text;
  for (int i = 0; i < 300; ++i) text.push_back(static_cast<char>(i * 37));
  for (size_t step = 1; step < 70; ++step) {
    Digest digest;
    for (size_t at = 0; at < text.size(); at += step) {
      const std::string part = text.substr(at, step);
      digest.Update({reinterpret_cast<const uint8_t*>(part.data()), part.size()});
    }
    EXPECT_EQ(digest.Value(), DigestOf(text)) << step;
  }
}

TEST(Digest, ChangesWithEverySingleBit) {
  const std::string text(100, '\x3C');
  const uint64_t before = DigestOf(text);
  for (size_t i = 0; i < text.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = text;
      changed[i] = static_cast<char>(changed[i] ^ (1 << bit));
      EXPECT_NE(DigestOf(changed), before);
    }
  }
}

}  // namespace
}  // namespace skyquilt::checkpoint
