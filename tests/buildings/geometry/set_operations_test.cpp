#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "buildings/geometry/polygon.h"
#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

using Polygons = std::vector<Polygon>;

double TotalArea(const Polygons& polygons) {
  return std::accumulate(polygons.begin(), polygons.end(), 0.0, [](double sum, const Polygon& p) { return sum + Area(p); });
}

bool AnyContains(const Polygons& polygons, const Eigen::Vector2d& p) {
  return std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) { return Contains(polygon, p); });
}

double NearestBorder(const Polygons& polygons, const Eigen::Vector2d& p) {
  double least = 1e9;
  for (const Polygon& polygon : polygons) least = std::min(least, DistanceToBorder(polygon, p));
  return least;
}

TEST(SetOperations, OfNothingAreEmpty) {
  EXPECT_TRUE(Union({}).empty());
  EXPECT_TRUE(Union(Polygons{Polygon{}}).empty());
  EXPECT_TRUE(Intersection(Polygon{}, Box(0, 0, 1, 1)).empty());
  EXPECT_TRUE(Difference(Polygon{}, Polygons{Box(0, 0, 1, 1)}).empty());
  ASSERT_EQ(Difference(Box(0, 0, 1, 1), {}).size(), 1U);
  EXPECT_EQ(IntersectionOverUnion({}, {}), 0.0);
  EXPECT_EQ(IntersectionOverUnion(Polygons{Box(0, 0, 1, 1)}, {}), 0.0);
}

TEST(SetOperations, BoxesJoinAndPart) {
  const Polygons apart = Union(Polygons{Box(0, 0, 1, 1), Box(2, 0, 3, 1)});
  EXPECT_EQ(apart.size(), 2U);
  const Polygons joined = Union(Polygons{Box(0, 0, 1, 1), Box(1, 0, 3, 1)});
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_NEAR(Area(joined[0]), 3.0, 1e-12);
  EXPECT_TRUE(Intersection(Box(0, 0, 1, 1), Box(1, 0, 2, 1)).empty());
  const Polygons ring = Difference(Box(0, 0, 9, 9), Polygons{Box(3, 3, 6, 6)});
  ASSERT_EQ(ring.size(), 1U);
  ASSERT_EQ(ring[0].holes.size(), 1U);
  EXPECT_NEAR(Area(ring[0]), 72.0, 1e-12);
  const Polygons halves = Difference(Box(0, 0, 9, 3), Polygons{Box(3, -1, 6, 4)});
  EXPECT_EQ(halves.size(), 2U);
  EXPECT_NEAR(TotalArea(halves), 18.0, 1e-12);
}

TEST(SetOperations, SliversAreLeftOut) {
  EXPECT_TRUE(Difference(Box(0, 0, 1, 1), Polygons{Box(1e-7, 0, 1, 1)}).empty());
}

TEST(SetOperations, FourWallsEncloseACourtyard) {
  const Polygons yard = Union(Polygons{Box(0, 0, 10, 2), Box(8, 0, 10, 10), Box(0, 8, 10, 10), Box(0, 0, 2, 10)});
  ASSERT_EQ(yard.size(), 1U);
  ASSERT_EQ(yard[0].holes.size(), 1U);
  EXPECT_NEAR(Area(yard[0]), 64.0, 1e-12);
  EXPECT_FALSE(Contains(yard[0], {5.0, 5.0}));
}

TEST(SetOperations, IntersectionOverUnionOfShiftedBoxes) {
  const Polygon box = Moved(Box(0, 0, 10, 10), 0.4, {5e5, 5e6});
  const Polygon shifted = Moved(Box(5, 0, 15, 10), 0.4, {5e5, 5e6});
  EXPECT_NEAR(IntersectionOverUnion(Polygons{box}, Polygons{box}), 1.0, 1e-9);
  EXPECT_NEAR(IntersectionOverUnion(Polygons{box}, Polygons{shifted}), 1.0 / 3.0, 1e-7);
  // Overlaps within a set count once.
  EXPECT_NEAR(IntersectionOverUnion(Polygons{box, box, shifted}, Polygons{shifted}), 2.0 / 3.0, 1e-7);
}

