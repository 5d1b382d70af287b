#include "simulate/solar_farm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/thread_pool.h"
#include "core/raytrace/traced_scene.h"
#include "simulate/classify.h"
#include "simulate/flight.h"
#include "simulate/world.h"

namespace skyquilt::simulate {
namespace {

class SolarFarm : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base::ThreadPool threads(2);
    SimulateOptions options;
    options.place = "solar_farm";
    place_ = new PlaceSpec(ResolvePlace(options));
    place_->ambient_voxel_m = 24.0;
    world_ = new World(*place_, 1.0, threads);
  }
  static void TearDownTestSuite() {
    delete world_;
    delete place_;
  }
  // What is seen from straight above.
  static Hit Above(float east, float north) {
    raytrace::RayPacket ray;
    ray.valid.fill(0);
    ray.Set(0, {east, north, 50.0F}, -Eigen::Vector3f::UnitZ(), 0.1F, 100.0F);
    world_->scene().Intersect(ray);
    Hit hit;
    hit.position = {east, north, 50.0F - ray.t_far[0]};
    hit.normal = world_->mesh().FaceNormal(ray.triangle[0]);
    hit.direction = -Eigen::Vector3f::UnitZ();
    hit.footprint_m = 0.02F;
    hit.tag = world_->mesh().tag[ray.triangle[0]];
    return hit;
  }

  static inline PlaceSpec* place_ = nullptr;
  static inline World* world_ = nullptr;
};

TEST_F(SolarFarm, IsFlownInAboutFortyPhotos) {
  EXPECT_EQ(PlanFlight(*place_, 0.0).size(), 40U);
  EXPECT_TRUE(world_->buildings().empty());
  EXPECT_EQ(world_->city(), nullptr);
}

TEST_F(SolarFarm, TablesAreTiltedToTheSouthAndStandAboveTheGround) {
  const Hit low = Above(0.3F, -1.5F), high = Above(0.3F, 1.5F), between = Above(0.3F, 0.5F * kRowPitch_m);
  EXPECT_EQ(low.tag.part, Part::kSolarPanel);
  EXPECT_EQ(high.tag.part, Part::kSolarPanel);
  EXPECT_EQ(between.tag.part, Part::kGround);
  EXPECT_NEAR(high.position.z() - low.position.z(), 3.0 * std::tan(25.0 * M_PI / 180.0), 1e-3);
  EXPECT_GT(low.position.z() - between.position.z(), 0.7F);
  EXPECT_LT(low.normal.y(), -0.4F);
  EXPECT_GT(low.normal.z(), 0.9F);
  EXPECT_EQ(ClassOf(low.tag, low.position, nullptr), survey::SurfaceClass::kRoof);
  EXPECT_EQ(ClassOf(between.tag, between.position, nullptr), survey::SurfaceClass::kGround);
}

// That is what makes them hard to tell apart.
TEST_F(SolarFarm, AllTablesLookTheSame) {
  float least = 1.0F, most = 0.0F;
  for (float along = -11.0F; along < 11.0F; along += 0.37F) {
    const Hit here = Above(along, 0.9F);
    const Hit there = Above(along + 2.0F * kTablePitch_m, 0.9F - 5.0F * kRowPitch_m);
    ASSERT_EQ(here.tag.part, Part::kSolarPanel);
    ASSERT_EQ(there.tag.part, Part::kSolarPanel);
    const Surface a = world_->SurfaceAt(here), b = world_->SurfaceAt(there);
    EXPECT_LT((a.albedo - b.albedo).norm(), 0.02F) << along;
    least = std::min(least, a.albedo.x());
    most = std::max(most, a.albedo.x());
  }
  EXPECT_LT(least, 0.02F);  // cells
  EXPECT_GT(most, 0.4F);    // frames
  const Surface ground = world_->SurfaceAt(Above(0.3F, 0.5F * kRowPitch_m));
  EXPECT_GT(ground.albedo.y(), 0.05F);
}

}  // namespace
}  // namespace skyquilt::simulate
