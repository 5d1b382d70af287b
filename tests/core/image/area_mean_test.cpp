#include "core/image/area_mean.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "core/image/draw_text.h"

namespace skyquilt::image {
namespace {

ImageF Numbered(int width, int height, int channels) {
  ImageF image(width, height, channels);
  std::iota(image.data.begin(), image.data.end(), 0.0F);
  return image;
}

TEST(AreaMean, AveragesWholeSquares) {
  const ImageF reduced = AreaMean(Numbered(4, 2, 1), 2, 1);  // 0 1 2 3 over 4 5 6 7
  ASSERT_EQ(reduced.width, 2);
  ASSERT_EQ(reduced.height, 1);
  EXPECT_FLOAT_EQ(reduced.data[0], 2.5F);
  EXPECT_FLOAT_EQ(reduced.data[1], 4.5F);
}

TEST(AreaMean, CountsPixelsByTheirShare) {
  const ImageF reduced = AreaMean(Numbered(3, 1, 1), 2, 1);  // 0 1 2: each half covers one and a half pixels
  EXPECT_FLOAT_EQ(reduced.data[0], (0.0F + 0.5F * 1.0F) / 1.5F);
  EXPECT_FLOAT_EQ(reduced.data[1], (0.5F * 1.0F + 2.0F) / 1.5F);
}

TEST(AreaMean, KeepsAnImageOfTheSameSize) {
  const ImageF image = Numbered(5, 3, 3);
  EXPECT_EQ(AreaMean(image, 5, 3).data, image.data);
  EXPECT_THROW(AreaMean(image, 6, 3), std::logic_error);
  EXPECT_THROW(AreaMean(image, 5, 0), std::logic_error);
}

RC_GTEST_PROP(AreaMean, KeepsTheMeanOfTheImage, ()) {
  const int width = *rc::gen::inRange(1, 24), height = *rc::gen::inRange(1, 24);
  const ImageF reduced = AreaMean(Numbered(width, height, 1), *rc::gen::inRange(1, width + 1), *rc::gen::inRange(1, height + 1));
  const double mean = std::accumulate(reduced.data.begin(), reduced.data.end(), 0.0) / static_cast<double>(reduced.data.size());
  RC_ASSERT(std::abs(mean - 0.5 * (width * height - 1)) < 1e-4 * width * height);
}

TEST(DrawText, StaysInItsBox) {
  Image8 image(200, 60, 3, 255);
  DrawText(&image, "Ag 1/8", 20, 40, 11.0);
  int dark = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (*image.At(x, y) > 128) continue;
      ++dark;
      EXPECT_TRUE(x >= 19 && x <= 20 + TextWidth("Ag 1/8", 11.0) && y >= 27 && y <= 46) << x << ' ' << y;
    }
  }
  EXPECT_GT(dark, 40);
}

}  // namespace
}  // namespace skyquilt::image
