// The made buildings of other tests are what they say.
#include "tests/buildings/sample_buildings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/sample_clouds.h"

namespace skyquilt::buildings {
namespace {

HousePlan Plan(RoofKind roof, double yaw = 0.4) {
  HousePlan plan;
  plan.roof = roof;
  plan.yaw_rad = yaw;
  plan.length_m = 16.0;
  plan.width_m = 12.0;
  return plan;
}

std::vector<Building> All() {
  HousePlan across = Plan(RoofKind::kGable);
  across.along_u = false;
  HousePlan upright = Plan(RoofKind::kHip);
  std::swap(upright.length_m, upright.width_m);
  return {MadeHouse(Plan(RoofKind::kFlat), 1),
          MadeHouse(Plan(RoofKind::kGable), 2),
          MadeHouse(across, 3),
          MadeHouse(Plan(RoofKind::kHip), 4),
          MadeHouse(upright, 5),
          MadeTHouse(Plan(RoofKind::kGable), {}, 6),
          MadeLHouse(Plan(RoofKind::kFlat), 5.0, 4.0, 103.0, 7),
          MadeCourtyard(Plan(RoofKind::kFlat), 3.0, 8)};
}

TEST(SampleBuildings, SolidsAreValid) {
  for (const Building& building : All()) {
    for (const Solid* solid : {&building.lod12, &building.lod22}) {
      for (const SolidProblem& problem : CheckSolid(*solid)) ADD_FAILURE() << building.id << ": " << problem.code << " " << problem.text;
      EXPECT_NEAR(Volume(*solid), building.measures.volume_m3.value, 1e-6);
    }
    EXPECT_NEAR(Area(building.lod22, FaceKind::kRoof), building.measures.roof_m2.value, 1e-6);
    EXPECT_NEAR(Area(building.lod22, FaceKind::kGround), building.measures.footprint_m2.value, 1e-6);
    EXPECT_NEAR(Area(building.footprint), building.measures.footprint_m2.value, 1e-6);
  }
}

TEST(SampleBuildings, VolumesHaveTheirClosedForms) {
  const auto volume = [](const Building& building) { return building.measures.volume_m3.value; };
  const double block = 16.0 * 12.0 * 5.0;
  EXPECT_NEAR(volume(MadeHouse(Plan(RoofKind::kFlat))), block, 1e-9);
  EXPECT_NEAR(volume(MadeHouse(Plan(RoofKind::kGable))), block + 0.5 * 16.0 * 12.0 * 3.0, 1e-9);
  // A prism over the ridge of 4 m and a pyramid of both ends.
  EXPECT_NEAR(volume(MadeHouse(Plan(RoofKind::kHip))), block + 0.5 * 4.0 * 12.0 * 3.0 + 12.0 * 12.0 * 3.0 / 3.0, 1e-9);
  EXPECT_NEAR(volume(MadeLHouse(Plan(RoofKind::kFlat))), block + 5.0 * 4.0 * 3.0, 1e-9);
  EXPECT_NEAR(volume(MadeCourtyard(Plan(RoofKind::kFlat))), block - 10.0 * 6.0 * 5.0, 1e-9);
}

TEST(SampleBuildings, TheLengthAxisPointsAlongTheLongerSide) {
  HousePlan upright = Plan(RoofKind::kFlat);
  std::swap(upright.length_m, upright.width_m);
  const double degrees = 0.4 * 180.0 / std::numbers::pi;
  EXPECT_NEAR(MadeHouse(Plan(RoofKind::kFlat)).measures.yaw_deg.value, degrees, 1e-9);
  EXPECT_NEAR(MadeHouse(upright).measures.yaw_deg.value, degrees + 90.0, 1e-9);
}

TEST(SampleClouds, PointsLieOnTheirSurfaces) {
  for (const Building& building : All()) {
    const MadeCloud made = MadeCloudOf({building});
    const Shape& shape = building.shape;
    double wall_points = 0.0;
    for (size_t i = 0; i < made.surface.size(); ++i) {
      const Eigen::Vector3d x = made.cloud.At(i);
      const Eigen::Vector2d uv = Eigen::Rotation2Dd(-shape.yaw_rad) * (x.head<2>() - shape.origin);
      const Eigen::Vector3f& normal = made.cloud.points[i].normal;
      ASSERT_NEAR(normal.norm(), 1.0F, 1e-5F);
      if (made.surface[i] == MadeSurface::kGround) {
        ASSERT_NEAR(x.z(), shape.ground_z, 1e-5);
        ASSERT_FALSE(Contains(building.footprint, x.head<2>()));
      } else if (made.surface[i] == MadeSurface::kRoof) {
        ASSERT_GT(normal.z(), 0.5F);
        // Single precision moves places by micrometres, over the roof's border too.
        const double height = MadeRoofHeight(building, uv);
        ASSERT_TRUE(std::isnan(height) || std::abs(x.z() - height) < 1e-4);
      } else {
        wall_points += 1.0;
        ASSERT_NEAR(normal.z(), 0.0F, 1e-6F);
        // Above its wing the L-shaped house has a wall inside the footprint.
        ASSERT_LT(DistanceToBorder(building.footprint, x.head<2>()), building.id == 7 ? 4.0 : 1e-4);
      }
    }
    // About a point per spacing^2.
    EXPECT_NEAR(wall_points, Area(building.lod22, FaceKind::kWall) / (0.28 * 0.28), 0.05 * wall_points);
  }
}

TEST(SampleClouds, NoiseIsAlongTheNormalAndTheSeedDecides) {
  const Building house = MadeHouse(Plan(RoofKind::kFlat));
  const MadeCloud made = MadeCloudOf({house}, {.noise_m = 0.1});
  double sum2 = 0.0, n = 0.0;
  for (size_t i = 0; i < made.surface.size(); ++i) {
    if (made.surface[i] != MadeSurface::kRoof) continue;
    sum2 += std::pow(made.cloud.At(i).z() - house.shape.parts[0].eave_z, 2.0);
    n += 1.0;
  }
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.1, 0.01);
  const auto same = [](const MadeCloud& a, const MadeCloud& b) {
    return std::equal(a.cloud.points.begin(), a.cloud.points.end(), b.cloud.points.begin(), b.cloud.points.end(),
                      [](const SurfacePoint& p, const SurfacePoint& q) { return p.position == q.position; });
  };
  EXPECT_TRUE(same(made, MadeCloudOf({house}, {.noise_m = 0.1})));
  EXPECT_FALSE(same(made, MadeCloudOf({house}, {.noise_m = 0.1, .seed = 2})));
  EXPECT_TRUE(MadeCloudOf({}).cloud.points.empty());
}

}  // namespace
}  // namespace skyquilt::buildings
