#include "buildings/solids/flat_triangles.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <map>

#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"
#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

using Places = std::vector<Eigen::Vector2d>;
using Rings = std::vector<std::vector<uint32_t>>;

// Whether the triangles are counter-clockwise, cover the area of the rings, and have the rings' edges as border.
bool Covers(const Places& place, const Rings& rings, const std::vector<std::array<uint32_t, 3>>& triangles) {
  double rings_area = 0.0, area = 0.0;
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t a = ring[i], b = ring[(i + 1) % ring.size()];
      rings_area += 0.5 * Cross2(place[a], place[b]);
      --edges[{a, b}];
    }
  }
  for (const auto& t : triangles) {
    const double own = 0.5 * Cross2(place[t[1]] - place[t[0]], place[t[2]] - place[t[0]]);
    if (own < -1e-12) return false;
    area += own;
    for (size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, n] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    const int n_back = back == edges.end() ? 0 : back->second;
    if (n != 0 && (n != 1 || n_back != 1)) return false;
  }
  return std::abs(area - rings_area) < 1e-9 * (1.0 + rings_area);
}

TEST(FlatTriangles, OfStraightSidesHaveArea) {
  Places place;
  Rings rings(1);
  for (int i = 0; i < 5; ++i) place.emplace_back(i, 0.0);
  place.emplace_back(4.0, 3.0);
  place.emplace_back(0.0, 3.0);
  for (uint32_t i = 0; i < place.size(); ++i) rings[0].push_back(i);
  const auto triangles = FlatTriangles(place, rings);
  ASSERT_EQ(triangles.size(), 5U);
  EXPECT_TRUE(Covers(place, rings, triangles));
  for (const auto& [a, b, c] : triangles) EXPECT_GT(Cross2(place[b] - place[a], place[c] - place[a]), 0.1);
}

TEST(FlatTriangles, HolesMayTouchTheOuterRingAndEachOther) {
  // Two triangles with their tips in one corner of the southern side's middle, and one that touches the second.
  const Places place = {{0, 0}, {4, 0}, {8, 0}, {8, 8}, {0, 8}, {2, 2}, {3, 3}, {5, 3}, {6, 2}, {6, 5}, {5, 6}};
  const Rings rings = {{0, 1, 2, 3, 4}, {1, 5, 6}, {1, 7, 8}, {7, 10, 9}};
  const auto triangles = FlatTriangles(place, rings);
  EXPECT_EQ(triangles.size(), 12U);  // two fewer than corners of all rings
  EXPECT_TRUE(Covers(place, rings, triangles));
}

TEST(FlatTriangles, ThereAreNoneOfLines) {
  const Places place = {{0, 0}, {1, 1}, {2, 2}};
  EXPECT_TRUE(FlatTriangles(place, Rings{}).empty());
  EXPECT_TRUE(FlatTriangles(place, Rings{{0, 1}}).empty());
}

// Masks give rings with holes, many points of one line, and rings that touch.
RC_GTEST_PROP(FlatTriangles, CoverOutlinesOfMasks, (uint32_t seed)) {
  base::Random random(seed);
  const int columns = 2 + static_cast<int>(random.Below(8)), rows = 2 + static_cast<int>(random.Below(8));
  std::vector<uint8_t> mask;
  for (int i = 0; i < columns * rows; ++i) mask.push_back(random.Below(10) < 7 ? 1 : 0);
  const double yaw = random.Uniform(0.0, 6.0);
  for (const Polygon& polygon : OutlinesOf(mask, columns, rows, {0.0, 0.0}, 1.0)) {
    Places place;
    Rings rings;
    std::map<std::pair<double, double>, uint32_t> number;
    const auto add = [&](const Ring& ring) {
      rings.emplace_back();
      for (size_t i = 0; i < ring.size(); ++i) {
        // With a point in the middle of each edge.
        for (const Eigen::Vector2d& p : {ring[i], Eigen::Vector2d(0.5 * (ring[i] + ring[(i + 1) % ring.size()]))}) {
          const auto [found, is_new] = number.emplace(std::pair(p.x(), p.y()), static_cast<uint32_t>(place.size()));
          if (is_new) place.emplace_back(std::cos(yaw) * p.x() - std::sin(yaw) * p.y(), std::sin(yaw) * p.x() + std::cos(yaw) * p.y());
          rings.back().push_back(found->second);
        }
      }
    };
    add(polygon.outer);
    for (const Ring& hole : polygon.holes) add(hole);
    RC_ASSERT(Covers(place, rings, FlatTriangles(place, rings)));
  }
}

}  // namespace
}  // namespace skyquilt::buildings
