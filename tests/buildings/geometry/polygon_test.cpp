#include "buildings/geometry/polygon.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

Polygon BoxWithHole() {
  Polygon box = Box(0.0, 0.0, 10.0, 6.0);
  box.holes.push_back({{2.0, 2.0}, {2.0, 4.0}, {4.0, 4.0}, {4.0, 2.0}});
  return box;
}

TEST(Polygon, MeasuresSubtractHolesFarFromTheOriginToo) {
  for (const Eigen::Vector2d& by : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(5e5, -6e6)}) {
    const Polygon polygon = Moved(BoxWithHole(), 0.3, by);
    EXPECT_NEAR(Area(polygon), 56.0, 1e-6);
    EXPECT_NEAR(Perimeter(polygon), 40.0, 1e-6);
    const Polygon middle = Moved({{{(60.0 * 5.0 - 4.0 * 3.0) / 56.0, 3.0}}, {}}, 0.3, by);
    EXPECT_LT((Centroid(polygon) - middle.outer[0]).norm(), 1e-6);
  }
}

TEST(Polygon, WithoutAreaHasACentroid) {
  EXPECT_EQ(Area(Polygon{}), 0.0);
  EXPECT_EQ(Centroid(Polygon{}), Eigen::Vector2d::Zero());
  const Eigen::Vector2d middle = Centroid(Polygon{{{1.0, 1.0}, {3.0, 3.0}}, {}});
  EXPECT_NEAR((middle - Eigen::Vector2d(2.0, 2.0)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(Contains(Polygon{}, {0.0, 0.0}));
  EXPECT_EQ(DistanceToBorder(Polygon{}, {0.0, 0.0}), std::numeric_limits<double>::infinity());
}

TEST(Polygon, HolesAreOutsideAndTheirEdgesAreBorder) {
  const Polygon polygon = BoxWithHole();
  EXPECT_TRUE(Contains(polygon, {1.0, 1.0}));
  EXPECT_FALSE(Contains(polygon, {3.0, 3.0}));
  EXPECT_FALSE(Contains(polygon, {11.0, 3.0}));
  EXPECT_NEAR(DistanceToBorder(polygon, {3.0, 3.5}), 0.5, 1e-12);
  EXPECT_NEAR(DistanceToBorder(polygon, {13.0, 10.0}), 5.0, 1e-12);
}

TEST(Rectangle, OutlineHasItsSizesAndDirection) {
  const Rectangle rectangle{{1.0, 2.0}, {0.6, 0.8}, {5.0, 2.0}};
  const Polygon outline = rectangle.Outline();
  EXPECT_NEAR(Area(outline), 40.0, 1e-12);
  EXPECT_LT((Centroid(outline) - rectangle.centre).norm(), 1e-12);
  EXPECT_LT((outline.outer[1] - outline.outer[0] - 10.0 * rectangle.axis).norm(), 1e-12);
}

// Against the winding of the ring seen from the point, summed angle by angle.
RC_GTEST_PROP(Polygon, ContainsAsTheWindingNumber, (uint32_t seed)) {
  base::Random random(seed);
  const Polygon star = RandomStar(random);
  const auto winding = [](const std::vector<Eigen::Vector2d>& ring, const Eigen::Vector2d& p) {
    double sum = 0.0;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d a = ring[i] - p, b = ring[(i + 1) % ring.size()] - p;
      sum += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    return static_cast<int>(std::lround(sum / (2.0 * std::numbers::pi)));
  };
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector2d p{random.Uniform(-5.0, 15.0), random.Uniform(-5.0, 15.0)};
    if (DistanceToBorder(star, p) < 1e-9) continue;
    int turns = winding(star.outer, p);
    for (const auto& hole : star.holes) turns += winding(hole, p);
    RC_ASSERT(Contains(star, p) == (turns == 1));
  }
}

}  // namespace
}  // namespace skyquilt::buildings
