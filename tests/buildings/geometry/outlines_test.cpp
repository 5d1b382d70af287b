#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "buildings/geometry/polygon.h"
#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

// Rows from north to south, as they are drawn.
std::vector<Polygon> Outlines(const std::vector<std::string>& drawn) {
  std::vector<uint8_t> mask;
  for (auto row = drawn.rbegin(); row != drawn.rend(); ++row) {
    for (const char c : *row) mask.push_back(c == '#' ? 1 : 0);
  }
  return OutlinesOf(mask, static_cast<int>(drawn[0].size()), static_cast<int>(drawn.size()), {0.0, 0.0}, 1.0);
}

TEST(OutlinesOf, EmptyMasksHaveNone) {
  EXPECT_TRUE(OutlinesOf({}, 0, 0, {0.0, 0.0}, 1.0).empty());
  EXPECT_TRUE(Outlines({"...", "..."}).empty());
}

TEST(OutlinesOf, OneCellIsPlacedByOriginAndSize) {
  const std::vector<uint8_t> mask = {0, 0, 0, 0, 0, 7};
  const std::vector<Polygon> found = OutlinesOf(mask, 3, 2, {10.0, 20.0}, 0.5);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].outer.size(), 4U);
  EXPECT_NEAR(Area(found[0]), 0.25, 1e-12);
  EXPECT_LT((Centroid(found[0]) - Eigen::Vector2d(11.25, 20.75)).norm(), 1e-12);
}

TEST(OutlinesOf, StraightBordersHaveNoPoints) {
  const std::vector<Polygon> found = Outlines({"##..", "####"});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].outer.size(), 6U);
}

TEST(OutlinesOf, CellsThatTouchAtACornerAreTwoPartsSortedByArea) {
  const std::vector<Polygon> found = Outlines({"#..", ".##"});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(Area(found[0]), 2.0, 1e-12);
  EXPECT_NEAR(Area(found[1]), 1.0, 1e-12);
}

TEST(OutlinesOf, ARingThatClosesAtACornerHasAHole) {
  const std::vector<Polygon> found = Outlines({"##.", "#.#", "###"});
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found[0].holes.size(), 1U);
  EXPECT_NEAR(Area(found[0]), 7.0, 1e-12);
  EXPECT_NEAR(Area({found[0].holes[0], {}}), -1.0, 1e-12);
}

TEST(OutlinesOf, HolesThatTouchAtACornerAreTwo) {
  const std::vector<Polygon> found = Outlines({"####", "#.##", "##.#", "####"});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].holes.size(), 2U);
}

TEST(OutlinesOf, PartsInHolesAreTheirOwn) {
  const std::vector<Polygon> found = Outlines({"#####", "#...#", "#.#.#", "#...#", "#####"});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].holes.size(), 1U);
  EXPECT_NEAR(Area(found[1]), 1.0, 1e-12);
}

RC_GTEST_PROP(OutlinesOf, ContainExactlyTheCells, (uint32_t seed)) {
  base::Random random(seed);
  const int columns = 1 + static_cast<int>(random.Below(14)), rows = 1 + static_cast<int>(random.Below(14));
  const uint32_t share = 1 + random.Below(9);
  std::vector<uint8_t> mask;
  for (int i = 0; i < columns * rows; ++i) mask.push_back(random.Below(10) < share ? 1 : 0);
  const Eigen::Vector2d origin(-3.0, 17.0);
  const std::vector<Polygon> found = OutlinesOf(mask, columns, rows, origin, 0.5);
  double area = 0.0;
  for (const Polygon& polygon : found) {
    RC_ASSERT(Area({polygon.outer, {}}) > 0.0);
    for (const auto& hole : polygon.holes) RC_ASSERT(Area({hole, {}}) < 0.0);
    for (size_t i = 0; i < polygon.outer.size(); ++i) {
      // Rings pass a corner once.
      RC_ASSERT(std::count(polygon.outer.begin(), polygon.outer.end(), polygon.outer[i]) == 1);
    }
    area += Area(polygon);
  }
  RC_ASSERT(std::abs(area - 0.25 * static_cast<double>(std::count(mask.begin(), mask.end(), uint8_t{1}))) < 1e-9);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d p = origin + 0.5 * Eigen::Vector2d(column + 0.5, row + 0.5);
      const auto holders = std::count_if(found.begin(), found.end(), [&](const Polygon& polygon) { return Contains(polygon, p); });
      RC_ASSERT(holders == (mask[static_cast<size_t>(row * columns + column)] != 0 ? 1 : 0));
    }
  }
}

}  // namespace
}  // namespace skyquilt::buildings
