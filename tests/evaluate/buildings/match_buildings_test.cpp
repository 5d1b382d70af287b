#include "evaluate/buildings/match_buildings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"
#include "tests/evaluate/buildings/buildings_sample.h"

namespace skyquilt::evaluate::buildings {
namespace {

std::vector<Polygon> RandomSquares(size_t n, base::Random& random) {
  std::vector<Polygon> squares;
  for (size_t i = 0; i < n; ++i) {
    const double x = random.Uniform(0.0, 40.0), y = random.Uniform(0.0, 40.0);
    squares.push_back(Square(x, y, random.Uniform(3.0, 12.0)));
  }
  return squares;
}

TEST(MatchFootprints, IsOneToOneAndBestFirst) {
  base::Random random(5);
  for (int round = 0; round < 20; ++round) {
    const std::vector<Polygon> found = RandomSquares(25, random);
    std::vector<Polygon> truth = RandomSquares(25, random);
    for (size_t i = 0; i < 12; ++i) {  // some that agree more or less
      truth[i] = found[2 * i];
      for (Eigen::Vector2d& point : truth[i].outer) point += Eigen::Vector2d{random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0)} * 0.5;
    }
    const std::vector<BuildingPair> pairs = MatchFootprints(found, truth);
    EXPECT_FALSE(pairs.empty());
    std::set<size_t> f, t;
    for (size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_GE(pairs[i].overlap, kMatchingOverlap);
      EXPECT_LE(pairs[i].overlap, 1.0 + 1e-9);
      EXPECT_LE(pairs[i].overlap, pairs[i == 0 ? 0 : i - 1].overlap);
      f.insert(pairs[i].found);
      t.insert(pairs[i].truth);
    }
    EXPECT_EQ(f.size(), pairs.size());
    EXPECT_EQ(t.size(), pairs.size());
    // Nobody is left over who could be paired.
    for (size_t a = 0; a < found.size(); ++a) {
      for (size_t b = 0; b < truth.size(); ++b) {
        if (f.contains(a) || t.contains(b)) continue;
        EXPECT_LT(skyquilt::buildings::IntersectionOverUnion(std::span(&found[a], 1), std::span(&truth[b], 1)), kMatchingOverlap + 1e-9);
      }
    }
    EXPECT_EQ(MatchFootprints(truth, found).size(), pairs.size()) << "neither side is preferred";
  }
}

TEST(MatchFootprints, TheBetterOfTwoWins) {
  const std::vector<Polygon> truth = {Square(0, 0, 10)};
  const std::vector<Polygon> found = {Square(2, 0, 10), Square(1, 0, 10)};
  const std::vector<BuildingPair> pairs = MatchFootprints(found, truth);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].found, 1U);
  EXPECT_NEAR(pairs[0].overlap, 90.0 / 110.0, 1e-9);
  EXPECT_TRUE(MatchFootprints({}, truth).empty());
  EXPECT_TRUE(MatchFootprints(found, {}).empty());
}

struct Fates {
  BuildingMatches matches;
  size_t Found(FoundFate fate) const { return static_cast<size_t>(std::count(matches.found.begin(), matches.found.end(), fate)); }
  size_t True(TrueFate fate) const { return static_cast<size_t>(std::count(matches.truth.begin(), matches.truth.end(), fate)); }
};

TrueBuilding OutlineOver(const Polygon& walls, bool inside = true) {
  TrueBuilding outline;
  outline.walls = walls;
  outline.area_m2 = Area(walls);
  outline.inside = inside;
  return outline;
}

Fates FatesOf(const std::vector<Polygon>& footprints, const TrueBuildings& truth) {
  BuildingSet set;
  for (const Polygon& footprint : footprints) set.buildings.emplace_back().footprint = footprint;
  return {MatchBuildings(set, truth)};
}

TEST(MatchBuildings, WhatIsMissingIsMissedAndWhatIsTooMuchInvented) {
  const TrueBuildings truth{{OutlineOver(Square(0, 0, 10)), OutlineOver(Square(20, 0, 10)), OutlineOver(Square(40, 0, 10))}, std::nullopt};
  const Fates fates = FatesOf({Square(0.5, 0, 10), Square(100, 0, 8)}, truth);
  EXPECT_EQ(fates.True(TrueFate::kMatched), 1U);
  EXPECT_EQ(fates.True(TrueFate::kMissed), 2U);
  EXPECT_EQ(fates.Found(FoundFate::kMatched), 1U);
  EXPECT_EQ(fates.Found(FoundFate::kInvented), 1U);
  ASSERT_TRUE(fates.matches.pair_of_found[0].has_value());
  EXPECT_FALSE(fates.matches.pair_of_found[1].has_value());
}

TEST(MatchBuildings, AtTheEdgeOfTheSurveyNothingCounts) {
  TrueBuildings truth{{OutlineOver(Square(0, 0, 10)), OutlineOver(Square(45, 0, 10), false)}, Square(-50, -50, 100)};
  // One that matches the outline at the edge, one that is a piece of it, one beyond the area.
  const Fates fates = FatesOf({Square(0, 0, 10), Square(45, 0, 10), Square(60, 0, 10)}, truth);
  EXPECT_EQ(fates.True(TrueFate::kNotCounted), 1U);
  EXPECT_EQ(fates.True(TrueFate::kMissed), 0U);
  EXPECT_EQ(fates.Found(FoundFate::kMatched), 1U);
  EXPECT_EQ(fates.Found(FoundFate::kNotCounted), 2U);
  EXPECT_EQ(FatesOf({Square(46, 1, 3)}, truth).Found(FoundFate::kNotCounted), 1U);
  EXPECT_EQ(FatesOf({Square(20, 20, 10)}, truth).Found(FoundFate::kInvented), 1U) << "well inside";
  truth.area.reset();
  EXPECT_EQ(FatesOf({Square(60, 0, 10)}, truth).Found(FoundFate::kInvented), 1U) << "nobody knows where the area ends";
}

TEST(MatchBuildings, SmallOutlinesDoNotCount) {
  const TrueBuildings truth{{OutlineOver(Square(0, 0, 3)), OutlineOver(Square(20, 0, 3.2))}, std::nullopt};
  const Fates none = FatesOf({}, truth), both = FatesOf({Square(0, 0, 3), Square(20, 0, 3.2)}, truth);
  EXPECT_EQ(none.True(TrueFate::kNotCounted), 1U);
  EXPECT_EQ(none.True(TrueFate::kMissed), 1U);
  EXPECT_EQ(both.Found(FoundFate::kNotCounted), 1U);
  EXPECT_EQ(both.Found(FoundFate::kMatched), 1U);
}

TEST(MatchBuildings, OneThatOverlapsBothBelongsWhereItOverlapsMost) {
  const TrueBuildings truth{{OutlineOver(Square(0, 0, 10)), OutlineOver(Square(12, 0, 10), false)}, std::nullopt};
  const Polygon mostly_counted{{{6, 0}, {14, 0}, {14, 2}, {6, 2}}, {}}, mostly_not{{{8, 0}, {18, 0}, {18, 2}, {8, 2}}, {}};
  EXPECT_EQ(FatesOf({mostly_counted}, truth).Found(FoundFate::kInvented), 1U);
  EXPECT_EQ(FatesOf({mostly_not}, truth).Found(FoundFate::kNotCounted), 1U);
}

}  // namespace
}  // namespace skyquilt::evaluate::buildings
