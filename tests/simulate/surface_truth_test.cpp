// The true surface of a simulated survey: depth, normals, classes and the mesh must tell the same story.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "core/base/file.h"
#include "core/scene/depth_normals.h"
#include "core/survey/surface_class.h"
#include "simulate/classify.h"
#include "simulate/flight.h"
#include "simulate/photo_renderer.h"
#include "simulate/surface_mesh.h"
#include "simulate/world.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3d;
using survey::SurfaceClass;

class SurfaceTruth : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    threads_ = new base::ThreadPool(2);
    SimulateOptions options;
    options.place = "town";
    place_ = new PlaceSpec(ResolvePlace(options));
    place_->city.tree_detail = 0;
    place_->ambient_voxel_m = 24.0;
    world_ = new World(*place_, 1.0, *threads_);
    photos_ = new std::vector<PhotoPlan>(PlanFlight(*place_, world_->TakeoffHeight(*place_)));
  }
  static void TearDownTestSuite() {
    delete photos_;
    delete world_;
    delete place_;
    delete threads_;
  }
  static SurfaceImages Surfaces(const geo::Rigid3d& pose, base::ThreadPool& threads) {
    return PhotoRenderer(*world_, place_->camera, 1, false).Surfaces(pose, world_->MovingAt(0.0), threads);
  }
  static Vector3d Normal(const image::ImageF& normals, int x, int y) { return Eigen::Map<const Eigen::Vector3f>(normals.At(x, y)).cast<double>(); }

  static inline base::ThreadPool* threads_ = nullptr;
  static inline PlaceSpec* place_ = nullptr;
  static inline World* world_ = nullptr;
  static inline std::vector<PhotoPlan>* photos_ = nullptr;
};

// What the normals of the depth image say, away from edges, is what the true normals say; towns have more plane surfaces than edges.
TEST_F(SurfaceTruth, NormalsAgreeWithDepth) {
  std::map<SurfaceClass, std::array<int, 2>> agree;  // of all, those within 2 degrees
  for (size_t i = 0; i < photos_->size(); i += photos_->size() / 6) {
    const geo::Rigid3d& pose = (*photos_)[i].cam_from_enu;
    const SurfaceImages seen = Surfaces(pose, *threads_);
    const image::ImageF of_depth = scene::NormalsOfDepth(place_->camera, pose, seen.z_depth, {}, *threads_);
    for (int y = 0; y < seen.classes.height; ++y) {
      for (int x = 0; x < seen.classes.width; ++x) {
        const auto seen_class = static_cast<SurfaceClass>(*seen.classes.At(x, y));
        const Vector3d normal = Normal(seen.normals, x, y);
        ASSERT_EQ(seen_class == SurfaceClass::kNone, std::isnan(*seen.z_depth.At(x, y)));
        ASSERT_EQ(seen_class == SurfaceClass::kNone, std::isnan(normal.x()));
        if (seen_class == SurfaceClass::kNone) continue;
        ASSERT_NEAR(normal.norm(), 1.0, 1e-5);
        const Vector3d direction = pose.rotation.conjugate() * place_->camera.RayFromImg({x + 0.5, y + 0.5});
        ASSERT_LE(normal.dot(direction), 1e-6) << "turned away from the camera";
        std::array<int, 2>& count = agree[seen_class];
        ++count[0];
        if (Normal(of_depth, x, y).dot(normal) > std::cos(2.0 * M_PI / 180.0)) ++count[1];
      }
    }
  }
  EXPECT_GT(agree[SurfaceClass::kRoad][1], agree[SurfaceClass::kRoad][0] * 9 / 10);
  EXPECT_GT(agree[SurfaceClass::kGround][1], agree[SurfaceClass::kGround][0] * 8 / 10);
  EXPECT_GT(agree[SurfaceClass::kRoof][1], agree[SurfaceClass::kRoof][0] * 7 / 10);
  for (const SurfaceClass rare : {SurfaceClass::kWall, SurfaceClass::kTree, SurfaceClass::kParkedCar}) EXPECT_GT(agree[rare][0], 500);
}

