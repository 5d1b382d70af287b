#include <gtest/gtest.h>

#include <limits>

#include "core/image/image.h"
#include "tests/core/image/raw_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::image {
namespace {

TEST(Resize, AveragesAreas) {
  Image8 image(4, 2, 3);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<uint8_t>(i * 10);
  const Image8 half = Resize(image, 2, 1);
  ASSERT_EQ(half.data.size(), 6U);
  // First pixel, red: values 0, 30, 120, 150 of the 2x2 pixels under it.
  EXPECT_EQ(half.data[0], 75);
  EXPECT_EQ(half.data[3], (60 + 90 + 180 + 210) / 4);
}

TEST(Resize, KeepsFlatColourAtAwkwardSizes) {
  Image8 image(101, 67, 3);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<uint8_t>(50 + 70 * (i % 3));
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{100, 66}, std::pair{37, 5}, std::pair{101, 67}, std::pair{150, 80}}) {
    const Image8 resized = Resize(image, width, height);
    for (size_t i = 0; i < resized.data.size(); ++i) ASSERT_EQ(resized.data[i], 50 + 70 * (i % 3)) << width << "x" << height;
  }
}

TEST(ResizeMask, UsesAPixelOnlyIfItsWholeAreaIsUsed) {
  Image8 mask(9, 6, 1, 200);
  *mask.At(4, 3) = 0;
  const Image8 third = ResizeMask(mask, 3, 2);
  EXPECT_EQ(third.data, (std::vector<uint8_t>{255, 255, 255, 255, 0, 255}));
  // From 9 to 2 columns, both overlap half of source column 4.
  EXPECT_EQ(ResizeMask(mask, 2, 1).data, (std::vector<uint8_t>{0, 0}));
  const Image8 same = ResizeMask(mask, 9, 6);
  EXPECT_EQ(*same.At(4, 3), 0);
  EXPECT_EQ(*same.At(3, 3), 255);
}

TEST(ResizeMask, NeverUsesAPixelThatOverlapsAnIgnoredOne) {
  for (int width = 1; width <= 31; ++width) {
    for (int hole = 0; hole < 31; ++hole) {
      Image8 mask(31, 1, 1, 255);
      *mask.At(hole, 0) = 0;
      const Image8 reduced = ResizeMask(mask, width, 1);
      for (int x = 0; x < width; ++x) {
        const bool touches = x * 31 < (hole + 1) * width && (x + 1) * 31 > hole * width;
        ASSERT_EQ(*reduced.At(x, 0) == 0, touches) << "width " << width << ", hole " << hole << ", x " << x;
      }
    }
  }
}

TEST(ScaledHeight, KeepsTheAspectRatio) {
  EXPECT_EQ(ScaledHeight(4000, 3000, 1000), 750);
  EXPECT_EQ(ScaledHeight(4000, 3000, 4000), 3000);
  EXPECT_EQ(ScaledHeight(5472, 3648, 1000), 667);
  EXPECT_EQ(ScaledHeight(10000, 1, 10), 1);
  EXPECT_THROW(ScaledHeight(0, 1, 10), std::logic_error);
}

TEST(ToImage8, RoundsClampsAndSurvivesNan) {
  ImageF image(6, 1, 1);
  image.data = {-1.0F, 0.0F, 0.5F, 1.0F, 7.0F, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_EQ(ToImage8(image).data, (std::vector<uint8_t>{0, 0, 128, 255, 255, 0}));
}

TEST(ToImage8, InvertsToImageF) {
  Image8 image(256, 1, 1);
  for (size_t i = 0; i < 256; ++i) image.data[i] = static_cast<uint8_t>(i);
  EXPECT_EQ(ToImage8(ToImageF(image)).data, image.data);
}

TEST(Colorize, RunsFromDarkToBrightAndMarksGaps) {
  ImageF values(5, 1, 1);
  values.data = {-5.0F, 0.0F, 10.0F, 50.0F, std::numeric_limits<float>::infinity()};
  const Image8 colours = Colorize(values, 0.0F, 10.0F);
  const auto sum = [&](int x) { return colours.At(x, 0)[0] + colours.At(x, 0)[1] + colours.At(x, 0)[2]; };
  EXPECT_EQ(sum(0), sum(1));  // clamped
  EXPECT_EQ(sum(2), sum(3));
  EXPECT_GT(sum(2), sum(1));
  EXPECT_GT(sum(1), 0);
  EXPECT_EQ(sum(4), 0);
  // Viridis ends in yellow: red and green high, blue low.
  EXPECT_GT(colours.At(2, 0)[0], 200);
  EXPECT_GT(colours.At(2, 0)[1], 200);
  EXPECT_LT(colours.At(2, 0)[2], 100);
}

TEST(SavePng, ComesBackUnchanged) {
  const TemporaryFolder folder;
  SavePng(Pattern(33, 21), folder.path() / "a.png");
  EXPECT_EQ(LoadRgb8(folder.path() / "a.png").data, Pattern(33, 21).data);
  Image8 mask(3, 1, 1);
  mask.data = {0, 255, 0};
  SavePng(mask, folder.path() / "mask.png");
  EXPECT_EQ(LoadMask(folder.path() / "mask.png").data, mask.data);
}

TEST(SaveJpeg, KeepsColoursInTheirChannels) {
  const TemporaryFolder folder;
  Image8 image(64, 64, 3);
  for (size_t i = 0; i < image.data.size(); i += 3) image.data[i] = 220;  // red
  SaveJpeg(image, folder.path() / "red.jpg", 95);
  const Image8 loaded = LoadRgb8(folder.path() / "red.jpg");
  EXPECT_NEAR(loaded.At(30, 30)[0], 220, 4);
  EXPECT_NEAR(loaded.At(30, 30)[2], 0, 4);
}

TEST(Save, ToAMissingFolderNamesTheFile) {
  const TemporaryFolder folder;
  EXPECT_NE(InputErrorOf([&] { SavePng(Pattern(4, 4), folder.path() / "absent/a.png"); }).find("a.png"), std::string::npos);
}

TEST(Save, RefusesUnsupportedShapes) {
  const TemporaryFolder folder;
  EXPECT_THROW(SavePng(Image8(), folder.path() / "a.png"), std::logic_error);
  EXPECT_THROW(SavePng(Image8(4, 4, 2), folder.path() / "a.png"), std::logic_error);
  EXPECT_THROW(SaveFloatTiff(ImageF(4, 4, 3), folder.path() / "a.tif"), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::image
