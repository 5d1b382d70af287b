#include "prepare/input/shots.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"

namespace skyquilt::prepare::input {
namespace {

const geo::EnuFrame kFrame({47.0, 8.0, 400.0});

PhotoFile ShotPhoto(size_t number, const Eigen::Vector3d& x, double time_s, double exposure_s) {
  PhotoFile photo;
  photo.name = "flight/DJI_" + std::to_string(1000 + number) + ".JPG";
  photo.width = 4000;
  photo.height = 3000;
  photo.tags.gps = kFrame.GeodeticFromEnu(x);
  photo.tags.capture_time_s = time_s;
  photo.tags.exposure.time_s = exposure_s;
  return photo;
}

// `n` shots of `per_shot` exposures, a stop apart, 10 m and 3 s from each other.
std::vector<PhotoFile> Brackets(size_t n, size_t per_shot) {
  std::vector<PhotoFile> photos;
  for (size_t shot = 0; shot < n; ++shot) {
    for (size_t i = 0; i < per_shot; ++i) {
      const auto s = static_cast<double>(shot), k = static_cast<double>(i);
      photos.push_back(ShotPhoto(photos.size(), {10.0 * s, 0.0, 100.0}, 3.0 * s + 0.4 * k, 0.001 * std::exp2(k)));
    }
  }
  return photos;
}

TEST(FindShots, BracketsAreOneShot) {
  for (const size_t per_shot : {3U, 5U, 7U}) {
    const std::vector<size_t> shots = FindShots(Brackets(10, per_shot));
    EXPECT_EQ(CountShots(shots), 10U);
    for (size_t i = 0; i < shots.size(); ++i) EXPECT_EQ(shots[i], i / per_shot * per_shot);
  }
}

TEST(FindShots, PhotosOfAFlightAreShotsOfTheirOwn) {
  EXPECT_EQ(CountShots(FindShots(Brackets(12, 1))), 12U);
  // One place and time, but other heights (a facade), directions, folders or the same exposure.
  std::vector<PhotoFile> photos = Brackets(1, 5);
  photos[1].tags.gps->height_m += 3.0;
  photos[2].tags.exposure = photos[0].tags.exposure;
  photos[3].name = "other/x.JPG";
  EXPECT_EQ(CountShots(FindShots(photos)), 5U);
  photos = Brackets(1, 2);
  photos[0].tags.gimbal_yaw_deg = 10.0;
  photos[1].tags.gimbal_yaw_deg = 40.0;
  EXPECT_EQ(CountShots(FindShots(photos)), 2U);
}

TEST(FindShots, PhotosWithoutTagsAreShotsOfTheirOwn) {
  std::vector<PhotoFile> photos = Brackets(2, 3);
  photos[1].tags.gps.reset();
  photos[4].tags.capture_time_s.reset();
  EXPECT_EQ(CountShots(FindShots(photos)), 6U);
  EXPECT_TRUE(FindShots({}).empty());
  EXPECT_EQ(CountShots({}), 0U);
}

TEST(FindShots, AReceiverThatRepeatsItsPositionMakesNoShotOfAFlight) {
  std::vector<PhotoFile> photos;
  for (size_t i = 0; i < 100; ++i)
    photos.push_back(ShotPhoto(i, {0.0, 0.0, 100.0}, static_cast<double>(i), 0.001 + 0.00001 * static_cast<double>(i % 7)));
  EXPECT_EQ(CountShots(FindShots(photos)), 100U);
  for (PhotoFile& photo : photos) photo.tags.exposure = {};
  EXPECT_GE(CountShots(FindShots(photos)), 10U);
}

RC_GTEST_PROP(FindShots, AreRunsOfNeighbours, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  std::vector<PhotoFile> photos;
  const uint32_t n = random.Below(30);
  double time_s = 0.0;
  for (uint32_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(random.Below(2)), exposure_s = 0.001 * (1.0 + static_cast<double>(random.Below(3)));
    time_s += 0.5 * static_cast<double>(random.Below(5));
    photos.push_back(ShotPhoto(i, {x, 0.0, 100.0}, time_s, exposure_s));
  }
  const std::vector<size_t> shots = FindShots(photos);
  RC_ASSERT(shots.size() == photos.size());
  for (size_t i = 0; i < shots.size(); ++i) {
    RC_ASSERT(shots[i] <= i);
    RC_ASSERT(shots[shots[i]] == shots[i]);
    const bool goes_on = shots[i] == i || shots[i - 1] == shots[i];
    RC_ASSERT(goes_on);
  }
}

}  // namespace
}  // namespace skyquilt::prepare::input