// Every class is where it belongs: roofs in their building's height range, walls upright, roads low and level.
TEST_F(SurfaceTruth, ClassesAreWhereTheyBelong) {
  const geo::Rigid3d& pose = photos_->back().cam_from_enu;  // oblique
  const geo::Rigid3d enu_from_cam = pose.Inverse();
  const SurfaceImages seen = Surfaces(pose, *threads_);
  int n_roof = 0, n_wall = 0;
  for (int y = 0; y < seen.classes.height; ++y) {
    for (int x = 0; x < seen.classes.width; ++x) {
      const auto seen_class = static_cast<SurfaceClass>(*seen.classes.At(x, y));
      if (seen_class == SurfaceClass::kNone) continue;
      const Vector3d ray = place_->camera.RayFromImg({x + 0.5, y + 0.5});
      const Vector3d at = enu_from_cam * Vector3d(ray * (static_cast<double>(*seen.z_depth.At(x, y)) / ray.z()));
      const double above = at.z() - static_cast<double>(world_->terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
      const double up = Normal(seen.normals, x, y).z();
      // The terrain's triangles and its bilinear heights differ by centimetres.
      if (seen_class == SurfaceClass::kGround || seen_class == SurfaceClass::kRoad) {
        EXPECT_NEAR(above, 0.0, 0.15);
        EXPECT_GT(up, 0.9);
      }
      if (seen_class == SurfaceClass::kRoad) {
        const GroundSample ground = world_->city()->Sample(static_cast<float>(at.x()), static_cast<float>(at.y()));
        EXPECT_TRUE(ground.kind == GroundKind::kRoad || (ground.kind == GroundKind::kPad && ground.pad->kind == PadKind::kParking));
      }
      if (seen_class == SurfaceClass::kRoof) {
        ++n_roof;
        EXPECT_GT(above, 1.0);
      }
      if (seen_class == SurfaceClass::kWall) {
        ++n_wall;
        EXPECT_NEAR(up, 0.0, 1e-3);
      }
    }
  }
  EXPECT_GT(n_roof, 2000);
  EXPECT_GT(n_wall, 500);
}

TEST_F(SurfaceTruth, DecksAreExactlyAsHighAsTheBuildingsSay) {
  camera::Camera camera{camera::CameraModel::kSimplePinhole, 33, 33, {60.0, 16.5, 16.5}};
  const PhotoRenderer renderer(*world_, camera, 1, false);
  int n_decks = 0;
  for (const Building& b : world_->buildings()) {
    if (b.roof != RoofKind::kFlat) continue;
    const Vector3d above(b.centre.x(), b.centre.y(), b.ground_z_m + b.eave_height_m + 60.0);
    const geo::Rigid3d pose = PoseFromGimbal(above, 0.0, -90.0, 0.0);
    const SurfaceImages seen = renderer.Surfaces(pose, world_->MovingAt(0.0), *threads_);
    if (*seen.classes.At(16, 16) != static_cast<uint8_t>(SurfaceClass::kRoof) || *seen.z_depth.At(16, 16) < 59.9F) continue;  // trees, machines
    ++n_decks;
    EXPECT_NEAR(*seen.z_depth.At(16, 16), 60.0F, 1e-3F);
    EXPECT_GT(seen.normals.At(16, 16)[2], 0.9999F);
  }
  EXPECT_GT(n_decks, 5);
}

TEST_F(SurfaceTruth, CarsThatMoveHaveTheirOwnClass) {
  const MovingScene moving = world_->MovingAt(0.0);
  const camera::Camera camera{camera::CameraModel::kSimplePinhole, 33, 31, {60.0, 16.5, 15.5}};
  const PhotoRenderer renderer(*world_, camera, 1, false);
  const Car& car = moving.cars.at(0);
  const geo::Rigid3d pose = PoseFromGimbal({car.position.x(), car.position.y(), car.ground_z_m + 12.0}, 0.0, -90.0, 0.0);
  EXPECT_EQ(*renderer.Surfaces(pose, moving, *threads_).classes.At(16, 15), static_cast<uint8_t>(SurfaceClass::kMovingCar));
  EXPECT_EQ(*renderer.Surfaces(pose, world_->MovingAt(2.0), *threads_).classes.At(16, 15), static_cast<uint8_t>(SurfaceClass::kRoad));
}

TEST_F(SurfaceTruth, SameImagesForAnyNumberOfThreads) {
  base::ThreadPool three(3);
  const SurfaceImages a = Surfaces(photos_->front().cam_from_enu, *threads_), b = Surfaces(photos_->front().cam_from_enu, three);
  EXPECT_EQ(a.classes.data, b.classes.data);
  EXPECT_EQ(std::memcmp(a.normals.data.data(), b.normals.data.data(), a.normals.data.size() * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(a.z_depth.data.data(), b.z_depth.data.data(), a.z_depth.data.size() * sizeof(float)), 0);
}

// Reads the mesh as a viewer would: by its header.
TEST_F(SurfaceTruth, TheMeshIsTheStaticSceneWithClasses) {
  const TemporaryFolder folder;
  WriteSurfaceMesh(*world_, folder.path() / "surface.ply");
  const std::string file = base::ReadFile(folder.path() / "surface.ply");
  const Mesh& mesh = world_->mesh();
  const std::string end = "end_header\n";
  const size_t body = file.find(end) + end.size();
  const std::string header = file.substr(0, body);
  EXPECT_TRUE(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_NE(header.find("element vertex " + std::to_string(mesh.position.size()) + "\nproperty float x\n"), std::string::npos);
  EXPECT_NE(header.find("element face " + std::to_string(mesh.triangle.size()) + "\nproperty list uchar int vertex_indices\nproperty uchar class\n"),
            std::string::npos);
  ASSERT_EQ(file.size(), body + 12 * mesh.position.size() + 14 * mesh.triangle.size());
  const char* face = file.data() + body + 12 * mesh.position.size();
  std::array<int, survey::kSurfaceClasses> count{};
  for (size_t i = 0; i < mesh.triangle.size(); ++i, face += 14) {
    ASSERT_EQ(face[0], 3);
    std::array<int32_t, 3> corner{};
    std::memcpy(corner.data(), face + 1, 12);
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const int32_t c : corner) {
      ASSERT_LT(static_cast<size_t>(c), mesh.position.size());
      Eigen::Vector3f vertex;
      std::memcpy(vertex.data(), file.data() + body + 12 * static_cast<size_t>(c), 12);
      middle += vertex / 3.0F;
    }
    const auto id = static_cast<uint8_t>(face[13]);
    ASSERT_LT(id, survey::kSurfaceClasses);
    ++count[id];
    if (mesh.tag[i].part == Part::kFlatRoof) {
      const Building& b = world_->buildings()[mesh.tag[i].object];
      ASSERT_EQ(id, static_cast<uint8_t>(SurfaceClass::kRoof));
      ASSERT_NEAR(static_cast<double>(middle.z()), b.ground_z_m + b.eave_height_m, 1e-3);
    }
  }
  for (const SurfaceClass present : {SurfaceClass::kRoof, SurfaceClass::kWall, SurfaceClass::kGround, SurfaceClass::kRoad, SurfaceClass::kTree,
                                     SurfaceClass::kParkedCar, SurfaceClass::kWater}) {
    EXPECT_GT(count[static_cast<size_t>(present)], 0) << survey::kSurfaceClassNames[static_cast<size_t>(present)];
  }
  EXPECT_EQ(count[static_cast<size_t>(SurfaceClass::kNone)], 0);
  EXPECT_EQ(count[static_cast<size_t>(SurfaceClass::kMovingCar)], 0);
}

}  // namespace
}  // namespace skyquilt::simulate
