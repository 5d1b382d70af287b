#include "prepare/poses/pairs.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "core/base/random.h"
#include "prepare/poses/photo_places.h"
#include "tests/prepare/poses/made_photos.h"

namespace skyquilt::prepare::poses {
namespace {

using Places = std::vector<std::optional<PhotoPlace>>;

PhotoPlace Down(double x, double y) {
  return {{x, y}, {x, y}, {0.0, 0.0, -100.0}};
}

// One in ten without a place, one in ten at the spot of another.
Places RandomPlaces(size_t n, base::Random& random) {
  Places places;
  for (size_t i = 0; i < n; ++i) {
    const uint32_t kind = random.Below(10);
    if (kind == 0) {
      places.emplace_back();
    } else if (kind == 1 && i > 0) {
      places.push_back(places[random.Below(static_cast<uint32_t>(i))]);
    } else {
      const double east = random.Uniform(-1000.0, 1000.0);
      places.emplace_back(Down(east, random.Uniform(-10.0, 10.0)));
    }
  }
  return places;
}

std::vector<size_t> Degrees(size_t n, const PhotoPairs& pairs) {
  std::vector<size_t> degrees(n, 0);
  for (const PhotoPair& pair : pairs) {
    ++degrees[pair.a];
    ++degrees[pair.b];
  }
  return degrees;
}

RC_GTEST_PROP(PairsInSpace, AreOrderedBoundedAndEnough, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const auto n = *rc::gen::inRange<size_t>(0, 80);
  PairRules rules;
  rules.neighbors = *rc::gen::inRange<size_t>(1, 20);
  rules.sectors = *rc::gen::element(1UL, 6UL, 8UL, 16UL);
  const Places places = RandomPlaces(n, random);
  const auto n_with = static_cast<size_t>(std::count_if(places.begin(), places.end(), [](const auto& place) { return place.has_value(); }));
  const PhotoPairs pairs = PairsInSpace(places, rules);
  RC_ASSERT(std::adjacent_find(pairs.begin(), pairs.end(), std::greater_equal<>()) == pairs.end());
  for (const PhotoPair& pair : pairs) RC_ASSERT(pair.a < pair.b && pair.b < n && places[pair.a].has_value() && places[pair.b].has_value());
  RC_ASSERT(pairs.size() <= n_with * rules.neighbors);
  const std::vector<size_t> degrees = Degrees(n, pairs);
  for (size_t i = 0; i < n; ++i) RC_ASSERT((places[i] ? degrees[i] >= std::min(rules.neighbors, n_with - 1) : degrees[i] == 0));

  PhotoPairs connected = pairs;
  ConnectGroups(
      n, rules.links, [&](uint32_t photo) { return PlaceCosts(places, photo); }, connected);
  RC_ASSERT(CountGroups(n, connected) == std::min<size_t>(n, 1));
  RC_ASSERT(std::includes(connected.begin(), connected.end(), pairs.begin(), pairs.end()));
}

// Order of photos in the list does not matter where distances differ.
RC_GTEST_PROP(PairsInSpace, DoNotDependOnTheOrderOfPhotos, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  Places places;
  for (size_t i = 0; i < 50; ++i) {
    const double east = random.Uniform(0.0, 100.0);
    places.emplace_back(Down(east, random.Uniform(0.0, 100.0)));
  }
  const PhotoPairs pairs = PairsInSpace(places, PairRules{});
  Places reversed(places.rbegin(), places.rend());
  PhotoPairs back;
  for (const PhotoPair& pair : PairsInSpace(reversed, PairRules{})) back.push_back(MakePair(49 - pair.a, 49 - pair.b));
  SortPairs(back);
  RC_ASSERT(back == pairs);
}

// Lines so far apart that the nearest photos are all on the same line: the sectors lead across.
TEST(PairsInSpaceOfLines, LeadToBothNeighboringLines) {
  constexpr size_t kPerLine = 30;
  Places places;
  for (size_t i = 0; i < 4 * kPerLine; ++i)
    places.emplace_back(Down(10.0 * static_cast<double>(i % kPerLine), 90.0 * static_cast<double>(i / kPerLine)));
  const auto photos_without = [&](const PairRules& rules) {
    std::set<std::pair<size_t, size_t>> has;  // photo, line
    for (const PhotoPair& pair : PairsInSpace(places, rules)) {
      has.emplace(pair.a, pair.b / kPerLine);
      has.emplace(pair.b, pair.a / kPerLine);
    }
    size_t n_without = 0;
    for (size_t photo = 0; photo < places.size(); ++photo) {
      const size_t line = photo / kPerLine;
      n_without += (line > 0 && !has.contains({photo, line - 1})) || (line < 3 && !has.contains({photo, line + 1})) ? 1 : 0;
    }
    return n_without;
  };
  EXPECT_EQ(photos_without(PairRules{}), 0U);
  // All but those near the ends of the lines.
  EXPECT_GE(photos_without(PairRules{.sectors = 0}), 80U);
}

TEST(PairsInSpaceOfLines, AreTheNextOnesOnASingleLine) {
  Places one_line;
  for (size_t i = 0; i < 40; ++i) one_line.emplace_back(Down(0.0, 5.0 * static_cast<double>(i)));
  const PhotoPairs pairs = PairsInSpace(one_line, PairRules{});
  for (uint32_t i = 0; i + 1 < 40; ++i) EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), PhotoPair{i, i + 1})) << i;
  EXPECT_EQ(CountGroups(40, pairs), 1U);
  for (const PhotoPair& pair : pairs) EXPECT_LE(pair.b - pair.a, 14U);
}

