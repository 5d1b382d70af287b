// Nadir photos from 50 m above flat ground at 2 m: tiles and cells that too few of them see, and the background there.
#include "worker/start/view_count.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/image/image.h"
#include "core/image/srgb.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"
#include "worker/make_background.h"
#include "worker/start/point_surface.h"
#include "worker/start/starting_occupancy.h"

namespace skyquilt::worker {
namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kGround = 2.0;

class ViewCountTest : public ::testing::Test {
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
      const survey::Photo photo = NadirPhoto({i * shift_m, 0.0, 50.0}, "p" + std::to_string(i) + ".png");
      image::Image8 picture(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y) {
        // A fine checkerboard in red; green in the west of the first photo and in the east of the second.
        for (int x = 0; x < kWidth; ++x) {
          picture.At(x, y)[0] = static_cast<uint8_t>((x + y) % 2 == 0 ? 200 : 100);
          picture.At(x, y)[1] = (x < kWidth / 2) == (i == 0) ? 80 : 0;
        }
      }
      image::SavePng(picture, folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(photo);
    }
    for (int i = 0; i < 900; ++i) {
      const int row = i / 30;
      survey::SparsePoint point;
      point.x_in_enu = {-50.0 + (i % 30) * 6.0, -40.0 + row * 3.0, kGround};
      survey_.points.push_back(point);
    }
    base::ThreadPool threads(1);
    pixels_ = image::PixelCache::Open(folder_ / "pixels.bin", sources, 0, threads);
    source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
    source_->SetTiles(TrainingTiles(survey_, {0, 1}), {}, 0.0);
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  survey::Survey survey_;
  image::PixelCache pixels_;
  brightness::Response response_ = brightness::Response::Neutral(2, 1);
  std::unique_ptr<RaySource> source_;
};

TEST_F(ViewCountTest, ColoursOfTilesHaveTheGainsOfNow) {
  Photograph(0.0);
  response_.log_gain[0] = std::log(2.0F);  // red of the first photo, behind the source's back
  const std::vector<Eigen::Vector3f> even = source_->TileColors(0);
  response_.vignetting[2] = 1e-20F;  // too little to change a colour, but there
  const std::vector<Eigen::Vector3f> with_vignetting = source_->TileColors(0);
  const auto half = [](float value) { return image::SrgbFromLinear(image::LinearFromSrgb(value / 255.0F) / 2.0F); };
  const float red = 0.5F * (half(200.0F) + half(100.0F));
  ASSERT_EQ(even.size(), with_vignetting.size());
  for (size_t i = 0; i < even.size(); ++i) {
    EXPECT_NEAR(even[i].x(), red, 1e-5F) << i;
    EXPECT_LT((even[i] - with_vignetting[i]).cwiseAbs().maxCoeff(), 1e-6F) << i;
  }
}

TEST_F(ViewCountTest, TilesThatOtherPhotosSeeAreKept) {
  Photograph(48.0);
  const std::vector<Tile> tiles = TilesWithEnoughViews(*source_, survey_, {0, 1}, SurfaceOfPoints(survey_), {}, 2, threads_);
  std::set<std::pair<int, int>> columns;
  for (const Tile& tile : tiles) columns.insert({tile.photo, tile.column});
  // The second photo begins at x = 0 m, the first photo's middle.
  for (int column = 0; column < kTileColumns; ++column) {
    EXPECT_EQ(columns.count({0, column}), column < kTileColumns / 2 ? 0U : 1U) << column;
    EXPECT_EQ(columns.count({1, column}), column >= kTileColumns / 2 ? 0U : 1U) << column;
  }
  EXPECT_EQ(tiles.size(), static_cast<size_t>(kTileColumns * kTileRows));
}

TEST_F(ViewCountTest, OneViewIsEnoughWhenAskedFor) {
  Photograph(48.0);
  EXPECT_EQ(TilesWithEnoughViews(*source_, survey_, {0, 1}, SurfaceOfPoints(survey_), {}, 1, threads_).size(),
            static_cast<size_t>(2 * kTileColumns * kTileRows));
}

TEST_F(ViewCountTest, AHeldOutPhotoDoesNotCountAndAllTilesAreKeptWhenNoneHasEnough) {
  Photograph(48.0);
  survey_.photos[1].is_test = true;
  const std::vector<Tile> tiles = TilesWithEnoughViews(*source_, survey_, {0, 1}, SurfaceOfPoints(survey_), {}, 2, threads_);
  EXPECT_EQ(tiles.size(), static_cast<size_t>(kTileColumns * kTileRows)) << "all tiles of the only training photo";
}

TEST_F(ViewCountTest, WithoutPointsEveryTileCounts) {
  Photograph(48.0);
  survey_.points.clear();
  EXPECT_TRUE(SurfaceOfPoints(survey_).Empty());
  EXPECT_EQ(TilesWithEnoughViews(*source_, survey_, {0, 1}, {}, {}, 2, threads_).size(), static_cast<size_t>(2 * kTileColumns * kTileRows));
}

TEST_F(ViewCountTest, CellsOverGroundThatOnePhotoShowsAreNeverSeen) {
  Photograph(48.0);
  base::ThreadPool threads(2);
  const auto seen = [&](int min_views, double x, double z) {
    render::TrainedField f;
    f.map = encoding::SpaceMap::Box({-60.0, -40.0, 0.0}, {110.0, 40.0, 30.0});
    double extent[3];
    for (int axis = 0; axis < 3; ++axis) extent[axis] = f.map.extent()[axis];
    f.occupancy = field::OccupancyGrid::Make(extent, 0.5 * f.map.units_per_metre(), 4'000'000);
    MarkUnseen(*source_, survey_, {0, 1}, SurfaceOfPoints(survey_), {}, min_views, f, threads);
    const Eigen::Vector3f unit = f.map.UnitFromEnu({x, 0.0, z});
    return f.occupancy.tau[static_cast<size_t>(f.occupancy.IndexAt(unit.x(), unit.y(), unit.z()))] >= 0.0F;
  };
  EXPECT_TRUE(seen(2, 24.0, 3.0)) << "in both photos";
  EXPECT_TRUE(seen(2, 24.0, 15.0));
  EXPECT_FALSE(seen(2, -24.0, 3.0)) << "in the first photo alone";
  EXPECT_FALSE(seen(2, 72.0, 3.0)) << "in the second photo alone";
  EXPECT_TRUE(seen(1, -24.0, 3.0));
  EXPECT_FALSE(seen(1, -58.0, 3.0)) << "in none";
  survey_.photos[1].is_test = true;
  EXPECT_TRUE(seen(2, -24.0, 3.0)) << "a survey of one photo keeps all it sees";
}

TEST_F(ViewCountTest, TheBackgroundShowsCoarseColoursWhereOnePhotoLookedAndNearOnesWhereNoneDid) {
  Photograph(48.0);
  base::ThreadPool threads(2);
  const scene::Background background = MakeBackground(*source_, survey_, SurfaceOfPoints(survey_), {}, 1, threads);
  const auto down_at = [&](double x) { return background.Color({x, 0.0, 50.0}, {0.0, 0.0, -1.0}); };
  EXPECT_NEAR(down_at(-24.0)[0], 150.0F / 255.0F, 0.01F) << "the checkerboard is blurred";
  EXPECT_NEAR(down_at(-24.0)[1], 80.0F / 255.0F, 0.01F);
  EXPECT_NEAR(down_at(24.0)[1], 0.0F, 0.01F);
  EXPECT_NEAR(down_at(80.0)[1], 80.0F / 255.0F, 0.01F);
  EXPECT_NEAR(down_at(-300.0)[1], 80.0F / 255.0F, 0.02F) << "beyond the photos the colour of their edge is continued";
  EXPECT_EQ(background.Color({0.0, 0.0, 50.0}, {1.0, 0.0, 0.1}), background.mean_srgb) << "the sky";
  // The same when photos are read in parts.
  const scene::Background parts = MakeBackground(*source_, survey_, SurfaceOfPoints(survey_), {}, 1, threads, 1);
  EXPECT_EQ(parts.rgb_srgb, background.rgb_srgb);
  EXPECT_EQ(parts.mean_srgb, background.mean_srgb);
  EXPECT_EQ(parts.photos, background.photos);
  const auto photos_at = [&](double x) { return background.photos[background.surface.Around(x, 0.0).cell[0]]; };
  EXPECT_EQ(photos_at(-24.0), 1);
  EXPECT_EQ(photos_at(24.0), 2);
  EXPECT_EQ(photos_at(72.0), 1);
  const scene::Background flat = MakeBackground(*source_, survey_, {}, {}, 1, threads);
  EXPECT_EQ(flat.Color({0.0, 0.0, 50.0}, {0.0, 0.0, -1.0}), flat.mean_srgb) << "without points";
}

TEST_F(ViewCountTest, MeanColourIsTakenInLinearLight) {
  Photograph(48.0);
  const std::array<float, 3> mean = source_->MeanColor(1);
  const auto linear = [](double v) { return std::pow((v / 255.0 + 0.055) / 1.055, 2.4); };
  const auto display = [](double light) { return 1.055 * std::pow(light, 1.0 / 2.4) - 0.055; };
  EXPECT_NEAR(static_cast<double>(mean[0]), display(0.5 * (linear(200.0) + linear(100.0))), 0.01);
  EXPECT_NEAR(static_cast<double>(mean[1]), display(0.5 * linear(80.0)), 0.01);
  EXPECT_EQ(mean[2], 0.0F);
}

TEST(SurfaceOfPoints, FollowsTheGroundAndReachesBeyondThePoints) {
  survey::Survey survey;
  for (int i = 0; i < 4000; ++i) {
    const int column = i % 80, row = i / 80;
    const double x = column, y = row;
    survey::SparsePoint point;
    point.x_in_enu = {x, y, x < 40.0 ? 5.0 : 25.0};
    survey.points.push_back(point);
  }
  const scene::HeightMap surface = SurfaceOfPoints(survey);
  EXPECT_DOUBLE_EQ(surface.At(10.0, 20.0), 5.0);
  EXPECT_DOUBLE_EQ(surface.At(70.0, 20.0), 25.0);
  EXPECT_DOUBLE_EQ(surface.At(-500.0, 900.0), 5.0);
  EXPECT_TRUE(SurfaceOfPoints(survey::Survey()).Empty());
  // Two outliers do not enlarge the grid.
  for (const double far : {-1e6, 1e6}) {
    survey::SparsePoint stray;
    stray.x_in_enu = {far, far, 1e4};
    survey.points.push_back(stray);
  }
  EXPECT_DOUBLE_EQ(SurfaceOfPoints(survey).At(10.0, 20.0), 5.0);
  EXPECT_DOUBLE_EQ(SurfaceOfPoints(survey).At(70.0, 20.0), 25.0);
}

}  // namespace
}  // namespace skyquilt::worker
