#include "core/survey/dji_maker_note.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <vector>

namespace skyquilt::survey {
namespace {

void Put(std::vector<uint8_t>& bytes, uint32_t value, size_t size, bool little_endian) {
  for (size_t i = 0; i < size; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8U * (little_endian ? i : size - 1 - i))));
}

// A note with a text and the speeds along x, y and z.
std::vector<uint8_t> Note(float x, float y, bool little_endian) {
  std::vector<uint8_t> bytes;
  Put(bytes, 4, 2, little_endian);
  bytes.insert(bytes.end(), {1, 0, 2, 0, 4, 0, 0, 0, 'D', 'J', 'I', 0});
  for (const auto& [tag, value] : {std::pair(3U, x), std::pair(4U, y), std::pair(5U, 7.0F)}) {
    Put(bytes, tag, 2, little_endian);
    Put(bytes, 11, 2, little_endian);
    Put(bytes, 1, 4, little_endian);
    Put(bytes, std::bit_cast<uint32_t>(value), 4, little_endian);
  }
  return bytes;
}

TEST(DjiMakerNote, SpeedIsThatOverGround) {
  for (const bool little_endian : {true, false}) {
    const auto speed = DjiMakerNoteSpeed(Note(-3.0F, 4.0F, little_endian), little_endian);
    ASSERT_TRUE(speed.has_value());
    EXPECT_NEAR(*speed, 5.0, 1e-6);
    EXPECT_FALSE(DjiMakerNoteSpeed(Note(-3.0F, 4.0F, little_endian), !little_endian).has_value());
  }
}

TEST(DjiMakerNote, OtherBytesHaveNoSpeed) {
  EXPECT_FALSE(DjiMakerNoteSpeed({}, true).has_value());
  EXPECT_FALSE(DjiMakerNoteSpeed(Note(std::numeric_limits<float>::quiet_NaN(), 1.0F, true), true).has_value());
  EXPECT_FALSE(DjiMakerNoteSpeed(Note(1e30F, 1.0F, true), true).has_value());
  const std::vector<uint8_t> whole = Note(1.0F, 2.0F, true);
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(DjiMakerNoteSpeed(std::span(whole).first(length), true).has_value()) << length;
  }
  std::vector<uint8_t> without_y = whole;
  without_y[2 + 24] = 9;
  EXPECT_FALSE(DjiMakerNoteSpeed(without_y, true).has_value());
}

}  // namespace
}  // namespace skyquilt::survey
