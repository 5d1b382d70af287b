// Height map and background: bilinear heights, where rays meet the surface, filling of gaps, and the file.
#include "core/scene/background.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

// z = 10 + x / 4 over 40 x 20 m.
HeightMap Slope() {
  std::vector<double> heights;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 20; ++column) heights.push_back(10.0 + (column + 0.5) * 2.0 / 4.0);
  }
  return {{{0.0, 0.0}, 2.0, 20, 10}, heights};
}

RC_GTEST_PROP(HeightMap, IsExactOnASlopeAndLevelBeyondIt, ()) {
  const double x = *rc::gen::inRange(-100, 500) * 0.1, y = *rc::gen::inRange(-1000, 1000) * 0.1;
  RC_ASSERT(std::abs(Slope().At(x, y) - (10.0 + std::clamp(x, 1.0, 39.0) / 4.0)) < 1e-9);
}

TEST(HeightMap, IsMetByRaysThatGoDown) {
  Eigen::Vector3d x;
  const Eigen::Vector3d direction = Eigen::Vector3d(0.3, 0.1, -1.0).normalized();
  ASSERT_TRUE(Slope().Intersect({10.0, 10.0, 60.0}, direction, &x));
  EXPECT_NEAR(x.z(), Slope().At(x.x(), x.y()), 0.05);
  EXPECT_FALSE(Slope().Intersect({10.0, 10.0, 60.0}, {1.0, 0.0, 0.0}, &x)) << "level";
  EXPECT_FALSE(Slope().Intersect({10.0, 10.0, 5.0}, direction, &x)) << "below it";
  EXPECT_FALSE(HeightMap().Intersect({10.0, 10.0, 60.0}, direction, &x));
}

TEST(HeightMap, RefusesNumbersThatDoNotFit) {
  EXPECT_THROW(HeightMap({{0.0, 0.0}, 1.0, 2, 2}, {1.0}), std::invalid_argument);
  EXPECT_THROW(HeightMap({{0.0, 0.0}, 0.0, 1, 1}, {1.0}), std::invalid_argument);
  EXPECT_THROW(HeightMap({{0.0, 0.0}, std::nan(""), 1, 1}, {1.0}), std::invalid_argument);
}

RC_GTEST_PROP(FillFromSurroundings, KeepsWhatIsKnownAndStaysBetweenIt, ()) {
  const int columns = *rc::gen::inRange(1, 20), rows = *rc::gen::inRange(1, 20);
  const auto cells = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  std::vector<double> values(2 * cells, 1e9), weights(cells, 0.0);
  bool any = false;
  for (size_t i = 0; i < cells; ++i) {
    if (*rc::gen::inRange(0, 4) != 0) continue;
    any = true;
    weights[i] = *rc::gen::inRange(1, 5);
    values[2 * i] = *rc::gen::inRange(-3, 4);
    values[2 * i + 1] = 7.0;
  }
  const std::vector<double> before = values;
  FillFromSurroundings({columns, rows}, 2, &values, weights);
  for (size_t i = 0; i < cells && any; ++i) {
    if (weights[i] > 0.0) RC_ASSERT(values[2 * i] == before[2 * i]);
    RC_ASSERT(values[2 * i] >= -3.0 - 1e-9 && values[2 * i] <= 3.0 + 1e-9);
    RC_ASSERT(std::abs(values[2 * i + 1] - 7.0) < 1e-9);
  }
  if (!any) RC_ASSERT(values == before);
}

TEST(FillFromSurroundings, PrefersTheNearest) {
  std::vector<double> values(64, 0.0), weights(64, 0.0);
  values[0] = 1.0;
  weights[0] = 1.0;
  values[63] = 5.0;
  weights[63] = 1.0;
  FillFromSurroundings({64, 1}, 1, &values, weights);
  EXPECT_LT(values[5], 2.0);
  EXPECT_GT(values[58], 4.0);
}

class BackgroundFile : public ::testing::Test {
 protected:
  void Write(const Background& background) const {
    checkpoint::ArchiveWriter writer("scene", 1);
    PutBackground(background, writer);
    writer.Commit(file_);
  }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "s.h5";
};

