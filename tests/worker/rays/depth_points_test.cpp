// Three nadir photos in a row, 50 m above flat ground, cached at half size.
#include "worker/rays/depth_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <thread>

#include "core/image/image.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

constexpr int kPhotoWidth = 96, kPhotoHeight = 72;
constexpr double kFocal_px = 48.0;  // at full size: shows 100 x 75 m of ground
constexpr double kHeight_m = 50.0;

class DepthPointsTest : public ::testing::Test {
 protected:
  // Cameras at x = 0, 20 and 40 m.
  DepthPointsTest() {
    survey_.cameras = {{camera::CameraModel::kPinhole, kPhotoWidth, kPhotoHeight, {kFocal_px, kFocal_px, kPhotoWidth / 2.0, kPhotoHeight / 2.0}}};
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < 3; ++i) {
      const survey::Photo photo = NadirPhoto({20.0 * i, 0.0, kHeight_m}, "p" + std::to_string(i) + ".png");
      image::SavePng(image::Image8(kPhotoWidth, kPhotoHeight, 3, 100), folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(photo);
    }
    base::ThreadPool threads(1);
    pixels_ = image::PixelCache::Open(folder_ / "pixels.bin", sources, kPhotoWidth / 2, threads);
    source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
  }
  void Add(const Vector3d& x_in_enu, float error_px, std::vector<int32_t> photos) {
    survey_.points.push_back({x_in_enu, {}, error_px, static_cast<int>(photos.size())});
    survey_.tracks.Add(std::move(photos));
  }
  DepthPoints Make(size_t most = DepthPoints::kMost) const { return DepthPoints(survey_, *source_, box_, most); }

  TemporaryFolder folder_;
  survey::Survey survey_;
  image::PixelCache pixels_;
  brightness::Response response_ = brightness::Response::Neutral(3, 1);
  std::unique_ptr<RaySource> source_;
  geo::BlockBox box_ = {{-30.0, -30.0, -5.0}, {30.0, 30.0, 20.0}, 10.0};
};

TEST_F(DepthPointsTest, TheirRaysEndAtThePoints) {
  Add({10.0, -5.0, 3.0}, 0.7F, {0, 1, 2});
  Add({-3.0, 8.0, 1.0}, 0.7F, {0, 1});
  const DepthPoints depth = Make();
  ASSERT_EQ(depth.points().size(), 5U);
  for (size_t i = 0; i < 5; ++i) {
    const DepthPoint& d = depth.points()[i];
    Vector3d origin, direction;
    source_->RayThrough(d.photo, {static_cast<double>(d.pixel_x), static_cast<double>(d.pixel_y)}, &origin, &direction);
    const Vector3d end = origin + static_cast<double>(d.distance_m) * direction;
    EXPECT_LT((end - survey_.points[i < 3 ? 0 : 1].x_in_enu).norm(), 1e-4) << i;
    EXPECT_LT(d.pixel_x, static_cast<float>(kPhotoWidth) / 2.0F);
  }
}

// Cameras 40 m apart above a point straight below the middle: the rays meet at 2 atan(20 / 50). One pixel at full size is 1 / 48 of the distance.
TEST_F(DepthPointsTest, TheirAccuracyIsThatOfTheTriangulation) {
  Add({20.0, 0.0, 0.0}, 0.8F, {0, 1, 2});
  Add({20.0, 0.0, 0.0}, 0.1F, {0, 2});
  const std::vector<DepthPoint> points = Make().points();
  ASSERT_EQ(points.size(), 5U);
  const double angle = 2.0 * std::atan(20.0 / kHeight_m);
  EXPECT_NEAR(static_cast<double>(points[1].sigma_m), 0.8 * kHeight_m / kFocal_px / std::tan(angle), 1e-3);
  EXPECT_NEAR(static_cast<double>(points[3].sigma_m / points[0].sigma_m), 0.5 / 0.8, 1e-3) << "an error of 0.1 pixels counts as 0.5";
}

TEST_F(DepthPointsTest, AcrossWideAnglesAPointIsKnownAsWellAsAcrossTheRay) {
  survey_.photos[0].cam_from_enu = NadirPhoto({-40.0, 0.0, kHeight_m}, "").cam_from_enu;
  survey_.photos[2].cam_from_enu = NadirPhoto({40.0, 0.0, kHeight_m}, "").cam_from_enu;
  survey_.photos[1].cam_from_enu = NadirPhoto({0.0, 0.0, kHeight_m}, "").cam_from_enu;
  source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
  Add({0.0, 0.0, 0.0}, 1.0F, {0, 1, 2});  // the outer rays meet at 77 degrees
  const std::vector<DepthPoint> points = Make().points();
  ASSERT_EQ(points.size(), 3U);
  EXPECT_NEAR(static_cast<double>(points[1].sigma_m), kHeight_m / kFocal_px, 1e-3);
}

TEST_F(DepthPointsTest, PoorPointsAndOnesElsewhereAreLeftOut) {
  Add({10.0, 0.0, 0.0}, 2.1F, {0, 1, 2});                                     // large error
  Add({10.0, 0.0, 0.0}, std::numeric_limits<float>::quiet_NaN(), {0, 1, 2});  // unknown error
  Add({10.0, 0.0, 0.0}, 0.5F, {1});                                           // one ray
  Add({10.0, 0.0, -600.0}, 0.5F, {0, 1});                                     // 1.8 degrees
  Add({41.0, 0.0, 0.0}, 0.5F, {0, 1, 2});                                     // outside the box and its margin
  EXPECT_TRUE(Make().Empty());
  Add({10.0, 0.0, -500.0}, 0.5F, {0, 1});  // 2.1 degrees, below the box
  EXPECT_EQ(Make().points().size(), 2U);
  Add({39.0, 39.0, 0.0}, 0.5F, {0, 2});  // in the margin, but to the north of the photos' frames
  EXPECT_EQ(Make().points().size(), 2U);
}

