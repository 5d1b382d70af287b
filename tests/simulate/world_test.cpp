#include "simulate/world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <mutex>
#include <vector>

#include "simulate/flight.h"
#include "simulate/photo_renderer.h"

namespace skyquilt::simulate {
namespace {

PlaceSpec PlaceNamed(const std::string& name) {
  SimulateOptions options;
  options.place = name;
  return ResolvePlace(options);
}

class TownWorld : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    threads_ = new base::ThreadPool(2);
    PlaceSpec place = PlaceNamed("town");
    // Coarse trees and coarse ambient light are enough for these tests.
    place.city.tree_detail = 0;
    place.ambient_voxel_m = 12.0;
    world_ = new World(place, 1.0, *threads_);
  }
  static void TearDownTestSuite() {
    delete world_;
    delete threads_;
  }
  struct Traced {
    bool hit = false;
    float distance_m = 0.0F;
    Tag tag;
  };
  static Traced Trace(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    raytrace::RayPacket ray;
    ray.valid.fill(0);
    ray.Set(0, origin.cast<float>(), direction.cast<float>(), 0.0F, 1e4F);
    world_->scene().Intersect(ray);
    if (ray.triangle[0] == raytrace::kNoTriangle) return {};
    return {true, ray.t_far[0], world_->mesh().tag[ray.triangle[0]]};
  }
  static Eigen::Vector3d Place(const Building& b, double x, double y, double z) {
    const Eigen::Vector2d u = b.Axis();
    const Eigen::Vector2d at = b.centre + x * u + y * Eigen::Vector2d(-u.y(), u.x());
    return {at.x(), at.y(), b.ground_z_m + z};
  }

  static base::ThreadPool* threads_;
  static World* world_;
};
base::ThreadPool* TownWorld::threads_ = nullptr;
World* TownWorld::world_ = nullptr;

TEST_F(TownWorld, HasLowAndHighBuildingsWithFlatAndPitchedRoofs) {
  double highest = 0.0;
  int n_flat = 0;
  int n_gable = 0;
  int n_hip = 0;
  for (const Building& b : world_->buildings()) {
    highest = std::max(highest, b.ridge_height_m);
    EXPECT_GE(b.length_m, b.width_m);
    EXPECT_GE(b.ridge_height_m, b.eave_height_m);
    n_flat += b.roof == RoofKind::kFlat ? 1 : 0;
    n_gable += b.roof == RoofKind::kGable ? 1 : 0;
    n_hip += b.roof == RoofKind::kHip ? 1 : 0;
  }
  EXPECT_GT(highest, 18.0);
  EXPECT_LE(highest, 31.0);
  EXPECT_GT(n_flat, 3);
  EXPECT_GT(n_gable, 3);
  EXPECT_GT(n_hip, 3);
}

TEST_F(TownWorld, RoofsStandAtTheStatedHeights) {
  for (size_t i = 0; i < world_->buildings().size(); ++i) {
    const Building& b = world_->buildings()[i];
    const double hw = 0.5 * b.width_m;
    const double slope = (b.ridge_height_m - b.eave_height_m) / hw;
    for (const double y : {0.02, hw - 0.6}) {
      // Flat roofs have a parapet 0.25 m wide; points 0.6 m from the edge are not on it.
      const double expected = b.roof == RoofKind::kFlat ? b.eave_height_m : b.ridge_height_m - slope * y;
      const Traced traced = Trace(Place(b, 0.0, y, 100.0), -Eigen::Vector3d::UnitZ());
      ASSERT_TRUE(traced.hit);
      // Some flat roofs have machines on them.
      if (traced.tag.part == Part::kRooftopBox) continue;
      EXPECT_EQ(traced.tag.object, i);
      EXPECT_TRUE(traced.tag.part == Part::kFlatRoof || traced.tag.part == Part::kPitchedRoof);
      EXPECT_NEAR(100.0 - static_cast<double>(traced.distance_m), expected, 0.01) << KindName(b.kind) << " " << i << " y " << y;
    }
  }
}

