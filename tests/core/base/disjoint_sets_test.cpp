#include "core/base/disjoint_sets.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/random.h"

namespace skyquilt::base {
namespace {

TEST(DisjointSets, StartAlone) {
  DisjointSets sets(3);
  for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(sets.Root(i), i);
  sets.Join(1, 1);
  EXPECT_EQ(sets.Root(1), 1U);
}

// Against labels that are rewritten at every step.
TEST(DisjointSets, JoinWhatLabelsJoin) {
  constexpr uint32_t kN = 60;
  Random random(7);
  DisjointSets sets(kN);
  std::vector<uint32_t> label(kN);
  std::iota(label.begin(), label.end(), 0U);
  for (int step = 0; step < 50; ++step) {
    const auto a = static_cast<uint32_t>(random.Uniform(0.0, kN)), b = static_cast<uint32_t>(random.Uniform(0.0, kN));
    sets.Join(a, b);
    const uint32_t kept = std::min(label[a], label[b]), gone = std::max(label[a], label[b]);
    std::replace(label.begin(), label.end(), gone, kept);
    ASSERT_EQ(sets.count(), std::set<uint32_t>(label.begin(), label.end()).size());
    for (uint32_t i = 0; i < kN; ++i) ASSERT_EQ(sets.Root(i), label[i]) << "step " << step;
  }
}

}  // namespace
}  // namespace skyquilt::base