// All at one spot: the next ones by name, and not the same few for all.
TEST(PairsInSpaceOfOneSpot, AreNeighborsInTheList) {
  const Places places(60, Down(3.0, 4.0));
  for (const PhotoPair& pair : PairsInSpace(places, PairRules{})) EXPECT_LE(pair.b - pair.a, 14U);
}

TEST(PairsInSpaceOfOpposites, PreferTheSameDirection) {
  // Three photos of the same spot: two from the south, the third from the north.
  PhotoPlace south{{0.0, -100.0}, {0.0, 0.0}, {0.0, 70.0, -70.0}}, south_too = south, north{{0.0, 100.0}, {0.0, 0.0}, {0.0, -70.0, -70.0}};
  south_too.target.x() = south_too.camera.x() = 50.0;
  const PairRules rules{.neighbors = 1, .position_neighbors = 0};
  const PhotoPairs pairs = PairsInSpace({south, north, south_too}, rules);
  EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), PhotoPair{0, 2}));
  // Nearest by camera too, in case that the angles are wrong.
  PhotoPlace beside{{0.0, -90.0}, {900.0, 0.0}, {70.0, 0.0, -70.0}};
  const PhotoPairs both = PairsInSpace({south, beside, south_too}, {.neighbors = 1, .position_neighbors = 1});
  EXPECT_TRUE(std::binary_search(both.begin(), both.end(), PhotoPair{0, 1}));
  EXPECT_TRUE(std::binary_search(both.begin(), both.end(), PhotoPair{0, 2}));
}

TEST(ConnectGroups, LinksWithTheShortestPairs) {
  Places places;
  for (size_t i = 0; i < 30; ++i) places.emplace_back(Down(static_cast<double>(i), 0.0));
  for (size_t i = 0; i < 20; ++i) places.emplace_back(Down(5000.0 + static_cast<double>(i), 0.0));
  PhotoPairs pairs = PairsInSpace(places, PairRules{});
  EXPECT_EQ(CountGroups(50, pairs), 2U);
  const size_t before = pairs.size();
  ConnectGroups(
      50, 3, [&](uint32_t photo) { return PlaceCosts(places, photo); }, pairs);
  EXPECT_EQ(CountGroups(50, pairs), 1U);
  EXPECT_EQ(pairs.size(), before + 3);
  for (const PhotoPair& pair : {PhotoPair{29, 30}, PhotoPair{29, 31}, PhotoPair{29, 32}}) {
    EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), pair)) << pair.a << "-" << pair.b;
  }
}

TEST(ConnectGroups, ConnectsEvenWithoutAnyKnowledge) {
  PhotoPairs pairs;
  ConnectGroups(
      9, 1, [](uint32_t) { return std::vector<double>(9, std::numeric_limits<double>::infinity()); }, pairs);
  EXPECT_EQ(CountGroups(9, pairs), 1U);
}

TEST(NamePairs, StayInTheList) {
  EXPECT_EQ(NamePairs({0, 4}, 5, 2), (PhotoPairs{{0, 1}, {0, 2}, {2, 4}, {3, 4}}));
  EXPECT_TRUE(NamePairs({}, 5, 2).empty());
  EXPECT_EQ(AllPairs(3), (PhotoPairs{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_TRUE(AllPairs(0).empty());
  EXPECT_TRUE(AllPairs(1).empty());
}

// The pairs of a flight are the same anywhere on Earth, up to ties between equal distances.
TEST(PairsAnywhereOnEarth, AreTheSame) {
  base::Random random(5);
  std::vector<Eigen::Vector2d> x(80);
  for (Eigen::Vector2d& position : x) position = {random.Uniform(-500.0, 500.0), random.Uniform(-500.0, 500.0)};
  const auto pairs_at = [&](const geo::Geodetic& origin) {
    const geo::EnuFrame frame(origin);
    std::vector<input::PhotoFile> photos;
    for (size_t i = 0; i < x.size(); ++i) photos.push_back(test::PhotoAt(i, x[i], frame));
    return PairsInSpace(FindPlaces(photos), PairRules{.sectors = 0});
  };
  const PhotoPairs here = pairs_at({47.0, 8.0, 400.0});
  for (const geo::Geodetic& origin : {geo::Geodetic{90.0, 0.0, 0.0}, geo::Geodetic{-90.0, 12.0, 2800.0}, geo::Geodetic{0.0, -180.0, 0.0},
                                      geo::Geodetic{71.0, 179.9999, 10.0}, geo::Geodetic{89.9999, 60.0, -400.0}}) {
    EXPECT_EQ(pairs_at(origin), here) << origin.latitude_deg << " " << origin.longitude_deg;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::poses