RC_GTEST_PROP(SetOperations, AgreeWithPointsInside, (uint32_t seed)) {
  base::Random random(seed);
  Polygons stars;
  for (int i = 0; i < 4; ++i) stars.push_back(RandomStar(random));
  const std::span<const Polygon> rest = std::span<const Polygon>(stars).subspan(1);
  const Polygons all = Union(stars), common = Intersection(stars[0], stars[1]), left = Difference(stars[0], rest);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d p{random.Uniform(-5.0, 15.0), random.Uniform(-5.0, 15.0)};
    if (NearestBorder(stars, p) < 1e-6) continue;
    RC_ASSERT(AnyContains(all, p) == AnyContains(stars, p));
    RC_ASSERT(AnyContains(common, p) == (Contains(stars[0], p) && Contains(stars[1], p)));
    RC_ASSERT(AnyContains(left, p) == (Contains(stars[0], p) && !AnyContains({rest.begin(), rest.end()}, p)));
  }
  RC_ASSERT(std::abs(TotalArea(Union(Polygons{stars[0], stars[1]})) - (Area(stars[0]) + Area(stars[1]) - TotalArea(common))) < 1e-5);
  for (const Polygon& polygon : all) {
    RC_ASSERT(Area({polygon.outer, {}}) > 0.0);
    for (const auto& hole : polygon.holes) RC_ASSERT(Area({hole, {}}) < 0.0);
  }
}

RC_GTEST_PROP(SetOperations, IntersectionOverUnionAgreesWithSampling, (uint32_t seed)) {
  base::Random random(seed);
  const Polygons a = {RandomStar(random), RandomStar(random)}, b = {RandomStar(random), RandomStar(random)};
  int both = 0, any = 0;
  constexpr int kPlaces = 120;  // per side of 20 m
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < kPlaces; ++j) {
      const Eigen::Vector2d p(-5.0 + 20.0 * (i + 0.5) / kPlaces, -5.0 + 20.0 * (j + 0.5) / kPlaces);
      const bool in_a = AnyContains(a, p), in_b = AnyContains(b, p);
      both += in_a && in_b ? 1 : 0;
      any += in_a || in_b ? 1 : 0;
    }
  }
  RC_ASSERT(any > 0);
  // Some hundred places lie next to borders.
  RC_ASSERT(std::abs(IntersectionOverUnion(a, b) - static_cast<double>(both) / any) < 0.03);
}

// Walls of Manhattan buildings have many edges in common, which is hard for set operations in floating point.
RC_GTEST_PROP(SetOperations, TurnedBoxesOnAGridJoinWithoutLoss, (uint32_t seed)) {
  base::Random random(seed);
  const double angle = random.Uniform(0.0, 3.0);
  const Eigen::Vector2d by{random.Uniform(-500.0, 500.0), random.Uniform(-500.0, 500.0)};
  constexpr int kCells = 8;
  std::vector<bool> covered(kCells * kCells, false);
  Polygons boxes;
  for (int i = 0; i < 6; ++i) {
    const int west = static_cast<int>(random.Below(kCells)), south = static_cast<int>(random.Below(kCells));
    const int east = west + 1 + static_cast<int>(random.Below(static_cast<uint32_t>(kCells - west)));
    const int north = south + 1 + static_cast<int>(random.Below(static_cast<uint32_t>(kCells - south)));
    boxes.push_back(Moved(Box(1.3 * west, 1.3 * south, 1.3 * east, 1.3 * north), angle, by));
    for (int x = west; x < east; ++x) {
      for (int y = south; y < north; ++y) covered[static_cast<size_t>(y * kCells + x)] = true;
    }
  }
  const double cells = static_cast<double>(std::count(covered.begin(), covered.end(), true));
  RC_ASSERT(std::abs(TotalArea(Union(boxes)) - 1.69 * cells) < 1e-5);
}

}  // namespace
}  // namespace skyquilt::buildings
