#include "core/base/system.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>
#include <vector>

#include "core/base/pattern.h"

namespace skyquilt::base {
namespace {

// Runs in a separate process, so that the other tests can use all cores.
void PinAndRelease() {
  const int before = UsableCores();
  const int here = sched_getcpu();
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<size_t>(here), &one);
  if (sched_setaffinity(0, sizeof(one), &one) != 0) std::_Exit(3);
  if (UsableCores() != 1) std::_Exit(1);
  ReleaseAffinity();
  if (UsableCores() < before) std::_Exit(2);
  std::_Exit(0);
}

TEST(SystemDeathTest, ReleaseUndoesPinning) {
  EXPECT_EXIT(PinAndRelease(), testing::ExitedWithCode(0), "");
}

TEST(System, PeakMemoryIncludesWrittenPages) {
  const int64_t before = PeakRssBytes();
  EXPECT_GT(before, 0);
  constexpr size_t kBytes = size_t{256} << 20U;
  std::vector<char> block(kBytes, 1);
  char* volatile seen = block.data();  // else compilers leave the block out
  EXPECT_NE(seen, nullptr);
  EXPECT_EQ(block[kBytes / 2], 1);
  EXPECT_GE(PeakRssBytes(), static_cast<int64_t>(kBytes));
  EXPECT_GE(TotalMemoryBytes(), PeakRssBytes());
}

TEST(System, DescribesItself) {
  EXPECT_GE(UsableCores(), 1);
  EXPECT_TRUE(MatchWhole(MachineDescription(), ".+, [0-9]+ cores?, [0-9]+ GiB.*")) << MachineDescription();
  EXPECT_TRUE(MatchWhole(UtcTimestamp(), "20[0-9]{2}-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z")) << UtcTimestamp();
}

}  // namespace
}  // namespace skyquilt::base
