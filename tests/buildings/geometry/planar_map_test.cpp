#include "buildings/geometry/planar_map.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

void AddBorder(const Polygon& polygon, std::vector<Segment>* segments) {
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0; i < ring.size(); ++i) segments->push_back({ring[i], ring[(i + 1) % ring.size()]});
  };
  add(polygon.outer);
  for (const auto& hole : polygon.holes) add(hole);
}

PlanarMap MapOf(const std::vector<Polygon>& polygons, double snap_m) {
  std::vector<Segment> segments;
  for (const Polygon& polygon : polygons) AddBorder(polygon, &segments);
  return PlanarMap(segments, snap_m);
}

std::vector<int> CoveredBy(const PlanarMap& map, const std::vector<Polygon>& polygons) {
  std::vector<int> label;
  for (const Eigen::Vector2d& p : map.PointsInFaces()) {
    label.push_back(std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) { return Contains(polygon, p); }) ? 0 : -1);
  }
  return label;
}

TEST(PlanarMap, OfNothingHasNoFaces) {
  const PlanarMap map({}, 1e-3);
  EXPECT_EQ(map.Faces(), 0);
  EXPECT_TRUE(map.Regions({}, -1.0).empty());
}

TEST(PlanarMap, ABoxInABoxIsAHole) {
  const PlanarMap map = MapOf({Box(0, 0, 10, 10), Box(2, 2, 4, 4)}, 1e-3);
  EXPECT_EQ(map.Faces(), 2);
  std::vector<double> areas = map.FaceAreas();
  std::sort(areas.begin(), areas.end());
  EXPECT_NEAR(areas[0], 4.0, 1e-9);
  EXPECT_NEAR(areas[1], 96.0, 1e-9);
}

TEST(PlanarMap, DrawsEdgesToVerticesNearThem) {
  // The second box ends 2 mm beside the first one's side, and half-way along it.
  const PlanarMap map = MapOf({Box(0, 0, 10, 10), Box(10.002, 5, 12, 15)}, 3e-3);
  EXPECT_EQ(map.Faces(), 2);
  int inside = 0;
  for (uint32_t h = 0; h < map.HalfEdges(); ++h) inside += map.FaceOf(h) >= 0 && map.FaceOf(PlanarMap::Twin(h)) >= 0 ? 1 : 0;
  EXPECT_EQ(inside, 2);  // one edge in common
}

TEST(PlanarMap, EdgesAndSegmentsThatEndNowhereAreHarmless) {
  std::vector<Segment> segments;
  AddBorder(Box(0, 0, 10, 10), &segments);
  segments.push_back({{3, 3}, {5, 5}});
  segments.push_back({{9, 8}, {20, 8}});
  segments.push_back({{5, 0}, {5, 0}});
  segments.push_back({{std::nan(""), 0}, {5, 0}});
  const PlanarMap map(segments, 1e-3);
  ASSERT_EQ(map.Faces(), 1);
  EXPECT_NEAR(map.FaceAreas()[0], 100.0, 1e-9);
  const std::vector<MapRegion> regions = map.Regions(std::vector<int>{0}, -1.0);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].outer.size(), 6U);  // with the vertex put into the southern side, and where the long segment leaves
  EXPECT_EQ(map.Regions(std::vector<int>{0}, 1e-6)[0].outer.size(), 4U);
}

TEST(PlanarMap, RegionsThatTouchThemselvesHaveSimpleRings) {
  // Four boxes around a yard that is closed by a corner only.
  const std::vector<Polygon> boxes = {Box(0, 0, 3, 1), Box(0, 0, 1, 3), Box(0, 2, 2, 3), Box(2, 1, 3, 2), Box(2, 0, 3, 2)};
  const PlanarMap map = MapOf(boxes, 1e-3);
  const std::vector<MapRegion> regions = map.Regions(CoveredBy(map, boxes), 1e-6);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].holes.size(), 1U);
  EXPECT_NEAR(Area(map.OutlineOf(regions[0])), 7.0, 1e-9);
}

RC_GTEST_PROP(PlanarMap, RegionsAreTheUnion, (uint32_t seed)) {
  base::Random random(seed);
  std::vector<Polygon> stars;
  for (uint32_t i = 0; i < 1 + random.Below(4); ++i) stars.push_back(RandomStar(random));
  const PlanarMap map = MapOf(stars, 1e-7);
  const std::vector<double> areas = map.FaceAreas();
  const std::vector<int> label = CoveredBy(map, stars);
  double covered = 0.0, faces = 0.0;
  for (const MapRegion& region : map.Regions(label, 1e-9)) covered += Area(map.OutlineOf(region));
  for (size_t f = 0; f < areas.size(); ++f) {
    RC_ASSERT(areas[f] > 0.0);
    faces += label[f] == 0 ? areas[f] : 0.0;
  }
  double united = 0.0;
  for (const Polygon& polygon : Union(stars)) united += Area(polygon);
  RC_ASSERT(std::abs(covered - faces) < 1e-6);
  RC_ASSERT(std::abs(covered - united) < 1e-5);
}

}  // namespace
}  // namespace skyquilt::buildings
