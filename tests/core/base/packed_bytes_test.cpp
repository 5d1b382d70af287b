#include "core/base/packed_bytes.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <limits>

#include "tests/support/not_finite.h"

namespace skyquilt::base {
namespace {

constexpr const char* kMessage = "cannot be read";

std::string SamplePacked() {
  BytePacker out;
  out.Add(int64_t{-7});
  out.Add(true);
  out.Add(std::string("ab\0c", 4));
  out.Add(std::vector<float>{1.5F, kNanFloat, -kInfinityFloat});
  out.Add(std::array<double, 3>{0.1, kNan, kInfinity});
  out.Add(std::string());
  out.Add(std::vector<double>());
  out.AddCount(3);
  return out.Take();
}

void TakeSample(std::string_view bytes) {
  ByteUnpacker in(bytes, kMessage);
  in.Take<int64_t>();
  in.Take<bool>();
  in.Take<std::string>();
  in.Take<std::vector<float>>();
  in.Take<std::array<double, 3>>();
  in.Take<std::string>();
  in.Take<std::vector<double>>();
  in.Take<uint64_t>();
  in.End();
}

TEST(PackedBytes, AreTakenOutUnchanged) {
  const std::string bytes = SamplePacked();
  ByteUnpacker in(bytes, kMessage);
  EXPECT_EQ(in.Take<int64_t>(), -7);
  EXPECT_TRUE(in.Take<bool>());
  EXPECT_EQ(in.Take<std::string>(), std::string("ab\0c", 4));
  std::vector<float> floats = {9.0F};  // replaced
  in.Take(&floats);
  ASSERT_EQ(floats.size(), 3U);
  EXPECT_EQ(std::bit_cast<uint32_t>(floats[1]), std::bit_cast<uint32_t>(kNanFloat));
  EXPECT_EQ(floats[2], -kInfinityFloat);
  const auto doubles = in.Take<std::array<double, 3>>();
  EXPECT_EQ(doubles[0], 0.1);
  EXPECT_EQ(std::bit_cast<uint64_t>(doubles[1]), std::bit_cast<uint64_t>(kNan));
  EXPECT_EQ(doubles[2], kInfinity);
  EXPECT_EQ(in.Take<std::string>(), "");
  EXPECT_TRUE(in.Take<std::vector<double>>().empty());
  EXPECT_THROW(in.TakeCount(1), UnreadableBytes);  // three elements of a byte, but none is left
}

// A NaN keeps its sign and payload.
TEST(PackedBytes, KeepEveryBitOfANumber) {
  for (const uint64_t bits : {uint64_t{0xFFF8000000001234}, uint64_t{0x7FF0000000000001}, uint64_t{0x8000000000000000}}) {
    BytePacker out;
    out.Add(std::bit_cast<double>(bits));
    EXPECT_EQ(ByteUnpacker(out.bytes(), kMessage).Take<uint64_t>(), bits);
  }
}

TEST(PackedBytes, ThatEndTooEarlyOrTooLateAreRefused) {
  const std::string bytes = SamplePacked();
  EXPECT_NO_THROW(TakeSample(bytes));
  for (size_t n = 0; n < bytes.size(); ++n) EXPECT_THROW(TakeSample(std::string_view(bytes).substr(0, n)), UnreadableBytes) << n;
  EXPECT_THROW(TakeSample(bytes + "x"), UnreadableBytes);
}

// No memory is asked for before the bytes were counted.
TEST(PackedBytes, LengthsThatCannotBeAreRefused) {
  for (const uint64_t n : {uint64_t{2}, uint64_t{1} << 40, std::numeric_limits<uint64_t>::max()}) {
    BytePacker out;
    out.AddCount(n);
    out.Add(1.0F);
    EXPECT_THROW(ByteUnpacker(out.bytes(), kMessage).Take<std::vector<float>>(), UnreadableBytes) << n;
    EXPECT_THROW(ByteUnpacker(out.bytes(), kMessage).TakeCount(4), UnreadableBytes) << n;
  }
  BytePacker neither;
  neither.Add(uint8_t{2});
  EXPECT_THROW(ByteUnpacker(neither.bytes(), kMessage).Take<bool>(), UnreadableBytes);
}

}  // namespace
}  // namespace skyquilt::base
