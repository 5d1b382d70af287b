#include "simulate/point_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/base/random.h"
#include "simulate/flights/level_flight.h"

namespace skyquilt::simulate {
namespace {

// Whatever the flight: photos that are not near do not show the place.
class PointViewsTest : public testing::Test {
 protected:
  void ExpectNearIsEnough(const std::string& flight, bool some_are_far) {
    base::ThreadPool threads(2);
    SimulateOptions options;
    options.place = "town";
    options.flight = flight;
    PlaceSpec place = ResolvePlace(options);
    place.city.tree_detail = 0;
    place.city.building_share = 0.0;
    place.ambient_voxel_m = 24.0;
    const World world(place, 1.0, threads);
    const std::vector<PhotoPlan> photos = flight == "survey" ? PlanFlight(place, world.TakeoffHeight(place)) : PlanLevelFlight(place, world);
    const PointViews views(world, place.camera, photos);
    base::Random random(3);
    size_t found_in_all = 0, shown = 0;
    std::vector<uint32_t> found;
    for (int i = 0; i < 200; ++i) {
      const double x = random.Uniform(-150.0, 150.0), y = random.Uniform(-150.0, 150.0), z = random.Uniform(-3.0, 120.0);
      const Eigen::Vector3d point(x, y, z);
      views.FindNear(point, &found);
      found_in_all += found.size();
      EXPECT_TRUE(std::adjacent_find(found.begin(), found.end(), std::greater_equal<>()) == found.end()) << "ascending, each once";
      for (size_t photo = 0; photo < photos.size(); ++photo) {
        const std::optional<Eigen::Vector2d> pixel = place.camera.ImgFromCam(photos[photo].cam_from_enu * point);
        if (!pixel || pixel->minCoeff() < 0.0 || pixel->x() > place.camera.width || pixel->y() > place.camera.height) continue;
        ++shown;
        EXPECT_TRUE(std::ranges::binary_search(found, static_cast<uint32_t>(photo))) << photo << " shows " << point.transpose();
      }
    }
    EXPECT_GT(shown, 100U);
    if (some_are_far) EXPECT_LT(found_in_all, 200 * photos.size() * 3 / 4);
  }
};

TEST_F(PointViewsTest, PhotosThatLookDownShowWhatIsNearThem) {
  ExpectNearIsEnough("survey", true);
}

TEST_F(PointViewsTest, PhotosThatLookLevelMayShowAnything) {
  ExpectNearIsEnough("street", false);
}

}  // namespace
}  // namespace skyquilt::simulate
