// People who walk in the streets, and lamps that stand there.
#include <gtest/gtest.h>

#include <cmath>

#include "core/survey/surface_class.h"
#include "simulate/flight.h"
#include "simulate/photo_renderer.h"
#include "simulate/simulate.h"
#include "simulate/world.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using survey::SurfaceClass;

class LivelyStreets : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    threads_ = new base::ThreadPool(2);
    SimulateOptions options;
    options.place = "hamlet";
    PlaceSpec place = Plain(options);
    quiet_ = new World(place, 1.0, *threads_);
    options.people = 40;
    options.lamps = 15;
    place = Plain(options);
    world_ = new World(place, 1.0, *threads_);
  }
  static void TearDownTestSuite() {
    delete world_;
    delete quiet_;
    delete threads_;
  }
  static PlaceSpec Plain(const SimulateOptions& options) {
    PlaceSpec place = ResolvePlace(options);
    place.city.tree_detail = 0;
    place.ambient_voxel_m = 24.0;
    return place;
  }
  static GroundKind GroundAt(const Vector2d& at) { return world_->city()->Sample(static_cast<float>(at.x()), static_cast<float>(at.y())).kind; }
  static double HeightAt(const Vector2d& at) {
    return static_cast<double>(world_->terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
  }
  // A small photo from straight above, with what moves at that time.
  static SurfaceImages From(const Vector3d& eye, const MovingScene& moving) {
    return PhotoRenderer(*world_, Camera(), 1, true).Surfaces(PoseFromGimbal(eye, 0.0, -90.0, 0.0), moving, *threads_);
  }
  static camera::Camera& Camera() {
    static camera::Camera camera{camera::CameraModel::kSimplePinhole, 33, 31, {120.0, 16.5, 15.5}};
    return camera;
  }

  static inline base::ThreadPool* threads_ = nullptr;
  static inline World* quiet_ = nullptr;
  static inline World* world_ = nullptr;
};

TEST_F(LivelyStreets, PeopleWalkOnPavementsAndCrossings) {
  const MovingScene before = world_->MovingAt(0.0), after = world_->MovingAt(10.0);
  ASSERT_EQ(before.people.size(), 40U);
  int on_pavement = 0;
  for (size_t i = 0; i < before.people.size(); ++i) {
    const Person& person = before.people[i];
    EXPECT_NEAR(person.ground_z_m, HeightAt(person.position), 1e-6);
    const GroundKind kind = GroundAt(person.position);
    EXPECT_TRUE(kind == GroundKind::kPavement || kind == GroundKind::kRoad || kind == GroundKind::kField) << i;
    on_pavement += kind == GroundKind::kPavement ? 1 : 0;
    const double walked_m = (after.people[i].position - person.position).norm();
    EXPECT_GT(walked_m, 9.9) << i;  // more where someone began again at the other end
  }
  EXPECT_GT(on_pavement, 15);
}

TEST_F(LivelyStreets, PeopleAreSeenAndMasked) {
  const MovingScene moving = world_->MovingAt(0.0), later = world_->MovingAt(10.0);
  int seen = 0;
  for (const Person& person : moving.people) {
    const Vector3d above(person.position.x(), person.position.y(), person.ground_z_m + 4.0);
    const SurfaceImages images = From(above, moving);
    if (*images.classes.At(16, 15) != static_cast<uint8_t>(SurfaceClass::kPerson)) continue;  // under a tree
    ++seen;
    EXPECT_NEAR(*images.z_depth.At(16, 15), 4.0 - 1.7, 0.1);
    const geo::Rigid3d pose = PoseFromGimbal(above, 0.0, -90.0, 0.0);
    const Rendering rendering = PhotoRenderer(*world_, Camera(), 1, true).Render(pose, moving, *threads_);
    ASSERT_FALSE(rendering.usable.Empty());
    EXPECT_EQ(*rendering.usable.At(16, 15), 0);
    EXPECT_NE(*From(above, later).classes.At(16, 15), static_cast<uint8_t>(SurfaceClass::kPerson));
  }
  EXPECT_GT(seen, 25);
}

TEST_F(LivelyStreets, LampsStandAtKerbsWithTheirHeadsOverTheRoad) {
  const std::vector<Lamp>& lamps = world_->city()->contents().lamps;
  ASSERT_EQ(lamps.size(), 15U);
  const MovingScene nobody = quiet_->MovingAt(0.0);
  for (const Lamp& lamp : lamps) {
    EXPECT_EQ(GroundAt(lamp.position), GroundKind::kPavement);
    const double yaw = lamp.yaw_deg * 3.14159265358979 / 180.0;
    const Vector2d head = lamp.position + 1.3 * Vector2d(std::cos(yaw), std::sin(yaw));
    EXPECT_EQ(GroundAt(head), GroundKind::kRoad);
    const SurfaceImages images = From({head.x(), head.y(), lamp.ground_z_m + lamp.height_m + 3.0}, nobody);
    EXPECT_EQ(*images.classes.At(16, 15), static_cast<uint8_t>(SurfaceClass::kLamp));
    EXPECT_NEAR(*images.z_depth.At(16, 15), 2.9, 0.05);
  }
}

TEST_F(LivelyStreets, TheRestOfThePlaceIsAsWithoutThem) {
  const CityContents &a = world_->city()->contents(), &b = quiet_->city()->contents();
  ASSERT_EQ(a.buildings.size(), b.buildings.size());
  ASSERT_EQ(a.trees.size(), b.trees.size());
  ASSERT_EQ(a.parked.size(), b.parked.size());
  for (size_t i = 0; i < a.trees.size(); ++i) EXPECT_EQ(a.trees[i].position, b.trees[i].position);
  for (size_t i = 0; i < a.parked.size(); ++i) EXPECT_EQ(a.parked[i].position, b.parked[i].position);
  const std::vector<Car> cars = world_->MovingAt(3.0).cars, before = quiet_->MovingAt(3.0).cars;
  ASSERT_EQ(cars.size(), before.size());
  for (size_t i = 0; i < cars.size(); ++i) EXPECT_EQ(cars[i].position, before[i].position);
  EXPECT_TRUE(b.lamps.empty());
  EXPECT_TRUE(quiet_->MovingAt(0.0).people.empty());
}

TEST(ClassImages, AreThereForAllPhotosWhenAskedFor) {
  const TemporaryFolder folder;
  base::ThreadPool threads(2);
  SimulateOptions options;
  options.place = "hamlet";
  options.image_width = 64;
  options.single_line = true;
  options.samples_per_pixel = 1;
  options.people = 30;
  options.class_images = "all";
  const SimulateSummary summary = Simulate(options, folder.path(), threads);
  int people = 0;
  const auto count = [](const std::filesystem::path& files) {
    return std::distance(std::filesystem::directory_iterator(files), std::filesystem::directory_iterator());
  };
  EXPECT_EQ(count(folder / "truth/classes"), summary.n_photos);
  EXPECT_EQ(count(folder / "truth/depth"), summary.n_test);
  EXPECT_LT(summary.n_test, summary.n_photos);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "truth/classes")) {
    const image::Image8 classes = image::LoadLabels(entry.path());
    EXPECT_EQ(classes.width, 64);
    people += static_cast<int>(std::count(classes.data.begin(), classes.data.end(), static_cast<uint8_t>(SurfaceClass::kPerson)));
  }
  EXPECT_GT(people, 0);
}

}  // namespace
}  // namespace skyquilt::simulate
