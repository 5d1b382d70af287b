#include "buildings/classes/solid_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "buildings/classes/model_parts.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

HousePlan Flat() {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  plan.length_m = 16.0;
  plan.width_m = 14.0;
  return plan;
}

HousePlan Hip() {
  HousePlan plan;
  plan.roof = RoofKind::kHip;
  return plan;
}

// Euler: vertices - edges + faces = 2 for a ball; a face with a hole adds one, a passage through the body takes two.
TEST(SolidEdges, ClosedSolidsHaveEachEdgeOnceWithTwoFaces) {
  for (const Building& building : {MadeHouse({}), MadeHouse(Hip()), MadeHouse(Flat()), MadeTHouse({}, {})}) {
    const std::vector<SolidEdge> edges = EdgesOf(building.lod22);
    EXPECT_EQ(building.lod22.vertex.size() + building.lod22.face.size(), edges.size() + 2);
    for (const SolidEdge& edge : edges) EXPECT_GE(edge.other, 0);
  }
  EXPECT_EQ(EdgesOf(MadeCourtyard(Flat()).lod22).size(), 24U);
}

TEST(SolidEdges, AnglesAndSidesAreThoseOfABox) {
  for (const SolidEdge& edge : EdgesOf(MadeHouse(Flat()).lod22)) {
    EXPECT_NEAR(edge.angle_rad, 0.5 * std::numbers::pi, 1e-9);
    EXPECT_TRUE(edge.convex);
  }
}

TEST(SolidEdges, ValleysAndInnerCornersAreConcave) {
  // Two valleys, and the two corners between main part and wing.
  int concave = 0;
  for (const SolidEdge& edge : EdgesOf(MadeTHouse({}, {}).lod22)) concave += edge.convex ? 0 : 1;
  EXPECT_EQ(concave, 4);
}

TEST(SolidEdges, AnOpenSolidHasEdgesOfOneFace) {
  Solid solid = MadeHouse(Flat()).lod22;
  solid.face.erase(solid.face.begin());
  int open = 0;
  for (const SolidEdge& edge : EdgesOf(solid)) open += edge.other < 0 ? 1 : 0;
  EXPECT_EQ(open, 4);
}

TEST(SolidEdges, NormalsPointOut) {
  const Solid solid = MadeHouse(Flat()).lod22;
  for (const Face& face : solid.face) {
    const Eigen::Vector3d normal = NormalOf(solid, face);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
    const double up = face.kind == FaceKind::kRoof ? 1.0 : face.kind == FaceKind::kGround ? -1.0 : 0.0;
    EXPECT_NEAR(normal.z(), up, 1e-12);
  }
  EXPECT_TRUE(NormalOf(solid, Face{FaceKind::kWall, {0, 1, 0}, {}}).isZero());
}

TEST(ModelParts, FlatHousesHaveFourCornersAndEightEdges) {
  const ModelParts parts = PartsOf(MadeHouse(Flat()));
  EXPECT_EQ(parts.faces.size(), 5U);
  EXPECT_EQ(parts.edges.size(), 8U);  // the four at the ground are hidden
  EXPECT_EQ(parts.corners.size(), 4U);
}

// The border of the roof's parts in plan is the roofprint.
TEST(ModelParts, OverhangsReachTheRoofprint) {
  for (const double yaw : {0.0, 1.1}) {
    HousePlan gable, hip = Hip();
    gable.yaw_rad = hip.yaw_rad = yaw;
    for (const Building& building : {MadeHouse(gable), MadeHouse(hip), MadeTHouse(gable, {})}) {
      const ModelParts parts = PartsOf(building);
      for (const Eigen::Vector2d& corner : building.roofprint[0].outer) {
        double nearest = 1e9;
        for (const ModelCorner& found : parts.corners) nearest = std::min(nearest, (found.place.head<2>() - corner).norm());
        EXPECT_LT(nearest, 1e-9) << building.overhang_m;
      }
    }
  }
}

TEST(ModelParts, OverhangsLieInThePlanesOfTheirRoofs) {
  const HousePlan plan;
  const double slope = (plan.ridge_z - plan.eave_z) / (0.5 * plan.width_m);
  int lowest = 0;
  for (const ModelCorner& corner : PartsOf(MadeHouse(plan)).corners) {
    if (std::abs(corner.place.z() - (plan.eave_z - slope * plan.overhang_m)) < 1e-9) ++lowest;
  }
  EXPECT_EQ(lowest, 4);
}

TEST(FlatPolygon, DistancesAreToThePolygonAndItsHolesAreOpen) {
  const std::vector<Eigen::Vector3d> outer = {{0, 0, 1}, {10, 0, 1}, {10, 10, 1}, {0, 10, 1}}, hole = {{4, 4, 1}, {4, 6, 1}, {6, 6, 1}, {6, 4, 1}};
  const FlatPolygon polygon({outer, hole}, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(polygon.Distance({2, 2, 3}, 5.0), 2.0, 1e-12);
  EXPECT_NEAR(polygon.Distance({-3, 5, 5}, 9.0), 5.0, 1e-12);
  EXPECT_NEAR(polygon.Distance({5, 5, 1}, 5.0), 1.0, 1e-12);
  EXPECT_NEAR(polygon.Distance({11, 11, 1}, 5.0), std::sqrt(2.0), 1e-12);
  EXPECT_TRUE(std::isinf(polygon.Distance({2, 2, 3}, 1.5)));
}

}  // namespace
}  // namespace skyquilt::buildings