TEST_F(BackgroundFile, BringsBackTheSameColours) {
  Background background{Slope(), {}, {0.25F, 0.5F, 0.75F}};
  for (int i = 0; i < 600; ++i) background.rgb_srgb.push_back(static_cast<float>(i) / 600.0F);
  for (int i = 0; i < 200; ++i) background.photos.push_back(static_cast<uint8_t>(i));
  Write(background);
  const Background read = GetBackground(checkpoint::ArchiveReader(file_), file_);
  EXPECT_EQ(read.photos, background.photos);
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(0.6, 0.0, -0.8), Eigen::Vector3d(0.0, 0.0, 1.0)}) {
    EXPECT_EQ(read.Color({7.0, 8.0, 50.0}, direction), background.Color({7.0, 8.0, 50.0}, direction));
  }
}

TEST_F(BackgroundFile, BringsBackTheSky) {
  Background background{{}, {}, {0.25F, 0.5F, 0.75F}};
  for (int row = 0; row < Background::kSkyRows; ++row) {
    for (int column = 0; column < Background::kSkyColumns; ++column) {
      const double azimuth = (column + 0.5) / Background::kSkyColumns * 2.0 * std::numbers::pi;
      for (const double value : {0.5 + 0.4 * std::cos(azimuth), 0.5 + 0.4 * std::sin(azimuth), 0.1 * row}) {
        background.sky_srgb.push_back(static_cast<float>(value));
      }
    }
  }
  Write(background);
  const Background read = GetBackground(checkpoint::ArchiveReader(file_), file_);
  EXPECT_EQ(read.sky_srgb, background.sky_srgb);
  EXPECT_EQ(read.Color({0.0, 0.0, 9.0}, {0.0, 0.8, -0.6}), background.mean_srgb) << "below the horizon";
  for (int i = 0; i <= 100; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / 100.0, elevation = 0.01 + 1.55 * i / 100.0;
    const std::array<float, 3> rgb =
        read.Color({0.0, 0.0, 9.0}, {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
    EXPECT_NEAR(static_cast<double>(rgb[0]), 0.5 + 0.4 * std::cos(azimuth), 0.01) << i;
    EXPECT_NEAR(static_cast<double>(rgb[1]), 0.5 + 0.4 * std::sin(azimuth), 0.01) << i;
    EXPECT_NEAR(static_cast<double>(rgb[2]), 0.1 * std::clamp(elevation / (0.5 * std::numbers::pi) * 9.0 - 0.5, 0.0, 8.0), 0.01) << i;
  }
  const std::vector<float> few(9, 0.5F);
  checkpoint::ArchiveWriter writer("scene", 1);
  writer.Put("background/sky", few, {1, 3, 3});
  writer.Commit(file_);
  EXPECT_THROW(GetBackground(checkpoint::ArchiveReader(file_), file_), base::InputError);
}

TEST_F(BackgroundFile, MayHoldNoSurfaceOrNothing) {
  Write({{}, {}, {0.25F, 0.5F, 0.75F}});
  const Background read = GetBackground(checkpoint::ArchiveReader(file_), file_);
  EXPECT_TRUE(read.surface.Empty());
  EXPECT_EQ(read.Color({0.0, 0.0, 9.0}, {0.0, 0.0, -1.0})[1], 0.5F);
  checkpoint::ArchiveWriter("scene", 1).Commit(file_);
  EXPECT_EQ(GetBackground(checkpoint::ArchiveReader(file_), file_).mean_srgb[0], 0.0F);
}

TEST_F(BackgroundFile, IsRefusedWhenItsPartsDisagree) {
  Background background{Slope(), std::vector<float>(600), {}};
  const std::vector<double> heights(12, 1.0);
  checkpoint::ArchiveWriter writer("scene", 1);
  writer.Put("background/heights", heights, {4, 3});
  writer.Put("background/colors", background.rgb_srgb, {10, 20, 3});
  writer.Commit(file_);
  EXPECT_THROW(GetBackground(checkpoint::ArchiveReader(file_), file_), base::InputError);
}

TEST_F(BackgroundFile, IsRefusedWithNumbersOfPhotosForOtherCells) {
  const Background background{Slope(), std::vector<float>(600), {}};
  const std::vector<uint8_t> photos(12, 1);
  checkpoint::ArchiveWriter writer("scene", 1);
  PutBackground(background, writer);
  writer.Put("background/photos", photos, {4, 3});
  writer.Commit(file_);
  EXPECT_THROW(GetBackground(checkpoint::ArchiveReader(file_), file_), base::InputError);
}

}  // namespace
}  // namespace skyquilt::scene
