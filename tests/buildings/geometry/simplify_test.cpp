#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"
#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

double FarthestFrom(const Polygon& polygon, const Polygon& old) {
  double farthest = 0.0;
  const auto look = [&](const Ring& ring) {
    for (const Eigen::Vector2d& p : ring) farthest = std::max(farthest, DistanceToBorder(polygon, p));
  };
  look(old.outer);
  for (const Ring& hole : old.holes) look(hole);
  return farthest;
}

// Whether edges cross in their insides.
bool CrossesItself(const Polygon& polygon) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> edges;
  const auto add = [&](const Ring& ring) {
    for (size_t i = 0; i < ring.size(); ++i) edges.emplace_back(ring[i], ring[(i + 1) % ring.size()]);
  };
  add(polygon.outer);
  for (const Ring& hole : polygon.holes) add(hole);
  for (size_t i = 0; i < edges.size(); ++i) {
    for (size_t j = i + 1; j < edges.size(); ++j) {
      const auto& [a, b] = edges[i];
      const auto& [c, d] = edges[j];
      if (Cross2(b - a, c - a) * Cross2(b - a, d - a) < 0.0 && Cross2(d - c, a - c) * Cross2(d - c, b - c) < 0.0) return true;
    }
  }
  return false;
}

TEST(Simplified, TurnsStairsIntoLines) {
  // A square turned by 45 degrees, along cells.
  Polygon stairs;
  for (int i = 0; i < 20; ++i) {
    stairs.outer.emplace_back(i, -20 + i);
    stairs.outer.emplace_back(i + 1, -20 + i);
  }
  for (int i = 0; i < 20; ++i) {
    stairs.outer.emplace_back(20 - i, i);
    stairs.outer.emplace_back(20 - i, i + 1);
  }
  for (int i = 0; i < 20; ++i) {
    stairs.outer.emplace_back(-i, 20 - i);
    stairs.outer.emplace_back(-i - 1, 20 - i);
  }
  for (int i = 0; i < 20; ++i) {
    stairs.outer.emplace_back(-20 + i, -i);
    stairs.outer.emplace_back(-20 + i, -i - 1);
  }
  const Polygon simple = Simplified(stairs, 1.1);
  EXPECT_LE(simple.outer.size(), 8U);
  EXPECT_LE(FarthestFrom(simple, stairs), 1.1);
  EXPECT_NEAR(Area(simple), Area(stairs), 0.1 * Area(stairs));
}

TEST(Simplified, KeepsCornersOfRectanglesAndDropsStraightPoints) {
  Polygon box{{{0.0, 0.0}, {4.0, 0.05}, {10.0, 0.0}, {10.0, 4.0}, {0.0, 4.0}}, {}};
  box.holes.push_back({{2.0, 1.0}, {2.0, 2.0}, {3.0, 2.0}, {3.0, 1.0}});
  const Polygon simple = Simplified(box, 0.1);
  EXPECT_EQ(simple.outer.size(), 4U);
  ASSERT_EQ(simple.holes.size(), 1U);
  EXPECT_EQ(simple.holes[0].size(), 4U);
}

TEST(Simplified, StaysSimpleWhereAHoleIsNearerThanTheTolerance) {
  // The notch at the top would be cut off straight through the hole below it.
  Polygon polygon{{{0, 0}, {10, 0}, {10, 5}, {6, 5}, {5, 6}, {4, 5}, {0, 5}}, {{{4.8, 5.0}, {5.0, 5.5}, {5.2, 5.0}}}};
  const Polygon simple = Simplified(polygon, 1.5);
  EXPECT_FALSE(CrossesItself(simple));
  ASSERT_EQ(simple.holes.size(), 1U);
  for (const Eigen::Vector2d& p : simple.holes[0]) EXPECT_TRUE(Contains({simple.outer, {}}, p));
}

RC_GTEST_PROP(Simplified, IsNearTheOldOutlineWithFewerPointsAndSimple, (uint32_t seed)) {
  base::Random random(seed);
  const int columns = 12, rows = 12;
  std::vector<uint8_t> mask;
  for (int i = 0; i < columns * rows; ++i) mask.push_back(random.Below(10) < 7 ? 1 : 0);
  const double tolerance = random.Uniform(0.3, 2.5);
  for (const Polygon& old : OutlinesOf(mask, columns, rows, {0.0, 0.0}, 1.0)) {
    const Polygon simple = Simplified(old, tolerance);
    RC_ASSERT(simple.outer.size() <= old.outer.size());
    RC_ASSERT(simple.holes.size() == old.holes.size());
    RC_ASSERT(FarthestFrom(simple, old) <= tolerance + 1e-12);
    RC_ASSERT(!CrossesItself(simple));
    RC_ASSERT(Area(simple) > 0.0);
  }
}

}  // namespace
}  // namespace skyquilt::buildings
