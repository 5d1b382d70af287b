// Cells between wall lines: graph cut, pieces, rectangles, and wings that join roofs.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "buildings/shape/cell_pieces.h"
#include "buildings/shape/cell_rectangles.h"
#include "buildings/shape/graph_cut.h"
#include "buildings/shape/joined_wings.h"
#include "tests/buildings/shape/made_candidates.h"

namespace skyquilt::buildings {
namespace {

// Against all 2^n labellings.
RC_GTEST_PROP(GraphCut, IsTheCheapestOfAllLabellings, ()) {
  const size_t n = *rc::gen::inRange<size_t>(1, 9);
  std::vector<double> inside(n), outside(n);
  for (size_t i = 0; i < n; ++i) {
    inside[i] = *rc::gen::inRange(0, 50);
    outside[i] = *rc::gen::inRange(0, 50);
  }
  std::vector<std::vector<double>> pair(n, std::vector<double>(n, 0.0));
  GraphCut cut(n);
  for (size_t i = 0; i < n; ++i) {
    cut.AddNode(i, inside[i], outside[i]);
    for (size_t k = i + 1; k < n; ++k) {
      pair[i][k] = *rc::gen::inRange(0, 20);
      cut.AddPair(i, k, pair[i][k]);
    }
  }
  const auto cost_of = [&](const auto& is_inside) {
    double cost = 0.0;
    for (size_t i = 0; i < n; ++i) {
      cost += is_inside(i) ? inside[i] : outside[i];
      for (size_t k = i + 1; k < n; ++k) cost += is_inside(i) != is_inside(k) ? pair[i][k] : 0.0;
    }
    return cost;
  };
  double least = std::numeric_limits<double>::infinity();
  for (unsigned labels = 0; labels < (1U << n); ++labels) {
    least = std::min(least, cost_of([&](size_t i) { return ((labels >> i) & 1U) != 0; }));
  }
  const std::vector<uint8_t> found = cut.Solve();
  RC_ASSERT(std::abs(cost_of([&](size_t i) { return found[i] != 0; }) - least) < 1e-3);
}

TEST(GraphCut, WithoutCostsAllIsOutside) {
  EXPECT_TRUE(GraphCut(0).Solve().empty());
  EXPECT_EQ(GraphCut(2).Solve(), (std::vector<uint8_t>{0, 0}));
}

TEST(CellPieces, CornersDoNotConnect) {
  EXPECT_TRUE(IsOnePiece({1, 1, 0, 1}, 2, 2));
  EXPECT_FALSE(IsOnePiece({1, 0, 0, 1}, 2, 2));
  EXPECT_FALSE(IsOnePiece({1, 0, 1}, 3, 1));
  EXPECT_FALSE(IsOnePiece({0, 0}, 2, 1));
  EXPECT_FALSE(IsOnePiece({}, 0, 0));
  // Connected around, but two cells touch at a corner only.
  EXPECT_FALSE(IsOnePiece({1, 1, 1, 1, 0, 1, 1, 1, 0}, 3, 3));
  EXPECT_EQ(LabelPieces({1, 0, 0, 1}, 2, 2), (std::vector<int>{0, -1, -1, 1}));
  const auto never = [](int, int, int) { return false; };
  EXPECT_EQ(LabelPieces({1, 1}, 2, 1, never), (std::vector<int>{0, 1}));
}

TEST(MaximalRectangles, OfAnLAndARing) {
  const std::vector<CellRectangle> l_shape = {{0, 1, 0, 2}, {0, 2, 0, 1}};
  EXPECT_EQ(MaximalRectangles({1, 1, 1, 0}, 2, 2), l_shape);
  EXPECT_EQ(MaximalRectangles({1, 1, 1, 1, 0, 1, 1, 1, 1}, 3, 3).size(), 4U);
  EXPECT_TRUE(MaximalRectangles({0, 0}, 2, 1).empty());
}

// Each is full and cannot grow, and together they cover the mask.
RC_GTEST_PROP(MaximalRectangles, CoverTheMask, (uint32_t bits)) {
  const int columns = 6, rows = 5;
  std::vector<uint8_t> mask(30);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<uint8_t>((bits >> i) & 1U);
  std::vector<uint8_t> covered(mask.size(), 0);
  for (const CellRectangle& r : MaximalRectangles(mask, columns, rows)) {
    for (int row = r.v0; row < r.v1; ++row) {
      for (int column = r.u0; column < r.u1; ++column) {
        RC_ASSERT(mask[static_cast<size_t>(row * columns + column)] != 0);
        covered[static_cast<size_t>(row * columns + column)] = 1;
      }
    }
  }
  RC_ASSERT(covered == mask);
}

TEST(CellRectangle, WithoutAnother) {
  CellRectangle rest;
  ASSERT_TRUE(Without({0, 1, 0, 3}, {0, 3, 2, 3}, &rest));
  EXPECT_EQ(rest, (CellRectangle{0, 1, 0, 2}));
  EXPECT_FALSE(Without({0, 3, 0, 3}, {1, 2, 1, 2}, &rest));  // a hole
  EXPECT_FALSE(Without({1, 2, 0, 3}, {0, 3, 1, 2}, &rest));  // two pieces
  EXPECT_FALSE(Without({0, 2, 0, 2}, {1, 3, 1, 3}, &rest));  // an L
  EXPECT_FALSE(Without({0, 1, 0, 1}, {0, 2, 0, 2}, &rest));  // nothing
  EXPECT_FALSE(Without({0, 1, 0, 1}, {1, 2, 0, 1}, &rest));  // side by side
}

Shape TwoParts(const Part& main, const Part& wing) {
  Shape shape = AxesAt(0.0, {0.0, 4.0, 8.0, 12.0}, {-6.0, 0.0, 8.0});
  shape.parts = {main, wing};
  return shape;
}

TEST(MayJoin, OnlyIntoSlopesThatFallTowardsThem) {
  const Part main = PitchedPart(RoofKind::kGable, 0, 3, 1, 2, true, 105.0, 109.0);
  const Part wing = PitchedPart(RoofKind::kGable, 1, 2, 0, 1, false, 105.0, 107.0);
  const auto joins = [](const Shape& shape) { return MayJoin(shape, shape.parts[1]); };
  EXPECT_EQ(joins(TwoParts(main, wing)), 0);
  EXPECT_EQ(joins(TwoParts(PitchedPart(RoofKind::kHip, 0, 3, 1, 2, true, 105.0, 109.0), wing)), 0);
  EXPECT_EQ(joins(TwoParts(FlatPart(0, 3, 1, 2, 109.0), wing)), -1);
  EXPECT_EQ(joins(TwoParts(PitchedPart(RoofKind::kGable, 0, 3, 1, 2, false, 105.0, 109.0), wing)), -1);  // its gable wall
  EXPECT_EQ(joins(TwoParts(main, PitchedPart(RoofKind::kGable, 1, 2, 0, 1, true, 105.0, 107.0))), -1);   // ridge along the wall
  EXPECT_EQ(joins(TwoParts(main, PitchedPart(RoofKind::kGable, 1, 2, 0, 1, false, 102.0, 104.0))), -1);  // below the eaves
  EXPECT_EQ(joins(TwoParts(main, PitchedPart(RoofKind::kGable, 1, 2, 0, 1, false, 107.0, 111.0))), -1);  // above the ridge
  EXPECT_EQ(
      joins(TwoParts(PitchedPart(RoofKind::kGable, 0, 2, 1, 2, true, 105.0, 109.0), PitchedPart(RoofKind::kGable, 1, 3, 0, 1, false, 105.0, 107.0))),
      -1);  // reaches past its end
}

}  // namespace
}  // namespace skyquilt::buildings
