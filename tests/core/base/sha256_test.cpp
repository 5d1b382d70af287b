#include "core/base/sha256.h"

#include <gtest/gtest.h>

#include <string>

namespace skyquilt::base {
namespace {

// The examples of the National Institute of Standards and Technology (FIPS 180-4 and its long messages).
TEST(Sha256, OfPublishedExamples) {
  EXPECT_EQ(Sha256Hex(std::string_view("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256Hex(std::string_view("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256Hex(std::string_view("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(
      Sha256Hex(std::string_view("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu")),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(Sha256Hex(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Around the length where the end of the message needs another block.
TEST(Sha256, InPiecesIsThatOfTheWhole) {
  for (size_t length = 0; length < 200; ++length) {
    std::string text(length, ' ');
    for (size_t i = 0; i < length; ++i) text[i] = static_cast<char>(i * 7 + length);
    const auto* bytes = reinterpret_cast<const uint8_t*>(text.data());
    for (const size_t piece : {1U, 3U, 63U, 64U, 65U}) {
      Sha256 digest;
      for (size_t at = 0; at < length; at += piece) digest.Update({bytes + at, std::min(piece, length - at)});
      EXPECT_EQ(digest.Hex(), Sha256Hex(text)) << length << " in pieces of " << piece;
      EXPECT_EQ(digest.Hex(), Sha256Hex(text)) << "asking changes nothing";
    }
  }
}

}  // namespace
}  // namespace skyquilt::base
