#include "core/kernel/descriptors.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <stdexcept>

#include "core/base/random.h"
#include "core/kernel/reference.h"
#include "tests/support/each_instruction_set.h"

namespace skyquilt::kernel {
namespace {

// Every instruction set, and AVX-512 once more without VNNI.
class Descriptors : public testing::EachInstructionSet {
 protected:
  void TearDown() override {
    AllowVnni(true);
    EachInstructionSet::TearDown();
  }
  template <typename Check>
  void WithAndWithoutVnni(Check check) {
    AllowVnni(false);
    EXPECT_FALSE(UsesVnni());
    check();
    AllowVnni(true);
    if (UsesVnni()) check();
  }
};
SKYQUILT_EACH_INSTRUCTION_SET(Descriptors);

using Bytes = std::vector<uint8_t>;

void ExpectSame(const BestDots& found, const BestDots& expected, const std::string& what) {
  EXPECT_EQ(found.dot, expected.dot) << what;
  EXPECT_EQ(found.second, expected.second) << what;
  EXPECT_EQ(found.index, expected.index) << what;
}

void ExpectExact(const Bytes& a, const Bytes& b) {
  const BestDotsBothWays best = FindBestDots(PackDescriptors(a), PackDescriptors(b));
  const std::string what =
      std::to_string(a.size() / kDescriptorBytes) + " x " + std::to_string(b.size() / kDescriptorBytes) + (UsesVnni() ? " with VNNI" : "");
  ExpectSame(best.of_a, reference::FindBestDots(a, b), what + ", of a");
  ExpectSame(best.of_b, reference::FindBestDots(b, a), what + ", of b");
}

// Bytes up to `largest`; small ones give many equal dot products. One descriptor in ten is zero, full of `largest`, or a copy of an earlier one.
Bytes RandomDescriptors(size_t n, uint32_t largest, base::Random& random) {
  Bytes rows(n * kDescriptorBytes);
  for (size_t i = 0; i < n; ++i) {
    const auto row = rows.begin() + static_cast<ptrdiff_t>(i * kDescriptorBytes);
    const uint32_t kind = random.Below(30);
    if (kind == 0) continue;
    if (kind == 1) {
      std::fill_n(row, kDescriptorBytes, static_cast<uint8_t>(largest));
    } else if (kind == 2) {
      std::copy_n(rows.begin() + static_cast<ptrdiff_t>(random.Below(static_cast<uint32_t>(i) + 1) * kDescriptorBytes), kDescriptorBytes, row);
    } else {
      std::generate_n(row, kDescriptorBytes, [&] { return static_cast<uint8_t>(random.Below(largest + 1)); });
    }
  }
  return rows;
}

TEST_P(Descriptors, HaveExactBestDotsForAnyNumberAndAnyBytes) {
  WithAndWithoutVnni([] {
    EXPECT_TRUE(rc::check([] {
      base::Random random(*rc::gen::arbitrary<uint32_t>());
      const auto n_a = *rc::gen::inRange<size_t>(0, 60), n_b = *rc::gen::inRange<size_t>(0, 100);
      const uint32_t largest = *rc::gen::element(1U, 2U, 127U, 128U, 255U);
      const Bytes a = RandomDescriptors(n_a, largest, random), b = RandomDescriptors(n_b, largest, random);
      const BestDotsBothWays best = FindBestDots(PackDescriptors(a), PackDescriptors(b));
      RC_ASSERT(best.of_a == reference::FindBestDots(a, b));
      RC_ASSERT(best.of_b == reference::FindBestDots(b, a));
    }));
  });
}

// Several blocks of rows, and every number of columns that is left after the widest tiles.
TEST_P(Descriptors, HaveExactBestDotsInLargePhotos) {
  base::Random random(7);
  const Bytes many = RandomDescriptors(1041, 60, random);
  for (const size_t n : {1U, 17U, 33U, 49U, 81U}) {
    const Bytes few = RandomDescriptors(n, 60, random);
    WithAndWithoutVnni([&] {
      ExpectExact(many, few);
      ExpectExact(few, many);
    });
  }
}

// Saturating sums of 8-bit products would end at 32767, and 16-bit numbers would overflow.
TEST_P(Descriptors, DoNotSaturate) {
  for (const uint8_t high : {uint8_t{127}, uint8_t{128}, uint8_t{129}, uint8_t{255}}) {
    const Bytes a(3 * kDescriptorBytes, 255), b(5 * kDescriptorBytes, high);
    const int32_t dot = 128 * 255 * int32_t{high};
    WithAndWithoutVnni([&] {
      const BestDotsBothWays best = FindBestDots(PackDescriptors(a), PackDescriptors(b));
      ExpectSame(best.of_a, {std::vector<int32_t>(3, dot), std::vector<int32_t>(3, dot), std::vector<int32_t>(3, 0)}, "of a");
      ExpectSame(best.of_b, {std::vector<int32_t>(5, dot), std::vector<int32_t>(5, dot), std::vector<int32_t>(5, 0)}, "of b");
    });
  }
}

// One byte at a time: each byte of a descriptor meets the same byte of the other and no other.
TEST_P(Descriptors, MultiplyEachByteByItsOwn) {
  Bytes unit(kDescriptorBytes * kDescriptorBytes, 0);
  for (size_t k = 0; k < kDescriptorBytes; ++k) unit[k * kDescriptorBytes + k] = static_cast<uint8_t>(k + 100);
  WithAndWithoutVnni([&] {
    const BestDotsBothWays best = FindBestDots(PackDescriptors(unit), PackDescriptors(unit));
    for (size_t k = 0; k < kDescriptorBytes; ++k) {
      const auto value = static_cast<int32_t>(k + 100);
      EXPECT_EQ(best.of_a.index[k], static_cast<int32_t>(k));
      EXPECT_EQ(best.of_a.dot[k], value * value);
      EXPECT_EQ(best.of_a.second[k], 0);
    }
  });
}

TEST_P(Descriptors, ChooseTheFirstOfEquals) {
  base::Random random(3);
  const Bytes one = RandomDescriptors(1, 255, random);
  Bytes same;
  for (int i = 0; i < 700; ++i) same.insert(same.end(), one.begin(), one.end());
  WithAndWithoutVnni([&] {
    const BestDotsBothWays best = FindBestDots(PackDescriptors(same), PackDescriptors(same));
    EXPECT_EQ(best.of_a.index, std::vector<int32_t>(700, 0));
    EXPECT_EQ(best.of_b.index, std::vector<int32_t>(700, 0));
    EXPECT_EQ(best.of_a.dot, best.of_a.second);
    EXPECT_EQ(best.of_b.dot, best.of_b.second);
  });
}

TEST_P(Descriptors, OfOneAndNoneHaveNoSecond) {
  base::Random random(4);
  const Bytes one(kDescriptorBytes, 3), none, zero(kDescriptorBytes, 0);
  WithAndWithoutVnni([&] {
    ExpectSame(FindBestDots(PackDescriptors(one), PackDescriptors(one)).of_a, {{1152}, {0}, {0}}, "one");
    ExpectSame(FindBestDots(PackDescriptors(one), PackDescriptors(zero)).of_a, {{0}, {0}, {-1}}, "zero");
    const BestDotsBothWays best = FindBestDots(PackDescriptors(none), PackDescriptors(one));
    ExpectSame(best.of_a, {}, "of none");
    ExpectSame(best.of_b, {{0}, {0}, {-1}}, "in none");
    ExpectSame(FindBestDots(PackDescriptors(none), PackDescriptors(none)).of_b, {}, "none in none");
  });
}

TEST(PackDescriptors, RefusesHalfADescriptor) {
  const Bytes rows(3 * kDescriptorBytes, 1);
  EXPECT_EQ(PackDescriptors(rows).size(), 3U);
  EXPECT_EQ(PackDescriptors(rows).groups(), 1U);
  EXPECT_EQ(PackDescriptors({}).size(), 0U);
  EXPECT_THROW(PackDescriptors(std::span(rows).first(200)), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::kernel
