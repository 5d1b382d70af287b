#include "core/metrics/ssim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/random.h"

namespace skyquilt::metrics {
namespace {

using image::Image8;
using image::ImageF;

// SSIM by its definition, window by window in long double: weighted means, then weighted moments about them.
double NaiveSsimAt(const ImageF& a, const ImageF& b, const Image8* mask, int x, int y, int channel) {
  long double weight_sum = 0.0L;
  long double mean_a = 0.0L;
  long double mean_b = 0.0L;
  const auto weight_at = [&](int dx, int dy) {
    if (mask != nullptr && *mask->At(x + dx, y + dy) == 0) return 0.0L;
    return std::exp(-static_cast<long double>(dx * dx + dy * dy) / (2.0L * 1.5L * 1.5L));
  };
  for (int dy = -5; dy <= 5; ++dy) {
    for (int dx = -5; dx <= 5; ++dx) {
      const long double weight = weight_at(dx, dy);
      if (weight == 0.0L) continue;
      weight_sum += weight;
      mean_a += weight * static_cast<long double>(a.At(x + dx, y + dy)[channel]);
      mean_b += weight * static_cast<long double>(b.At(x + dx, y + dy)[channel]);
    }
  }
  mean_a /= weight_sum;
  mean_b /= weight_sum;
  long double variance_a = 0.0L;
  long double variance_b = 0.0L;
  long double covariance = 0.0L;
  for (int dy = -5; dy <= 5; ++dy) {
    for (int dx = -5; dx <= 5; ++dx) {
      const long double weight = weight_at(dx, dy) / weight_sum;
      if (weight == 0.0L) continue;
      const long double da = static_cast<long double>(a.At(x + dx, y + dy)[channel]) - mean_a;
      const long double db = static_cast<long double>(b.At(x + dx, y + dy)[channel]) - mean_b;
      variance_a += weight * da * da;
      variance_b += weight * db * db;
      covariance += weight * da * db;
    }
  }
  const long double c1 = 0.0001L;
  const long double c2 = 0.0009L;
  return static_cast<double>((2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
                             ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2)));
}

double NaiveSsim(const ImageF& a, const ImageF& b, const Image8* mask) {
  double sum = 0.0;
  int n = 0;
  for (int y = 5; y < a.height - 5; ++y) {
    for (int x = 5; x < a.width - 5; ++x) {
      if (mask != nullptr && *mask->At(x, y) == 0) continue;
      for (int c = 0; c < a.channels; ++c) sum += NaiveSsimAt(a, b, mask, x, y, c) / a.channels;
      ++n;
    }
  }
  return sum / n;
}

ImageF Textured(int width, int height, uint64_t seed) {
  base::Random random(seed);
  ImageF image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c)
        image.At(x, y)[c] =
            0.5F + 0.3F * std::sin(0.4F * static_cast<float>(x + c) + 0.2F * static_cast<float>(y)) + 0.2F * (random.Uniform() - 0.5F);
    }
  }
  return image;
}

TEST(Ssim, AgreesWithTheDefinition) {
  for (const auto& [width, height] : {std::pair{11, 11}, std::pair{12, 40}, std::pair{35, 23}}) {
    const ImageF a = Textured(width, height, 1);
    const ImageF b = Textured(width, height, 2);
    EXPECT_NEAR(Ssim(a, b, nullptr), NaiveSsim(a, b, nullptr), 1e-11) << width << "x" << height;
  }
}

TEST(Ssim, AgreesWithTheDefinitionUnderAMask) {
  const ImageF a = Textured(40, 30, 3);
  ImageF b = Textured(40, 30, 4);
  Image8 mask(40, 30, 1, 255);
  base::Random random(5);
  for (uint8_t& use : mask.data) use = random.Below(4) == 0 ? 0 : 1;
  EXPECT_NEAR(Ssim(a, b, &mask), NaiveSsim(a, b, &mask), 1e-11);
  // Ignored pixels have no influence, not even NaN.
  const double before = Ssim(a, b, &mask);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (*mask.At(x, y) == 0) b.At(x, y)[1] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  EXPECT_EQ(Ssim(a, b, &mask), before);
}