TEST_F(TownWorld, WallsStandAtTheStatedLengthAndWidth) {
  for (const Building& b : world_->buildings()) {
    const double z = 0.6 * b.eave_height_m;
    const Eigen::Vector2d u = b.Axis();
    const Eigen::Vector3d along(u.x(), u.y(), 0.0);
    const Eigen::Vector3d across(-u.y(), u.x(), 0.0);
    for (const double side : {-1.0, 1.0}) {
      const Traced end = Trace(Place(b, side * (0.5 * b.length_m + 0.3), 0.1, z), -side * along);
      ASSERT_TRUE(end.hit);
      EXPECT_NEAR(end.distance_m, 0.3F, 1e-3F);
      const Traced front = Trace(Place(b, 0.1, side * (0.5 * b.width_m + 0.3), z), -side * across);
      ASSERT_TRUE(front.hit);
      EXPECT_NEAR(front.distance_m, 0.3F, 1e-3F);
    }
  }
}

TEST_F(TownWorld, BuildingsKeepClearOfEachOther) {
  const std::vector<Building>& buildings = world_->buildings();
  for (size_t i = 0; i < buildings.size(); ++i) {
    for (size_t j = 0; j < buildings.size(); ++j) {
      if (i == j) continue;
      const Eigen::Vector2d u = buildings[j].Axis();
      const Eigen::Vector2d v(-u.y(), u.x());
      for (const double x : {-0.5, 0.0, 0.5}) {
        for (const double y : {-0.5, 0.0, 0.5}) {
          const Eigen::Vector2d corner = buildings[j].centre + x * buildings[j].length_m * u + y * buildings[j].width_m * v;
          EXPECT_GT(buildings[i].DistanceTo(corner), 0.3) << i << " " << j;
        }
      }
    }
  }
}

TEST_F(TownWorld, CarsMoveAndAreMasked) {
  const MovingScene before = world_->MovingAt(0.0);
  const MovingScene after = world_->MovingAt(2.0);
  ASSERT_EQ(before.cars.size(), 3U);
  for (size_t i = 0; i < before.cars.size(); ++i) EXPECT_GT((before.cars[i].position - after.cars[i].position).norm(), 5.0);
  // A camera right above the first car sees it in the middle at one moment and not at the other.
  camera::Camera camera;
  camera.model = camera::CameraModel::kSimplePinhole;
  camera.width = 33;
  camera.height = 31;
  camera.params = {60.0, 16.5, 15.5};
  const PhotoRenderer renderer(*world_, camera, 1, true);
  const Eigen::Vector3d above(before.cars[0].position.x(), before.cars[0].position.y(), before.cars[0].ground_z_m + 12.0);
  const geo::Rigid3d pose = PoseFromGimbal(above, 0.0, -90.0, 0.0);
  const Rendering seen = renderer.Render(pose, before, *threads_);
  const Rendering gone = renderer.Render(pose, after, *threads_);
  ASSERT_FALSE(seen.usable.Empty());
  EXPECT_EQ(*seen.usable.At(16, 15), 0);
  if (!gone.usable.Empty()) {
    EXPECT_EQ(*gone.usable.At(16, 15), 255);
  }
  const image::ImageF near = renderer.Surfaces(pose, before, *threads_).z_depth;
  const image::ImageF far = renderer.Surfaces(pose, after, *threads_).z_depth;
  EXPECT_GT(*far.At(16, 15) - *near.At(16, 15), 1.0F);
  EXPECT_LT(*far.At(16, 15) - *near.At(16, 15), 2.3F);
}

TEST_F(TownWorld, SharesOfARenderingAddUpToOne) {
  camera::Camera camera;
  camera.model = camera::CameraModel::kSimplePinhole;
  camera.width = 21;
  camera.height = 18;  // not a multiple of the renderer's tiles
  camera.params = {30.0, 10.5, 9.0};
  const PhotoRenderer renderer(*world_, camera, 1, false);
  const geo::Rigid3d pose = PoseFromGimbal({0.0, 0.0, 80.0}, 0.0, -90.0, 0.0);
  const MovingScene moving = world_->MovingAt(0.0);
  std::mutex mutex;
  double sum = 0.0;
  int n = 0;
  const Rendering told = renderer.Render(pose, moving, *threads_, [&](double share) {
    const std::lock_guard lock(mutex);
    sum += share;
    ++n;
  });
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_GT(n, 3);
  EXPECT_TRUE(told.rgb_linear.data == renderer.Render(pose, moving, *threads_).rgb_linear.data);
}

class HillsideWorld : public testing::Test {
 protected:
  static constexpr double kSlope_deg = 20.0;
  static void SetUpTestSuite() {
    base::ThreadPool threads(2);
    SimulateOptions options;
    options.place = "town";
    options.hillside_deg = kSlope_deg;
    PlaceSpec place = ResolvePlace(options);
    place.city.tree_detail = 0;
    place.ambient_voxel_m = 24.0;
    world_ = new World(place, 1.0, threads);
  }
  static void TearDownTestSuite() { delete world_; }

