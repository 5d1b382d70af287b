// Photos that look straight down from 50 m onto flat ground at 2 m: which tiles only one of them sees, and what rays bring from there.
#include "worker/lonely_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/image/image.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kGround = 2.0;

class LonelyTilesTest : public ::testing::Test {
 protected:
  // Photos at x = 0 and x = shift; focal length 48 pixels: each shows 96 x 72 m of ground.
  void Photograph(double shift_m) {
    camera::Camera camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.params = {48.0, 48.0, kWidth / 2.0, kHeight / 2.0};
    survey_.cameras = {camera};
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < 2; ++i) {
      survey::Photo photo;
      photo.name = "p" + std::to_string(i) + ".png";
      Eigen::Matrix3d rotation;
      rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      photo.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
      photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * Eigen::Vector3d(i * shift_m, 0.0, 50.0));
      image::Image8 picture(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) picture.At(x, y)[0] = static_cast<uint8_t>((x + y) % 2 == 0 ? 200 : 100);  // a fine check
      }
      image::SavePng(picture, folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(photo);
    }
    for (int i = 0; i < 900; ++i) {
      survey::SparsePoint point;
      point.x_in_enu = {-50.0 + (i % 30) * 6.0, -40.0 + (i / 30) * 3.0, kGround};
      survey_.points.push_back(point);
    }
    base::ThreadPool threads(1);
    pixels_ = image::PixelCache::Open(folder_ / "pixels.bin", sources, 0, threads);
    source_ = std::make_unique<RaySource>(survey_, pixels_, std::vector<float>{1.0F, 1.0F});
    source_->SetTiles(TrainingTiles(survey_, {0, 1}), {}, 0.0);
  }

  TemporaryFolder folder_;
  survey::Survey survey_;
  image::PixelCache pixels_;
  std::unique_ptr<RaySource> source_;
};

TEST_F(LonelyTilesTest, AreThoseNoOtherPhotoSees) {
  Photograph(48.0);
  const std::vector<Tile> lonely = LonelyTiles(*source_, survey_, {0, 1});
  std::set<std::pair<int, int>> columns;
  for (const Tile& tile : lonely) columns.insert({tile.photo, tile.column});
  // The second photo begins at x = 0 m, the first photo's middle.
  for (int column = 0; column < kTileColumns; ++column) {
    EXPECT_EQ(columns.count({0, column}), column < kTileColumns / 2 ? 1U : 0U) << column;
    EXPECT_EQ(columns.count({1, column}), column >= kTileColumns / 2 ? 1U : 0U) << column;
  }
  EXPECT_EQ(lonely.size(), static_cast<size_t>(kTileColumns * kTileRows));
}

TEST_F(LonelyTilesTest, AHeldOutPhotoIsNoCompany) {
  Photograph(48.0);
  survey_.photos[1].is_test = true;
  EXPECT_EQ(LonelyTiles(*source_, survey_, {0, 1}).size(), static_cast<size_t>(kTileColumns * kTileRows));
}

TEST_F(LonelyTilesTest, WithoutPointsNothingIsKnownToBeLonely) {
  Photograph(48.0);
  survey_.points.clear();
  EXPECT_TRUE(LonelyTiles(*source_, survey_, {0, 1}).empty());
}

TEST_F(LonelyTilesTest, RaysBringTheirMeanColourAndOthersTheirPixel) {
  Photograph(48.0);
  source_->BlurTiles(LonelyTiles(*source_, survey_, {0, 1}));
  base::Random random(3);
  int blurred = 0, sharp = 0;
  PixelRay ray;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(source_->Draw(random, &ray));
    const float red = 255.0F * ray.target_srgb[0];
    const Eigen::Vector3d ground = ray.origin_enu + (kGround - ray.origin_enu.z()) / ray.direction_enu.z() * ray.direction_enu;
    const bool lonely = ground.x() < 0.0 || ground.x() > 48.0;
    if (lonely) {
      EXPECT_NEAR(red, 150.0F, 1.0F);
      ++blurred;
    } else {
      EXPECT_NEAR(std::abs(red - 150.0F), 50.0F, 0.5F);
      ++sharp;
    }
  }
  EXPECT_GT(blurred, 500);
  EXPECT_GT(sharp, 500);
}

TEST_F(LonelyTilesTest, MeanColourIsTakenInLinearLight) {
  Photograph(48.0);
  const std::array<float, 3> mean = source_->MeanColor(1);
  const auto linear = [](double v) { return std::pow((v / 255.0 + 0.055) / 1.055, 2.4); };
  const double expected = 1.055 * std::pow(0.5 * (linear(200.0) + linear(100.0)), 1.0 / 2.4) - 0.055;
  EXPECT_NEAR(static_cast<double>(mean[0]), expected, 0.01);
  EXPECT_EQ(mean[1], 0.0F);
}

TEST(PointHeights, FollowTheGroundAndReachBeyondThePoints) {
  survey::Survey survey;
  for (int i = 0; i < 4000; ++i) {
    const double x = (i % 80) * 1.0, y = (i / 80) * 1.0;
    survey::SparsePoint point;
    point.x_in_enu = {x, y, x < 40.0 ? 5.0 : 25.0};
    survey.points.push_back(point);
  }
  const PointHeights heights(survey);
  EXPECT_DOUBLE_EQ(heights.At(10.0, 20.0), 5.0);
  EXPECT_DOUBLE_EQ(heights.At(70.0, 20.0), 25.0);
  EXPECT_DOUBLE_EQ(heights.At(-500.0, 900.0), 5.0);
  Eigen::Vector3d x;
  ASSERT_TRUE(heights.Meet({10.0, 10.0, 60.0}, Eigen::Vector3d(1.0, 0.2, -1.0).normalized(), &x));
  EXPECT_NEAR(x.z(), 25.0, 1e-6) << "beyond the step, 35 m further east";
  EXPECT_FALSE(heights.Meet({10.0, 10.0, 60.0}, Eigen::Vector3d(1.0, 0.0, 0.0), &x)) << "a level ray";
  EXPECT_TRUE(PointHeights(survey::Survey()).Empty());
}

}  // namespace
}  // namespace skyquilt::worker
