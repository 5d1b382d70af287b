#include "prepare/poses/photo_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/prepare/poses/made_photos.h"

namespace skyquilt::prepare::poses {
namespace {

const geo::Geodetic kOrigin{47.0, 8.0, 400.0};

void Look(input::PhotoFile& photo, double pitch_deg, double yaw_deg) {
  photo.tags.gimbal_pitch_deg = pitch_deg;
  photo.tags.gimbal_yaw_deg = yaw_deg;
}

TEST(FindPlaces, GimbalAnglesMoveTheTarget) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(2, 3, 20.0, 30.0, kOrigin);
  Look(photos[0], -45.0, 90.0);    // 100 m to the east
  Look(photos[1], -45.0, -180.0);  // to the south
  Look(photos[2], 0.0, 0.0);       // to the horizon: limited
  const auto places = FindPlaces(photos);
  const auto moved = [&](size_t i) -> Eigen::Vector2d { return places[i]->target - places[i]->camera; };
  EXPECT_NEAR((moved(0) - Eigen::Vector2d(100.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((moved(1) - Eigen::Vector2d(0.0, -100.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((moved(2) - Eigen::Vector2d(0.0, 100.0 * std::sqrt(3.0))).norm(), 0.0, 1e-6);
  EXPECT_NEAR(moved(3).norm(), 0.0, 1e-6);
  EXPECT_NEAR((places[0]->view - Eigen::Vector3d(100.0, 0.0, -100.0) / std::sqrt(2.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((places[4]->camera - places[0]->camera - Eigen::Vector2d(20.0, 30.0)).norm(), 0.0, 0.01);
  EXPECT_TRUE(HasObliquePhotos(places));
}

TEST(FindPlaces, AYawThatIsAlwaysTheSameIsNotBelieved) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(2, 3, 20.0, 30.0, kOrigin);
  EXPECT_FALSE(HasObliquePhotos(FindPlaces(photos)));
  for (input::PhotoFile& photo : photos) Look(photo, -45.0, 0.0);
  EXPECT_FALSE(HasObliquePhotos(FindPlaces(photos)));
  Look(photos[0], -45.0, 1.0);
  EXPECT_TRUE(HasObliquePhotos(FindPlaces(photos)));
}

TEST(FindPlaces, ImpossibleAnglesAndHeightsAreNotUsed) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(2, 3, 20.0, 30.0, kOrigin);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Look(photos[0], 80.0, 10.0);
  Look(photos[1], nan, 20.0);
  Look(photos[2], -45.0, nan);
  for (const size_t i : {3U, 4U, 5U}) Look(photos[i], -45.0, 5.0 * static_cast<double>(i));
  photos[3].tags.relative_altitude_m = -5.0;
  photos[4].tags.relative_altitude_m = nan;
  photos[5].tags.relative_altitude_m.reset();
  const auto places = FindPlaces(photos);
  EXPECT_FALSE(HasObliquePhotos(places));
  for (const auto& place : places) EXPECT_TRUE(place && place->target.allFinite() && place->view.allFinite());
}

TEST(FindPlaces, PhotosWithoutAPositionHaveNone) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(2, 3, 20.0, 30.0, kOrigin);
  photos[1].tags.gps.reset();
  photos[2].tags.gps->latitude_deg = std::numeric_limits<double>::quiet_NaN();
  photos[3].tags.gps->height_m = std::numeric_limits<double>::quiet_NaN();
  const auto places = FindPlaces(photos);
  EXPECT_TRUE(places[0] && !places[1] && !places[2] && places[3]);
  for (input::PhotoFile& photo : photos) photo.tags.gps.reset();
  for (const auto& place : FindPlaces(photos)) EXPECT_FALSE(place);
  EXPECT_TRUE(FindPlaces({}).empty());
}

// Columns of a facade: one position on the map, other heights.
TEST(FindPlaces, HeightsTellPhotosApart) {
  const std::vector<input::PhotoFile> feet = test::GridPhotos(1, 2, 20.0, 30.0, kOrigin);
  std::vector<input::PhotoFile> photos = test::GridPhotos(1, 12, 20.0, 30.0, kOrigin);
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].tags.gps = feet[i / 6].tags.gps;
    photos[i].tags.gps->height_m += 3.0 * static_cast<double>(i % 6);
  }
  for (const auto& place : FindPlaces(photos)) EXPECT_TRUE(place);
  // Above take-off, where the position has no height.
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].tags.gps->height_m = std::numeric_limits<double>::quiet_NaN();
    photos[i].tags.relative_altitude_m = 10.0 + 3.0 * static_cast<double>(i % 6);
  }
  for (const auto& place : FindPlaces(photos)) EXPECT_TRUE(place);
}

TEST(FindPlaces, ExposuresOfOneShotNeedNotDiffer) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(3, 12, 20.0, 30.0, kOrigin);
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].tags.gps = photos[i / 3 * 3].tags.gps;
    photos[i].tags.capture_time_s = 5.0 * static_cast<double>(i / 3) + 0.5 * static_cast<double>(i % 3);
    photos[i].tags.exposure.time_s = 0.001 * static_cast<double>(1U << i % 3);
  }
  for (const auto& place : FindPlaces(photos)) EXPECT_TRUE(place);
  // Far apart in time they are photos of their own.
  for (size_t i = 0; i < photos.size(); ++i) photos[i].tags.capture_time_s = 5.0 * static_cast<double>(i);
  for (const auto& place : FindPlaces(photos)) EXPECT_FALSE(place);
}

TEST(FindPlaces, EqualPositionsTellNothing) {
  std::vector<input::PhotoFile> photos = test::GridPhotos(3, 4, 20.0, 30.0, kOrigin);
  for (size_t i = 0; i < 12; i += 2) photos[i].tags.gps = photos[i + 1].tags.gps;  // every spot twice
  for (const auto& place : FindPlaces(photos)) EXPECT_TRUE(place);
  for (input::PhotoFile& photo : photos) photo.tags.gps = photos[0].tags.gps;
  for (const auto& place : FindPlaces(photos)) EXPECT_FALSE(place);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
