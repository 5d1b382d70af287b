#include "buildings/candidates/cell_mask.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

CellMask RandomMask(uint64_t seed) {
  base::Random random(seed);
  CellMask mask{1 + static_cast<int>(random.Below(30)), 1 + static_cast<int>(random.Below(30))};
  const double density = random.Uniform(0.01, 0.9);
  for (uint8_t& cell : mask.value) cell = random.UniformDouble() < density ? 1 : 0;
  return mask;
}

RC_GTEST_PROP(CellMask, NearestCellsAreNearest, ()) {
  const CellMask mask = RandomMask(*rc::gen::inRange<uint64_t>(1, 1000000));
  const std::vector<int32_t> nearest = NearestCells(mask);
  for (size_t cell = 0; cell < mask.value.size(); ++cell) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t other = 0; other < mask.value.size(); ++other) {
      if (mask.value[other] != 0) least = std::min(least, CellDistance(mask, cell, static_cast<int32_t>(other)));
    }
    const double found = CellDistance(mask, cell, nearest[cell]);
    RC_ASSERT((nearest[cell] < 0 || mask.value[static_cast<size_t>(nearest[cell])] != 0));  // RC_ASSERT evaluates both sides of a bare ||
    RC_ASSERT(found == least || (found > least && found < least + 0.5));
  }
}

RC_GTEST_PROP(CellMask, ErodedWithinOpenedWithinDilated, ()) {
  const CellMask mask = RandomMask(*rc::gen::inRange<uint64_t>(1, 1000000));
  const double radius = *rc::gen::inRange(0, 40) / 10.0;
  const CellMask dilated = Dilated(mask, radius), eroded = Eroded(mask, radius), opened = Opened(mask, radius);
  for (size_t cell = 0; cell < mask.value.size(); ++cell) {
    RC_ASSERT(eroded.value[cell] <= opened.value[cell]);
    RC_ASSERT(opened.value[cell] <= mask.value[cell]);
    RC_ASSERT(mask.value[cell] <= dilated.value[cell]);
  }
}

TEST(CellMask, OpeningTakesStripsAndKeepsBlocks) {
  CellMask mask(30, 20);
  for (int row = 5; row < 15; ++row) {
    for (int column = 4; column < 14; ++column) mask.value[mask.Index(column, row)] = 1;
  }
  for (int column = 14; column < 28; ++column) mask.value[mask.Index(column, 10)] = mask.value[mask.Index(column, 11)] = 1;
  const CellMask opened = Opened(mask, 2.0);
  EXPECT_EQ(opened.value[opened.Index(9, 10)], 1);
  EXPECT_EQ(opened.value[opened.Index(5, 10)], 1);
  EXPECT_EQ(opened.value[opened.Index(20, 10)], 0);
  // Only the very corners of the block are rounded.
  EXPECT_GE(std::accumulate(opened.value.begin(), opened.value.end(), 0), 88);
}

TEST(CellMask, PartsAreConnectedByEdges) {
  CellMask mask(4, 3);
  // 1 1 0 0
  // 0 0 1 0
  // 1 0 1 0
  for (const size_t cell : std::vector<size_t>{0, 1, 6, 8, 10}) mask.value[cell] = 1;
  const std::vector<std::vector<uint32_t>> parts = ConnectedParts(mask);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0], (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(parts[1], (std::vector<uint32_t>{6, 10}));
  EXPECT_EQ(parts[2], (std::vector<uint32_t>{8}));
  EXPECT_TRUE(ConnectedParts(CellMask(5, 5)).empty());
}

}  // namespace
}  // namespace skyquilt::buildings
