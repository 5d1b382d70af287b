// Two photos that look level at a wall, its points, and the sky above it: what is free, hidden, seen by both, and sky.
#include "worker/start/point_ranges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/image/image.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"
#include "worker/make_background.h"
#include "worker/start/starting_occupancy.h"
#include "worker/start/surface_interval.h"
#include "worker/start/view_count.h"

namespace skyquilt::worker {
namespace {

constexpr int kLevelPhotoWidth = 96, kLevelPhotoHeight = 72;
constexpr double kWall = 20.0;  // y of the wall, which is 10 m high
constexpr int kWindowRow = 19;  // of pixels, three below the sky

class PointRangesTest : public ::testing::Test {
 protected:
  using MakePhoto = survey::Photo(const Eigen::Vector3d& eye, const std::string& name);

  // Photos at x = 0 and x = 16, 2 m above the ground: each shows 40 x 30 m of the plane of the wall.
  void Photograph(std::array<uint8_t, 3> above, MakePhoto make = LevelPhoto, bool ceiling = false) {
    camera::Camera camera;
    camera.width = kLevelPhotoWidth;
    camera.height = kLevelPhotoHeight;
    camera.params = {48.0, 48.0, kLevelPhotoWidth / 2.0, kLevelPhotoHeight / 2.0};
    survey_ = {};
    survey_.cameras = {camera};
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < 2; ++i) {
      survey::Photo photo = make({16.0 * i, 0.0, 2.0}, "p" + std::to_string(i) + ".png");
      image::Image8 picture(kLevelPhotoWidth, kLevelPhotoHeight, 3);
      for (int y = 0; y < kLevelPhotoHeight; ++y) {
        const bool is_wall = (kLevelPhotoHeight / 2 - y) * kWall / 48.0 < 8.0;  // its top is 8 m above the cameras
        for (int x = 0; x < kLevelPhotoWidth; ++x) {
          const bool is_window = y == kWindowRow && windows_;
          for (size_t c = 0; c < 3; ++c) picture.At(x, y)[c] = is_wall && !is_window ? 150 : above[c];
        }
      }
      image::SavePng(picture, folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(std::move(photo));
    }
    for (double z = 0.5; z < 10.0; z += 1.0) {
      for (double x = -20.0; x < 36.0; x += 1.0) {
        survey::SparsePoint point;
        point.x_in_enu = {x, kWall, z};
        std::vector<int32_t> seen_by;
        for (int i = 0; i < 2; ++i) {
          if (std::abs(x - 16.0 * i) < 19.0) seen_by.push_back(i);
        }
        survey_.points.push_back(point);
        survey_.tracks.Add(seen_by);
      }
    }
    for (double x = -20.0; ceiling && x < 36.0; x += 0.5) {
      survey::SparsePoint point;
      point.x_in_enu = {x, 15.0, 30.0};  // above what the photos show
      survey_.points.push_back(point);
      survey_.tracks.Add({0, 1});
    }
    pixels_ = image::PixelCache::Open(folder_ / "pixels.bin", sources, 0, threads_);
    source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
    source_->SetTiles(TrainingTiles(survey_, {0, 1}), {}, 0.0);
    ranges_ = PointRanges(survey_, *source_, {0, 1}, threads_);
  }
  // The tile of the first photo that shows a place.
  static Tile TileOf(double x, double y, double z) {
    const double u = 48.0 + 48.0 * x / y, v = 36.0 - 48.0 * (z - 2.0) / y;
    return {0, static_cast<int16_t>(u * kTileColumns / kLevelPhotoWidth), static_cast<int16_t>(v * kTileRows / kLevelPhotoHeight)};
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  survey::Survey survey_;
  image::PixelCache pixels_;
  brightness::Response response_ = brightness::Response::Neutral(2, 1);
  std::unique_ptr<RaySource> source_;
  PointRanges ranges_;
  bool sky_given_ = false, windows_ = false;
};

constexpr std::array<uint8_t, 3> kBlue = {150, 180, 230}, kLamplight = {230, 215, 190};

TEST_F(PointRangesTest, BoundTheSpaceNearThePoints) {
  Photograph(kBlue);
  ASSERT_FALSE(ranges_.Empty());
  const PointRanges::Range& wall = ranges_.Of(TileOf(0.0, kWall, 5.0));
  EXPECT_TRUE(wall.Known());
  EXPECT_NEAR(wall.nearest, std::hypot(kWall, 3.0), 0.5);
  EXPECT_NEAR(wall.near, 0.8 * static_cast<double>(wall.nearest), 1e-4);
  EXPECT_NEAR(wall.far, 1.25 * static_cast<double>(wall.farthest), 1e-4);
  EXPECT_TRUE(ranges_.MayShow(0, {0.0, kWall, 5.0}, 0.0));
  EXPECT_FALSE(ranges_.MayShow(0, {0.0, 5.0, 2.5}, 0.0)) << "before the wall";
  EXPECT_FALSE(ranges_.MayShow(0, {0.0, 40.0, 5.0}, 0.0)) << "behind the wall";
  EXPECT_TRUE(ranges_.MayShow(0, {0.0, 40.0, 5.0}, 16.0)) << "a ball that reaches back to it";
}

TEST_F(PointRangesTest, PhotosThatLookDownHaveNone) {
  Photograph(kBlue, NadirPhoto);
  EXPECT_TRUE(ranges_.Empty());
}

TEST_F(PointRangesTest, SkyIsBrightAndNotReddishAboveAllPoints) {
  Photograph(kBlue);
  EXPECT_TRUE(ranges_.Of(TileOf(0.0, kWall, 16.5)).Sky());
  EXPECT_TRUE(ranges_.Of(TileOf(0.0, kWall, 10.8)).Sky()) << "points are close, but the colour is that of the sky above";
  EXPECT_FALSE(ranges_.OpenSky(TileOf(0.0, kWall, 10.8))) << "the wall is beside it";
  EXPECT_TRUE(ranges_.OpenSky(TileOf(0.0, kWall, 16.5)));
  EXPECT_FALSE(ranges_.Of(TileOf(0.0, kWall, 5.0)).Sky());
  EXPECT_FALSE(ranges_.Of(TileOf(0.0, kWall, -12.0)).Sky()) << "below the horizon";
  Photograph(kLamplight);
  EXPECT_FALSE(ranges_.Of(TileOf(0.0, kWall, 16.5)).Sky()) << "a ceiling";
  Photograph(kBlue, LevelPhoto, true);
  EXPECT_FALSE(ranges_.Of(TileOf(0.0, kWall, 16.5)).Sky()) << "there are points above it, so it is a wall";
}

TEST_F(PointRangesTest, PixelsOfTheSkyBesideTheWallHaveEmptyRays) {
  windows_ = true;
  Photograph(kBlue);
  const Tile mixed = TileOf(0.0, kWall, 10.0);  // its upper pixels show the sky, its lower ones the wall
  const Tile below{mixed.photo, mixed.column, static_cast<int16_t>(mixed.row + 1)};
  source_->SetTiles({mixed, below}, {}, 0.0);
  base::Random random(1);
  const auto draw = [&](int* sky, int* wall) {
    for (int i = 0; i < 100; ++i) {
      PixelRay ray;
      ASSERT_TRUE(source_->Draw(random, PhotoPyramid(), &ray));
      const bool blue = ray.target_srgb[2] > 0.8F, rises = ray.direction_enu.z() > 0.355;
      ++(blue ? *sky : *wall);
      // Windows in the wall mirror the sky, and are not it.
      EXPECT_EQ(ray.empty, blue && rises && sky_given_) << ray.direction_enu.transpose();
    }
  };
  int sky = 0, wall = 0;
  draw(&sky, &wall);
  sky_given_ = true;
  ranges_.GiveSky(*source_, threads_);
  draw(&sky, &wall);
  EXPECT_GT(sky, 20);
  EXPECT_GT(wall, 20);
}

TEST_F(PointRangesTest, NothingIsNextToACamera) {
  Photograph(kBlue);
  for (const Eigen::Vector3d& free : {Eigen::Vector3d(0.0, 15.0, 2.0), {0.0, 0.0, 2.0}, {16.0, 0.0, 12.0}, {0.0, -15.0, 2.0}}) {
    EXPECT_TRUE(ranges_.InFreeSpace(free, 0.0)) << free.transpose();
  }
  for (const Eigen::Vector3d& not_known : {Eigen::Vector3d(0.0, 17.0, 2.0), {8.0, 17.0, 2.0}, {0.0, -17.0, 2.0}, {40.0, 0.0, 2.0}}) {
    EXPECT_FALSE(ranges_.InFreeSpace(not_known, 0.0)) << not_known.transpose();
  }
}

// It is as far to this place from the way between the cameras as the nearest points are, but for a part, and farther from either camera.
TEST_F(PointRangesTest, TheWayFromPhotoToPhotoIsFree) {
  Photograph(kBlue);
  const Eigen::Vector3d beside_the_way(8.0, -14.0, 7.0);
  EXPECT_TRUE(ranges_.InFreeSpace(beside_the_way, 0.0));
  EXPECT_FALSE(ranges_.InFreeSpace({8.0, -17.0, 7.0}, 0.0));
  survey_.photos[1].flight = 1;
  EXPECT_FALSE(PointRanges(survey_, *source_, {0, 1}, threads_).InFreeSpace(beside_the_way, 0.0)) << "nothing went from one to the other";
}

// The ground has no points. The lowest are half a metre above it, on the wall.
TEST_F(PointRangesTest, PlainGroundBeforeACameraIsNotFree) {
  Photograph(kBlue);
  EXPECT_TRUE(ranges_.InFreeSpace({0.0, 10.0, 1.0}, 0.0));
  EXPECT_FALSE(ranges_.InFreeSpace({0.0, 10.0, 1.0}, 0.5)) << "a ball that reaches the ground";
  EXPECT_FALSE(ranges_.InFreeSpace({0.0, 10.0, 0.5}, 0.0));
  EXPECT_FALSE(ranges_.InFreeSpace({0.0, 10.0, 0.0}, 0.0));
  EXPECT_TRUE(ranges_.MayShow(0, {0.0, 6.0, 0.0}, 0.0)) << "the ground in the lower part of the photo";
  EXPECT_TRUE(ranges_.MayShow(0, {0.0, 6.0, 0.5}, 0.0));
  EXPECT_FALSE(ranges_.MayShow(0, {0.0, 3.0, 1.0}, 0.0)) << "above the ground";
}

TEST_F(PointRangesTest, CeilingsAreNotFreeWhereNoPhotoShowsTheSky) {
  Photograph(kLamplight);
  EXPECT_TRUE(ranges_.InFreeSpace({0.0, 0.0, 4.0}, 0.0));
  EXPECT_FALSE(ranges_.InFreeSpace({0.0, 0.0, 9.5}, 0.0));
  Photograph(kBlue);
  EXPECT_TRUE(ranges_.InFreeSpace({0.0, 0.0, 9.5}, 0.0));
}

// Without points below the camera nothing tells how high it is.
TEST_F(PointRangesTest, PointsAboveACameraAreNoFloor) {
  Photograph(kBlue);
  survey_.points.clear();
  survey_.tracks = {};
  for (double x = -20.0; x < 36.0; x += 0.5) {
    survey::SparsePoint point;
    point.x_in_enu = {x, kWall, 6.0};
    survey_.points.push_back(point);
    survey_.tracks.Add({0, 1});
  }
  const PointRanges ranges(survey_, *source_, {0, 1}, threads_);
  EXPECT_TRUE(ranges.InFreeSpace({0.0, 10.0, 0.0}, 0.0));
  EXPECT_FALSE(ranges.MayShow(0, {0.0, 6.0, 0.0}, 0.0));
}

TEST_F(PointRangesTest, NothingIsBeforeTheSky) {
  Photograph(kBlue);
  const Eigen::Vector3d before_sky(0.0, 12.0, 2.0 + 12.0 * 14.5 / kWall);
  EXPECT_FALSE(ranges_.MayShow(0, before_sky, 0.0));
  EXPECT_FALSE(ranges_.MayShow(0, 2.0 * before_sky, 0.1));
  EXPECT_TRUE(ranges_.MayShow(0, {0.0, kWall, 14.0}, 6.0)) << "a ball that reaches down to the wall";
}

TEST_F(PointRangesTest, FieldsLearnToBeTransparentBeforeTheSky) {
  Photograph(kBlue);
  render::TrainedField f;
  f.map = encoding::SpaceMap::Box({-30.0, -2.0, -4.0}, {46.0, 40.0, 40.0});
  ChooseTiles(survey_, TrainingTiles(survey_, {0, 1}), f, nullptr, ranges_, 0.25, *source_, threads_);
  base::Random random(1, 2);
  int empty = 0, high = 0;
  for (int i = 0; i < 400; ++i) {
    PixelRay ray;
    ASSERT_TRUE(source_->Draw(random, PhotoPyramid(), &ray));
    const bool above_wall = ray.direction_enu.z() * kWall > 8.0 * ray.direction_enu.y();
    empty += ray.empty ? 1 : 0;
    EXPECT_TRUE(!ray.empty || above_wall);
    high += !ray.empty && ray.direction_enu.z() * kWall > 11.0 * ray.direction_enu.y() ? 1 : 0;
  }
  EXPECT_NEAR(empty, 100, 35);
  EXPECT_EQ(high, 0) << "sky is never taken for something that stands there";
}

TEST_F(PointRangesTest, TilesThatOnePhotoShowsAreLeftOut) {
  Photograph(kBlue);
  int west = 0, both = 0;
  for (const Tile& tile : TilesWithEnoughViews(*source_, survey_, {0, 1}, {}, ranges_, 2, threads_)) {
    if (tile.photo == 0 && tile.row == TileOf(0.0, kWall, 5.0).row) ++(tile.column < TileOf(-6.0, kWall, 5.0).column ? west : both);
  }
  EXPECT_EQ(west, 0);
  EXPECT_GT(both, 20);
}

TEST_F(PointRangesTest, TrainingStartsNearThePointsAndLeavesTheSkyFree) {
  Photograph(kBlue);
  render::TrainedField f;
  f.map = encoding::SpaceMap::Box({-30.0, -2.0, -4.0}, {46.0, 40.0, 24.0});
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) extent[axis] = f.map.extent()[axis];
  f.occupancy = field::OccupancyGrid::Make(extent, 0.5 * f.map.units_per_metre(), 4'000'000);
  f.step_m = 0.25;
  MarkUnseen(*source_, survey_, {0, 1}, {}, ranges_, 2, f, threads_);
  StartFromRanges(*source_, ranges_, TrainingTiles(survey_, {0, 1}), f);
  const auto cell = [&](double x, double y, double z) {
    const Eigen::Vector3f unit = f.map.UnitFromEnu({x, y, z});
    return static_cast<size_t>(f.occupancy.IndexAt(unit.x(), unit.y(), unit.z()));
  };
  EXPECT_TRUE(f.occupancy.occupied[cell(8.0, kWall, 5.0)]);
  EXPECT_FALSE(f.occupancy.occupied[cell(8.0, 3.0, 2.0)]) << "before the cameras";
  EXPECT_FALSE(f.occupancy.occupied[cell(8.0, 38.0, 5.0)]) << "behind the wall";
  EXPECT_LT(f.occupancy.tau[cell(8.0, 38.0, 5.0)], 0.0F);
  EXPECT_FALSE(f.occupancy.occupied[cell(8.0, kWall, 15.5)]) << "sky";
}

TEST_F(PointRangesTest, TheBackgroundHasTheColourOfTheSkyAboveTheHorizon) {
  Photograph(kBlue);
  const scene::Background background = MakeBackground(*source_, survey_, {}, ranges_, 1, threads_);
  const std::array<float, 3> up = background.Color({0.0, 0.0, 2.0}, Eigen::Vector3d(0.0, 1.0, 0.7).normalized());
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(up[c], static_cast<float>(kBlue[c]) / 255.0F, 0.02F);
  EXPECT_EQ(background.Color({0.0, 0.0, 2.0}, Eigen::Vector3d(0.0, 1.0, -0.7).normalized()), background.mean_srgb);
  Photograph(kLamplight);
  EXPECT_TRUE(MakeBackground(*source_, survey_, {}, ranges_, 1, threads_).sky_srgb.empty());
}

}  // namespace
}  // namespace skyquilt::worker
