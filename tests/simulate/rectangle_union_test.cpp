#include "simulate/rectangle_union.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/random.h"
#include "tests/simulate/is_inside.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr int kGrid = 12;

// Rectangles on a grid, each but the first overlapping an earlier one, so that they are connected.
std::vector<Rectangle2d> RandomRectangles(base::Random& random) {
  std::vector<Rectangle2d> made;
  while (made.size() < 7) {
    const double min_y = random.Below(kGrid - 1), min_x = random.Below(kGrid - 1);
    const Vector2d min(min_x, min_y);
    const Rectangle2d one{min, {min.x() + 1 + random.Below(static_cast<uint32_t>(kGrid - min.x())), min.y() + 1 + random.Below(3)}};
    const bool touches = std::any_of(made.begin(), made.end(), [&](const Rectangle2d& other) {
      return (one.max.cwiseMin(other.max) - one.min.cwiseMax(other.min)).minCoeff() > 0.5;
    });
    if (made.empty() || touches) made.push_back(one);
  }
  return made;
}

bool Covers(const std::vector<Rectangle2d>& rectangles, const Vector2d& at) {
  return std::any_of(rectangles.begin(), rectangles.end(),
                     [&](const Rectangle2d& one) { return (at - one.min).minCoeff() > 0.0 && (one.max - at).minCoeff() > 0.0; });
}

TEST(RectangleUnion, IsInsideWhereARectangleIs) {
  base::Random random(3);
  int n_with_holes = 0;
  for (int round = 0; round < 600; ++round) {
    const std::vector<Rectangle2d> rectangles = RandomRectangles(random);
    const RectangleUnion made = UnionOf(rectangles);
    n_with_holes += made.holes.empty() ? 0 : 1;
    double area = SignedArea(made.outer);
    EXPECT_GT(area, 0.0);
    for (const Ring& hole : made.holes) {
      EXPECT_LT(SignedArea(hole), 0.0);
      area += SignedArea(hole);
    }
    double covered = 0.0;
    for (int j = 0; j < 2 * kGrid; ++j) {
      for (int i = 0; i < 2 * kGrid; ++i) {
        const Vector2d at(i + 0.5, j + 0.5);
        const bool in_hole = std::any_of(made.holes.begin(), made.holes.end(), [&](const Ring& hole) { return IsInside(hole, at); });
        ASSERT_EQ(IsInside(made.outer, at) && !in_hole, Covers(rectangles, at)) << at.transpose();
        covered += Covers(rectangles, at) ? 1.0 : 0.0;
      }
    }
    EXPECT_NEAR(area, covered, 1e-9);
  }
  EXPECT_GT(n_with_holes, 10);
}

TEST(RectangleUnion, RingsHaveCornersOnly) {
  base::Random random(4);
  for (int round = 0; round < 100; ++round) {
    RectangleUnion made = UnionOf(RandomRectangles(random));
    made.holes.push_back(made.outer);
    for (const Ring& ring : made.holes) {
      ASSERT_GE(ring.size(), 4U);
      for (size_t i = 0; i < ring.size(); ++i) {
        const Vector2d before = ring[(i + 1) % ring.size()] - ring[i], after = ring[(i + 2) % ring.size()] - ring[(i + 1) % ring.size()];
        EXPECT_GT(before.norm(), 0.5);
        EXPECT_NEAR(before.dot(after), 0.0, 1e-12);  // a right angle
      }
    }
  }
}

TEST(RectangleUnion, SidesThatDifferByRoundingAreOneLine) {
  const std::vector<Rectangle2d> halves = {{{0.0, 0.0}, {5.0, 3.0}}, {{5.0 + 1e-9, -1e-9}, {9.0, 3.0 + 1e-9}}};
  const RectangleUnion made = UnionOf(halves);
  EXPECT_EQ(made.outer.size(), 4U);
  EXPECT_NEAR(SignedArea(made.outer), 27.0, 1e-6);
  EXPECT_TRUE(made.holes.empty());
}

}  // namespace
}  // namespace skyquilt::simulate