TEST_F(DepthPointsTest, HeldOutPhotosAndKeptPointsAreNeverAmongThem) {
  survey_.photos[1].is_test = true;
  Add({10.0, 0.0, 0.0}, 0.5F, {0, 1, 2});
  survey_.kept_points = {{{5.0, 5.0, 0.0}, {}, 0.5F, 3}};
  survey_.kept_tracks.Add({0, 1, 2});
  const std::vector<DepthPoint> points = Make().points();
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].photo, 0);
  EXPECT_EQ(points[1].photo, 2);
  survey_.tracks = {};
  EXPECT_TRUE(Make().Empty()) << "of a survey of an older program";
}

// As in surveys of older programs, whose tracks have held-out photos.
TEST_F(DepthPointsTest, AnglesAreThoseOfTrainingPhotos) {
  Add({10.0, 0.0, -300.0}, 0.5F, {0, 1});  // 3.3 degrees
  const std::vector<DepthPoint> alone = Make().points();
  ASSERT_EQ(alone.size(), 2U);
  survey_.points.clear();
  survey_.tracks = {};
  survey_.photos[2].is_test = true;
  survey_.photos[2].cam_from_enu = NadirPhoto({200.0, 0.0, kHeight_m}, "").cam_from_enu;
  source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
  Add({10.0, 0.0, -300.0}, 0.5F, {0, 1, 2});
  const std::vector<DepthPoint> with_held_out = Make().points();
  ASSERT_EQ(with_held_out.size(), 2U);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(with_held_out[i].photo, alone[i].photo);
    EXPECT_EQ(with_held_out[i].sigma_m, alone[i].sigma_m);
  }
  Add({10.0, 0.0, -600.0}, 0.5F, {0, 1, 2});  // 1.8 degrees between the training photos
  Add({10.0, 0.0, 0.0}, 0.5F, {1, 2});        // one training photo
  EXPECT_EQ(Make().points().size(), 2U);
}

TEST_F(DepthPointsTest, HeldOutPhotosDoNotCountTowardsTheLimit) {
  survey_.photos[2].is_test = true;
  for (int i = 0; i < 100; ++i) Add({10.0, 0.05 * i, 0.0}, 0.5F, {0, 1, 2});
  EXPECT_EQ(Make(200).points().size(), 200U);
}

TEST_F(DepthPointsTest, AllAreEquallyLikelyAndTheSameNumbersGiveTheSameOnes) {
  for (int i = 0; i < 10; ++i) Add({10.0, i - 5.0, 0.0}, 0.5F, {0, 1});
  const DepthPoints depth = Make();
  ASSERT_EQ(depth.points().size(), 20U);
  const auto count = [&] {
    base::Random random(7);
    std::vector<int> times(20, 0);
    for (int i = 0; i < 20'000; ++i) ++times[static_cast<size_t>(&depth.Draw(random) - depth.points().data())];
    return times;
  };
  const std::vector<int> alone = count();
  for (const int times : alone) EXPECT_NEAR(times, 1000, 150);
  std::vector<int> beside;
  std::thread other([&] { beside = count(); });
  EXPECT_EQ(count(), alone);
  other.join();
  EXPECT_EQ(beside, alone);
}

TEST_F(DepthPointsTest, AboveTheLimitAPartOfThePointsIsUsed) {
  for (int i = 0; i < 2000; ++i) Add({10.0, 0.005 * i, 0.0}, 0.5F, {0, 1});
  const std::vector<DepthPoint> all = Make().points(), some = Make(1000).points();
  EXPECT_EQ(all.size(), 4000U);
  EXPECT_NEAR(static_cast<double>(some.size()), 1000.0, 150.0);
  EXPECT_EQ(some.size() % 2, 0U) << "whole points";
  double mean = 0.0;
  for (const DepthPoint& d : some) mean += static_cast<double>(d.distance_m) / static_cast<double>(some.size());
  EXPECT_GT(mean, 51.2) << "not only the first ones";
}

TEST(TriangulationAngle, IsTheLargestAndExactWhenSmall) {
  const double small = 1e-7;
  EXPECT_NEAR(TriangulationAngle({0.0, 0.0, 0.0}, {{0.0, 0.0, 10.0}, {10.0 * small, 0.0, 10.0}}), small, 1e-12);
  EXPECT_NEAR(TriangulationAngle({1.0, 2.0, 3.0}, {{1.0, 2.0, 8.0}, {2.0, 2.0, 4.0}, {9.0, 2.0, 3.0}}), 0.5 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(TriangulationAngle({0.0, 0.0, 0.0}, {{0.0, 0.0, 10.0}, {0.0, 0.0, -1.0}}), std::numbers::pi, 1e-7);
  EXPECT_EQ(TriangulationAngle({0.0, 0.0, 0.0}, {{0.0, 0.0, 10.0}}), 0.0);
  EXPECT_EQ(TriangulationAngle({0.0, 0.0, 0.0}, {}), 0.0);
}

}  // namespace
}  // namespace skyquilt::worker
