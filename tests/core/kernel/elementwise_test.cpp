#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/not_finite.h"

namespace skyquilt::kernel {
namespace {

using ElementwiseKernels = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(ElementwiseKernels);

TEST_P(ElementwiseKernels, CompactKeepsOrderInPlaceAndElsewhere) {
  base::Random random(5);
  constexpr size_t kN = 112, kRows = 3, kStride = 128;
  std::vector<float> keep(kN), in(kRows * kStride), out(kRows * kStride, -1.0F);
  for (float& k : keep) k = random.Uniform() < 0.4F ? 1.0F : 0.0F;
  for (size_t i = 32; i < 64; ++i) keep[i] = 0.0F;
  for (size_t i = 0; i < in.size(); ++i) in[i] = static_cast<float>(i);
  std::vector<float> expected;
  for (size_t s = 0; s < kN; ++s) {
    if (keep[s] > 0.0F) expected.push_back(static_cast<float>(s));
  }
  ASSERT_EQ(Compact(keep.data(), kN, kRows, in.data(), kStride, out.data(), kStride), static_cast<int64_t>(expected.size()));
  ASSERT_EQ(Compact(keep.data(), kN, kRows, in.data(), kStride, in.data(), kStride), static_cast<int64_t>(expected.size()));
  for (size_t row = 0; row < kRows; ++row) {
    for (size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(out[row * kStride + i], expected[i] + static_cast<float>(row * kStride));
      EXPECT_EQ(in[row * kStride + i], expected[i] + static_cast<float>(row * kStride));
    }
  }
}

TEST_P(ElementwiseKernels, AllFiniteFindsOneBadValueAnywhere) {
  std::vector<float> values(77, 3e38F);
  EXPECT_TRUE(AllFinite(values.data(), 77));
  EXPECT_TRUE(AllFinite(values.data(), 0));
  for (const float bad : {kInfinityFloat, -kInfinityFloat, std::nanf("")}) {
    for (const size_t at : {0U, 31U, 63U, 64U, 76U}) {
      std::vector<float> copy = values;
      copy[at] = bad;
      EXPECT_FALSE(AllFinite(copy.data(), 77)) << at;
    }
  }
}

// They would read and write past the end.
TEST_P(ElementwiseKernels, RefuseUnpaddedLengths) {
  std::vector<float> in(64, 1.0F), out(64), more(64);
  for (const int64_t n : {int64_t{-16}, int64_t{1}, int64_t{15}, int64_t{47}}) {
    EXPECT_THROW(ExpShifted(in.data(), n, 0.0F, 1.0F, out.data()), std::logic_error) << n;
    EXPECT_THROW(SoftplusShifted(in.data(), n, 0.0F, 1.0F, out.data()), std::logic_error) << n;
    EXPECT_THROW(ReluShifted(in.data(), n, 0.0F, 1.0F, out.data()), std::logic_error) << n;
    EXPECT_THROW(Sigmoid(in.data(), n, 1.0F, out.data()), std::logic_error) << n;
    EXPECT_THROW(SineCosine(in.data(), n, out.data(), more.data()), std::logic_error) << n;
    EXPECT_THROW(Compact(in.data(), n, 1, in.data(), 64, out.data(), 64), std::logic_error) << n;
  }
  EXPECT_THROW(Compact(in.data(), 32, 2, in.data(), 16, out.data(), 32), std::logic_error);
  EXPECT_THROW(Compact(in.data(), 32, 2, in.data(), 32, out.data(), 16), std::logic_error);
  EXPECT_EQ(Compact(in.data(), 32, 1, in.data(), 0, out.data(), 0), 32) << "one row has no stride";
  ExpShifted(in.data(), 0, 0.0F, 1.0F, out.data());
  EXPECT_EQ(out[32], 0.0F);
}

using ForcedInstructionSet = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(ForcedInstructionSet);

TEST_P(ForcedInstructionSet, IsNotChangedByListingTheOthers) {
  bool stayed = true;
  std::atomic<bool> done{false};
  // Another thread does not see it change either.
  std::thread watch([&] {
    while (!done) stayed = stayed && ActiveInstructionSet() == GetParam();
  });
  const std::vector<std::string> names = InstructionSets();
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(InstructionSets(), names);
  EXPECT_THROW(ForceInstructionSet("quantum"), std::invalid_argument);
  EXPECT_EQ(ActiveInstructionSet(), GetParam());
  done = true;
  watch.join();
  EXPECT_TRUE(stayed);
}

TEST(InstructionSets, EndWithThePortableOneAndRefuseOthers) {
  const std::vector<std::string> names = InstructionSets();
  ASSERT_FALSE(names.empty());
  EXPECT_EQ(ActiveInstructionSet(), names.front());
  ForceInstructionSet("portable");
  EXPECT_EQ(ActiveInstructionSet(), names.back());
  EXPECT_THROW(ForceInstructionSet("quantum"), std::invalid_argument);
  ForceInstructionSet(names.front());
}

}  // namespace
}  // namespace skyquilt::kernel