// Golden figure: structural_similarity of scikit-image 0.19.3 with gaussian_weights, sigma 1.5 and use_sample_covariance=False on the same pictures,
// by scripts/compare_ssim.py, which has the figures of other variants, too. Ours are floats of 24 bits, its are doubles.
TEST(Ssim, IsThatOfScikitImageWithWangsSettings) {
  constexpr int kWidth = 64, kHeight = 48;
  const auto picture = [](uint32_t state, bool blurred) {
    Image8 pixels(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int c = 0; c < 3; ++c) {
          state = state * 1664525U + 1013904223U;
          const int wave = std::abs((x + 2 * y + 5 * c) % 32 - 16) + (blurred ? 0 : (x * y + 3 * c) % 7);
          pixels.At(x, y)[c] = static_cast<uint8_t>(40 + 9 * wave + static_cast<int>(state >> 28U));
        }
      }
    }
    return image::ToImageF(pixels);
  };
  EXPECT_NEAR(Ssim(picture(1, false), picture(2, true), nullptr), 0.7490439948, 1e-7);
}

// For flat images the closed form is the luminance term alone: (2ab + C1) / (a^2 + b^2 + C1).
TEST(Ssim, HasTheClosedFormOfFlatImages) {
  const double a = 0.25;
  const double b = 0.75;
  const double expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4);  // 0.60006...
  EXPECT_NEAR(Ssim(ImageF(20, 20, 3, 0.25F), ImageF(20, 20, 3, 0.75F), nullptr), expected, 1e-12);
  EXPECT_NEAR(Ssim(ImageF(20, 20, 3, 0.0F), ImageF(20, 20, 3, 1.0F), nullptr), 1e-4 / (1.0 + 1e-4), 1e-12);
}

// An image against its negative about 1/2 with equal means 1/2: SSIM = (C2 - 2 v) / (C2 + 2 v), v the window variance of the checkerboard.
TEST(Ssim, IsNegativeForTheNegative) {
  ImageF a(31, 31, 1);
  ImageF b(31, 31, 1);
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 31; ++x) {
      *a.At(x, y) = (x + y) % 2 == 0 ? 0.75F : 0.25F;
      *b.At(x, y) = 1.0F - *a.At(x, y);
    }
  }
  const double v = 0.0625;
  EXPECT_NEAR(Ssim(a, b, nullptr), (9e-4 - 2 * v) / (9e-4 + 2 * v), 1e-6);
}

TEST(Ssim, IsOneForIdenticalImagesAndSymmetric) {
  const ImageF a = Textured(25, 25, 6);
  const ImageF b = Textured(25, 25, 7);
  EXPECT_NEAR(Ssim(a, a, nullptr), 1.0, 1e-12);
  EXPECT_NEAR(Ssim(a, b, nullptr), Ssim(b, a, nullptr), 1e-14);
  EXPECT_LT(Ssim(a, b, nullptr), 1.0);
}

TEST(Ssim, MapHoldsTheScoresAndItsMeanIsTheResult) {
  const ImageF a = Textured(20, 16, 8);
  const ImageF b = Textured(20, 16, 9);
  Image8 mask(20, 16, 1, 255);
  *mask.At(9, 8) = 0;
  ImageF map;
  const double mean = Ssim(a, b, &mask, &map);
  double sum = 0.0;
  int n = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool scored = x >= 5 && x < 15 && y >= 5 && y < 11 && !(x == 9 && y == 8);
      ASSERT_EQ(std::isfinite(*map.At(x, y)), scored) << x << ", " << y;
      if (!scored) continue;
      sum += static_cast<double>(*map.At(x, y));
      ++n;
    }
  }
  EXPECT_EQ(n, 59);
  EXPECT_NEAR(mean, sum / n, 1e-6);
  EXPECT_NEAR(*map.At(6, 7), (NaiveSsimAt(a, b, &mask, 6, 7, 0) + NaiveSsimAt(a, b, &mask, 6, 7, 1) + NaiveSsimAt(a, b, &mask, 6, 7, 2)) / 3, 1e-6);
}

TEST(Ssim, OfTooLittleIsNotANumber) {
  EXPECT_TRUE(std::isnan(Ssim(ImageF(10, 50, 3, 0.5F), ImageF(10, 50, 3, 0.5F), nullptr)));
  const Image8 nothing(20, 20, 1, 0);
  EXPECT_TRUE(std::isnan(Ssim(ImageF(20, 20, 3, 0.5F), ImageF(20, 20, 3, 0.5F), &nothing)));
  EXPECT_TRUE(std::isnan(Ssim(ImageF(), ImageF(), nullptr)));
}

}  // namespace
}  // namespace skyquilt::metrics
