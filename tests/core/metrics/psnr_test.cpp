#include "core/metrics/psnr.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace skyquilt::metrics {
namespace {

using image::Image8;
using image::ImageF;

TEST(Psnr, IsTwentyDecibelsForAnErrorOfATenth) {
  const ImageF a(7, 5, 3, 0.5F);
  const ImageF b(7, 5, 3, 0.6F);
  EXPECT_NEAR(Psnr(a, b, nullptr), 20.0, 1e-5);  // 10 log10(1 / 0.1^2)
  EXPECT_NEAR(Psnr(ImageF(4, 4, 3, 0.0F), ImageF(4, 4, 3, 1.0F), nullptr), 0.0, 1e-12);
}

TEST(Psnr, IsInfiniteForIdenticalImages) {
  const ImageF a(3, 3, 3, 0.2F);
  EXPECT_EQ(Psnr(a, a, nullptr), std::numeric_limits<double>::infinity());
}

TEST(Psnr, IgnoresWhatTheMaskIgnores) {
  ImageF a(4, 1, 3, 0.5F);
  const ImageF b(4, 1, 3, 0.4F);
  for (int c = 0; c < 3; ++c) a.At(2, 0)[c] = std::numeric_limits<float>::quiet_NaN();
  Image8 mask(4, 1, 1, 255);
  *mask.At(2, 0) = 0;
  const Image8 nothing(4, 1, 1, 0);
  EXPECT_NEAR(Psnr(a, b, &mask), 20.0, 1e-5);
  EXPECT_TRUE(std::isnan(Psnr(a, b, nullptr)));
  EXPECT_TRUE(std::isnan(Psnr(a, b, &nothing)));
}

TEST(Psnr, OfTwoPhotosTogetherWeighsByPixels) {
  const ImageF dark(10, 1, 1, 0.0F);
  SquaredError sum = SumSquaredError(dark, ImageF(10, 1, 1, 0.1F), nullptr);
  sum += SumSquaredError(ImageF(30, 1, 1, 0.0F), ImageF(30, 1, 1, 0.3F), nullptr);
  EXPECT_EQ(sum.n_values, 40);
  EXPECT_NEAR(PsnrOf(sum), -10.0 * std::log10((10 * 0.01 + 30 * 0.09) / 40), 1e-5);
}

TEST(Psnr, RefusesShapesThatDiffer) {
  EXPECT_THROW(Psnr(ImageF(2, 3, 3), ImageF(3, 2, 3), nullptr), std::logic_error);
  const Image8 mask(3, 3, 1);
  EXPECT_THROW(Psnr(ImageF(2, 3, 3), ImageF(2, 3, 3), &mask), std::logic_error);
}

TEST(Psnr, OfNothingIsNotANumber) {
  EXPECT_TRUE(std::isnan(Psnr(ImageF(), ImageF(), nullptr)));
}

}  // namespace
}  // namespace skyquilt::metrics