  static double Ground(double east, double north) {
    return static_cast<double>(world_->terrain().Height(static_cast<float>(east), static_cast<float>(north)));
  }
  // The vertices of this part of the scene.
  static std::vector<Eigen::Vector3d> Vertices(const Mesh& mesh, Part part) {
    std::vector<Eigen::Vector3d> found;
    for (size_t i = 0; i < mesh.triangle.size(); ++i) {
      if (mesh.tag[i].part != part) continue;
      for (const uint32_t vertex : mesh.triangle[i]) found.push_back(mesh.position[vertex].cast<double>());
    }
    return found;
  }

  static World* world_;
};
World* HillsideWorld::world_ = nullptr;

TEST_F(HillsideWorld, RisesToTheNorthEast) {
  // A plane through heights at a grid of points.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (double east = -100.0; east <= 100.0; east += 10.0) {
    for (double north = -100.0; north <= 100.0; north += 10.0) {
      const Eigen::Vector3d row(east, north, 1.0);
      normal += row * row.transpose();
      right += Ground(east, north) * row;
    }
  }
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  // Rolling ground and ponds bend it by a degree or so.
  EXPECT_NEAR(std::atan(plane.head<2>().norm()) * 180.0 / M_PI, kSlope_deg, 1.5);
  EXPECT_NEAR(plane.x() / plane.y(), 1.0, 0.1);
  EXPECT_NEAR(plane.z(), 0.0, 2.0);
}

TEST_F(HillsideWorld, BuildingsHaveNoGapBelow) {
  for (const Building& b : world_->buildings()) {
    EXPECT_NEAR(b.ground_z_m, Ground(b.centre.x(), b.centre.y()), 1e-4);
    const Eigen::Vector2d u = b.Axis();
    const Eigen::Vector2d v(-u.y(), u.x());
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Eigen::Vector2d corner = b.centre + x * b.length_m * u + y * b.width_m * v;
        EXPECT_LT(b.ground_z_m - b.foundation_m, Ground(corner.x(), corner.y()));
      }
    }
  }
}

// Cars would be half a metre in the air at one end if they stood level.
TEST_F(HillsideWorld, CarsStandAlongTheGround) {
  const MovingScene moving = world_->MovingAt(4.0);
  for (const Mesh* mesh : {&world_->mesh(), &moving.mesh}) {
    const std::vector<Eigen::Vector3d> tyres = Vertices(*mesh, Part::kCarTyre);
    ASSERT_GT(tyres.size(), 10U);
    for (const Eigen::Vector3d& vertex : tyres) {
      const double above = vertex.z() - Ground(vertex.x(), vertex.y());
      EXPECT_GT(above, -0.45);
      EXPECT_LT(above, 0.65);
    }
  }
}

TEST_F(HillsideWorld, PondsStayWithinTheirShores) {
  const std::vector<Eigen::Vector3d> water = Vertices(world_->mesh(), Part::kWater);
  ASSERT_GT(water.size(), 30U);
  for (const Eigen::Vector3d& vertex : water) EXPECT_LT(vertex.z() - Ground(vertex.x(), vertex.y()), 1.7);
  int n_edge = 0;
  for (size_t i = 0; i < water.size(); ++i) {
    if (i % 3 == 0) continue;  // the middle of the pond
    EXPECT_LT(water[i].z() - Ground(water[i].x(), water[i].y()), 0.1);
    ++n_edge;
  }
  EXPECT_GT(n_edge, 20);
}

TEST_F(TownWorld, LightIsFiniteAndShadowsAreDarker) {
  const Sky& sky = world_->sky();
  for (const Building& b : world_->buildings()) {
    const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
    const Eigen::Vector3f roof = Place(b, 0.0, 0.0, b.ridge_height_m + 0.1).cast<float>();
    const Eigen::Vector3f light = world_->ambient().Irradiance(roof, up);
    EXPECT_TRUE(light.allFinite());
    EXPECT_GT(light.minCoeff(), 0.05F);
    // On a roof the sun is brighter than the sky.
    EXPECT_LT(light.x(), sky.sun_over_pi().x() * sky.sun_direction().z());
  }
}

}  // namespace
}  // namespace skyquilt::simulate
