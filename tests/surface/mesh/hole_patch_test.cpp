#include "surface/mesh/hole_patch.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

using Border = std::vector<Eigen::Vector3d>;

double AreaOf(const Border& border) {
  double area = 0.0;
  for (size_t i = 0; i < border.size(); ++i) {
    area += 0.5 * DoubleAreaFromAbove(border[0].head<2>(), border[i].head<2>(), border[(i + 1) % border.size()].head<2>());
  }
  return area;
}

TEST(CrossesItself, TellsSimplePolygons) {
  EXPECT_FALSE(CrossesItself(Border{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_FALSE(CrossesItself(Border{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}));            // straight on
  EXPECT_TRUE(CrossesItself(Border{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}));                        // bow tie
  EXPECT_TRUE(CrossesItself(Border{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}}));                        // folds back
  EXPECT_TRUE(CrossesItself(Border{{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 0, 5}, {0, 2, 0}}));             // touches an edge
  EXPECT_TRUE(CrossesItself(Border{{0, 0, 0}, {2, 2, 0}, {4, 0, 0}, {4, 4, 0}, {2, 2, 1}, {0, 4, 0}}));  // touches a vertex
}

TEST(CutEars, TriangulatesPolygonsWithStraightSides) {
  Border square;
  for (int i = 0; i < 10; ++i) square.emplace_back(i, 0, 0);
  for (int i = 0; i < 10; ++i) square.emplace_back(10, i, 0);
  for (int i = 0; i < 10; ++i) square.emplace_back(10 - i, 10, 0);
  for (int i = 0; i < 10; ++i) square.emplace_back(0, 10 - i, 0);
  const auto triangles = CutEars(square);
  ASSERT_TRUE(triangles.has_value());
  EXPECT_EQ(triangles->size(), 38U);
}

TEST(CutEars, GivesUpOnLines) {
  EXPECT_FALSE(CutEars(Border{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}).has_value());
  EXPECT_FALSE(CutEars(Border{{0, 0, 0}, {1, 0, 0}}).has_value());
  EXPECT_FALSE(MakeHolePatch(Border{}, 1.0).has_value());
}

TEST(MakeHolePatch, TheMiddleOfADomeIsBetweenLowestAndHighest) {
  Border border;
  constexpr int kN = 40;
  for (int i = 0; i < kN; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kN;
    border.emplace_back(3.0 * std::cos(angle), 3.0 * std::sin(angle), std::cos(2.0 * angle));
  }
  const auto patch = MakeHolePatch(border, 0.5);
  ASSERT_TRUE(patch.has_value());
  ASSERT_GT(patch->inner.size(), 50U);
  for (const Eigen::Vector3d& x : patch->inner) {
    EXPECT_LT(std::abs(x.z()), 1.0);
    // The membrane of this border is a saddle.
    EXPECT_NEAR(x.z(), (x.x() * x.x() - x.y() * x.y()) / 9.0, 0.15);
  }
}

// Star-shaped borders with deep notches.
RC_GTEST_PROP(MakeHolePatch, CoversThePolygonOnce, ()) {
  const std::vector<double> radii =
      *rc::gen::container<std::vector<double>>(*rc::gen::inRange<size_t>(3, 60), rc::gen::element(0.3, 1.0, 1.1, 2.0, 4.0));
  const double spacing_m = *rc::gen::element(0.0, 0.2, 1.0);
  Border border;
  for (size_t i = 0; i < radii.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(radii.size());
    border.emplace_back(1000.0 + radii[i] * std::cos(angle), radii[i] * std::sin(angle) - 1000.0, 0.1 * radii[i]);
  }
  const auto patch = MakeHolePatch(border, spacing_m);
  RC_ASSERT(patch.has_value());
  Border point = border;
  point.insert(point.end(), patch->inner.begin(), patch->inner.end());
  RC_ASSERT(patch->triangle.size() == border.size() - 2 + 2 * patch->inner.size());  // Euler's formula
  double area = 0.0;
  for (const Triangle& t : patch->triangle) {
    const double double_area = DoubleAreaFromAbove(point[t[0]].head<2>(), point[t[1]].head<2>(), point[t[2]].head<2>());
    RC_ASSERT(double_area > 0.0);
    RC_ASSERT(std::max({t[0], t[1], t[2]}) >= border.size());
    area += 0.5 * double_area;
  }
  RC_ASSERT(std::abs(area - AreaOf(border)) < 1e-9 * area + 1e-9);
}

}  // namespace
}  // namespace skyquilt::surface
