#include "evaluate/photos/pixel_groups.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace skyquilt::evaluate::photos {
namespace {

// Two blocks of 100 m x 100 m, west and east, with 10 m margins.
std::vector<geo::BlockBox> WestAndEast() {
  return {{{0, 0, 0}, {100, 100, 20}, 10.0}, {{100, 0, 0}, {200, 100, 20}, 10.0}};
}

TEST(BlockAt, EveryPointOfTheAreaBelongsToExactlyOneBlock) {
  const auto boxes = WestAndEast();
  EXPECT_EQ(BlockAt({99.999, 50, 0}, boxes), 0);
  EXPECT_EQ(BlockAt({100.0, 50, 0}, boxes), 1);
  EXPECT_EQ(BlockAt({0.0, 0.0, 0}, boxes), 0);
  EXPECT_EQ(BlockAt({200.0, 50, 0}, boxes), -1);
  EXPECT_EQ(BlockAt({-0.1, 50, 0}, boxes), -1);
  EXPECT_EQ(BlockAt({50, 50, 0}, {}), -1);
}

TEST(ZoneAt, SeamIsWhereGrownBoxesOverlap) {
  const auto boxes = WestAndEast();
  EXPECT_EQ(ZoneAt({95, 50, 0}, 0, boxes), Zone::kSeam);
  EXPECT_EQ(ZoneAt({105, 50, 0}, 1, boxes), Zone::kSeam);
  EXPECT_EQ(ZoneAt({89, 50, 0}, 0, boxes), Zone::kInterior);
  EXPECT_EQ(ZoneAt({111, 50, 0}, 1, boxes), Zone::kInterior);
}

TEST(ZoneAt, OuterRimIsNeitherSeamNorInterior) {
  const auto boxes = WestAndEast();
  EXPECT_EQ(ZoneAt({5, 50, 0}, 0, boxes), Zone::kRim);
  EXPECT_EQ(ZoneAt({50, 95, 0}, 0, boxes), Zone::kRim);
  EXPECT_EQ(ZoneAt({300, 50, 0}, -1, boxes), Zone::kOutside);
}

TEST(ZoneAt, SingleBlockHasNoSeam) {
  const std::vector<geo::BlockBox> one = {{{0, 0, 0}, {100, 100, 20}, 10.0}};
  for (double x = 0.5; x < 100.0; x += 1.0) EXPECT_NE(ZoneAt({x, 50, 0}, 0, one), Zone::kSeam);
}

TEST(AddPixel, PsnrOfAKnownDifference) {
  skyquilt::metrics::SquaredError error;
  EXPECT_TRUE(std::isnan(skyquilt::metrics::PsnrOf(error)));
  const float a[3] = {0.5F, 0.5F, 0.5F};
  const float b[3] = {0.6F, 0.6F, 0.6F};
  AddPixel(a, b, &error);
  EXPECT_NEAR(skyquilt::metrics::PsnrOf(error), 20.0, 1e-4);  // mean squared error 0.01
  AddPixel(a, a, &error);
  EXPECT_NEAR(skyquilt::metrics::PsnrOf(error), 20.0 + 10.0 * std::log10(2.0), 1e-4);
  EXPECT_EQ(PixelsOf(error), 2);
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
