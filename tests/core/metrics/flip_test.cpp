#include "core/metrics/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "tests/support/not_finite.h"

namespace skyquilt::metrics {
namespace {

using image::Image8;
using image::ImageF;

// The paper's formulas, one pixel at a time in double precision: two-dimensional filters and sums over their whole windows.
class NaiveFlip {
 public:
  NaiveFlip(const ImageF& a, const ImageF& b, const Image8* mask) : a_(a), b_(b), mask_(mask) {}

  double At(int x, int y) const {
    const Vec lab_a = SeenLab(a_, x, y), lab_b = SeenLab(b_, x, y);
    const double knee = 0.4 * Largest();
    const double error = std::pow(Distance(lab_a, lab_b), 0.7);
    const double color = error < knee ? 0.95 / knee * error : 0.95 + (error - knee) / (Largest() - knee) * 0.05;
    double feature = 0.0;
    for (const bool point : {false, true}) feature = std::max(feature, std::abs(Feature(a_, x, y, point) - Feature(b_, x, y, point)));
    return std::pow(color, 1.0 - std::sqrt(feature / std::numbers::sqrt2));
  }

 private:
  using Vec = std::array<double, 3>;
  static constexpr double kPi = std::numbers::pi;
  static constexpr double kPixelsPerDegree = 0.7 * 3840.0 / 0.7 * kPi / 180.0;

  static Vec Xyz(const Vec& rgb) {
    const auto [r, g, b] = rgb;
    return {(10135552.0 * r + 8788810.0 * g + 4435075.0 * b) / 24577794.0 / 0.950428545, (2613072.0 * r + 8788810.0 * g + 887015.0 * b) / 12288897.0,
            (1425312.0 * r + 8788810.0 * g + 70074185.0 * b) / 73733382.0 / 1.088900371};
  }

  Vec Opponent(const ImageF& image, int x, int y) const {
    x = std::clamp(x, 0, image.width - 1);
    y = std::clamp(y, 0, image.height - 1);
    Vec linear{};
    for (size_t c = 0; c < 3; ++c) {
      const double value = mask_ != nullptr && *mask_->At(x, y) == 0 ? 0.5 : static_cast<double>(image.At(x, y)[c]);
      linear[c] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    }
    const Vec xyz = Xyz(linear);
    return {116.0 * xyz[1] - 16.0, 500.0 * (xyz[0] - xyz[1]), 200.0 * (xyz[1] - xyz[2])};
  }

  Vec SeenLab(const ImageF& image, int x, int y) const {
    constexpr std::array<std::array<double, 4>, 3> kSensitivity = {{{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
    Vec sum{}, weights{};
    for (int dy = -10; dy <= 10; ++dy) {
      for (int dx = -10; dx <= 10; ++dx) {
        const Vec color = Opponent(image, x + dx, y + dy);
        const double d2 = (dx * dx + dy * dy) / (kPixelsPerDegree * kPixelsPerDegree);
        for (size_t c = 0; c < 3; ++c) {
          const auto& [a1, b1, a2, b2] = kSensitivity[c];
          const double weight = a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * d2 / b1) + a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * d2 / b2);
          sum[c] += weight * color[c];
          weights[c] += weight;
        }
      }
    }
    const double luminance = (sum[0] / weights[0] + 16.0) / 116.0;
    const double relative_x = luminance + sum[1] / weights[1] / 500.0;
    const double relative_z = luminance - sum[2] / weights[2] / 200.0;
    const double wx = relative_x * 0.950428545, wz = relative_z * 1.088900371;
    return HuntLab({std::clamp(3.241003275 * wx - 1.537398934 * luminance - 0.498615861 * wz, 0.0, 1.0),
                    std::clamp(-0.969224334 * wx + 1.875930071 * luminance + 0.041554224 * wz, 0.0, 1.0),
                    std::clamp(0.055639423 * wx - 0.204011202 * luminance + 1.057148933 * wz, 0.0, 1.0)});
  }

  static Vec HuntLab(const Vec& rgb_linear) {
    Vec f = Xyz(rgb_linear);
    for (double& t : f) t = t > 216.0 / 24389.0 ? std::cbrt(t) : t * 841.0 / 108.0 + 4.0 / 29.0;
    const double l = 116.0 * f[1] - 16.0;
    return {l, 5.0 * l * (f[0] - f[1]), 2.0 * l * (f[1] - f[2])};
  }

  static double Distance(const Vec& p, const Vec& q) { return std::abs(p[0] - q[0]) + std::hypot(p[1] - q[1], p[2] - q[2]); }
  static double Largest() { return std::pow(Distance(HuntLab({0.0, 1.0, 0.0}), HuntLab({0.0, 0.0, 1.0})), 0.7); }

  // Length of the response of the detectors along x and along y.
  double Feature(const ImageF& image, int x, int y, bool point) const {
    const double sigma = 0.5 * 0.082 * kPixelsPerDegree;
    constexpr int kRadius = 9;
    std::array<double, 2> positive{}, negative{};
    double positive_sum = 0.0, negative_sum = 0.0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        const double bell = std::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma));
        const double weight = (point ? dx * dx / (sigma * sigma) - 1.0 : -dx) * bell;
        const double along_x = (Opponent(image, x + dx, y + dy)[0] + 16.0) / 116.0, along_y = (Opponent(image, x + dy, y + dx)[0] + 16.0) / 116.0;
        (weight > 0.0 ? positive_sum : negative_sum) += std::abs(weight);
        (weight > 0.0 ? positive : negative)[0] += weight * along_x;
        (weight > 0.0 ? positive : negative)[1] += weight * along_y;
      }
    }
    return std::hypot(positive[0] / positive_sum + negative[0] / negative_sum, positive[1] / positive_sum + negative[1] / negative_sum);
  }

  const ImageF& a_;
  const ImageF& b_;
  const Image8* mask_;
};

// Waves of 9 to 40 pixels with a coarse grid of squares; `shift` moves them, `variant` changes the colours.
ImageF Pattern(int width, int height, int shift, int variant) {
  ImageF image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int square = ((x + shift) / 8 + y / 6) % 3;
      for (int c = 0; c < 3; ++c) {
        const int level = (7 * (x + shift) + 5 * y * (c + 1) + 40 * square * (c + variant + 1)) % 256;
        image.At(x, y)[c] = static_cast<float>(level) / 255.0F;
      }
    }
  }
  return image;
}

ImageF Flat(int width, int height, const std::array<float, 3>& rgb) {
  ImageF image(width, height, 3);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = rgb[i % 3];
  return image;
}

class FlipTest : public testing::Test {
 protected:
  base::ThreadPool threads_{2};
  double Of(const ImageF& a, const ImageF& b, const Image8* mask = nullptr, ImageF* map = nullptr) { return Flip(a, b, mask, threads_, map); }
};

TEST_F(FlipTest, AgreesWithTheFormulas) {
  // 70 rows: two bands.
  const ImageF a = Pattern(31, 70, 0, 0), b = Pattern(31, 70, 3, 1);
  ImageF map;
  const double mean = Of(a, b, nullptr, &map);
  const NaiveFlip naive(a, b, nullptr);
  double sum = 0.0;
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 31; ++x) {
      const double expected = naive.At(x, y);
      ASSERT_NEAR(*map.At(x, y), expected, 2e-4) << x << ", " << y;
      sum += expected;
    }
  }
  EXPECT_NEAR(mean, sum / (31 * 70), 1e-5);
}

TEST_F(FlipTest, IgnoredPixelsAreGreyInBothImages) {
  const ImageF a = Pattern(24, 20, 0, 0);
  ImageF b = Pattern(24, 20, 5, 0);
  Image8 mask(24, 20, 1, 1);
  base::Random random(3);
  for (uint8_t& use : mask.data) use = random.Below(3) == 0 ? 0 : 1;
  ImageF map;
  const double mean = Of(a, b, &mask, &map);
  const NaiveFlip naive(a, b, &mask);
  double sum = 0.0;
  int n = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      ASSERT_EQ(std::isnan(*map.At(x, y)), *mask.At(x, y) == 0);
      if (*mask.At(x, y) == 0) continue;
      ASSERT_NEAR(*map.At(x, y), naive.At(x, y), 2e-4) << x << ", " << y;
      sum += static_cast<double>(*map.At(x, y));
      ++n;
    }
  }
  EXPECT_NEAR(mean, sum / n, 1e-12);
  // They have no influence, not even NaN.
  for (size_t i = 0; i < mask.data.size(); ++i) {
    if (mask.data[i] == 0) b.data[3 * i + 1] = kNanFloat;
  }
  EXPECT_EQ(Of(a, b, &mask), mean);
  EXPECT_TRUE(std::isnan(Of(a, b)));
}

// Computed with the authors' FLIP.h (github.com/NVlabs/flip, commit 1eb247c, CPU, 67.0206 pixels per degree, images in linear light), printed with
// seven digits. That code works in single precision too, with other orders of sums and without separating the filters.
TEST_F(FlipTest, AgreesWithTheAuthorsProgram) {
  const auto expect = [&](const ImageF& a, const ImageF& b, double mean, double at_5_7, double at_20_11) {
    ImageF map;
    EXPECT_NEAR(Of(a, b, nullptr, &map), mean, 2e-5);
    EXPECT_NEAR(*map.At(5, 7), at_5_7, 2e-4);
    EXPECT_NEAR(*map.At(20, 11), at_20_11, 2e-4);
  };
  expect(Pattern(64, 48, 0, 0), Pattern(64, 48, 3, 0), 0.6250105, 0.839830, 0.707826);
  expect(Pattern(64, 48, 0, 0), Pattern(64, 48, 0, 1), 0.6512482, 0.799109, 0.484766);
  expect(ImageF(24, 24, 3, 0.0F), ImageF(24, 24, 3, 1.0F), 0.9673883, 0.967388, 0.967388);
  expect(Flat(24, 24, {0.2F, 0.4F, 0.6F}), Flat(24, 24, {0.25F, 0.4F, 0.55F}), 0.1333695, 0.133369, 0.133369);
  expect(Flat(24, 24, {0.0F, 1.0F, 0.0F}), Flat(24, 24, {0.0F, 0.0F, 1.0F}), 1.0, 1.0, 1.0);  // the largest difference of two colours
  ImageF line(40, 30, 3, 0.5F);
  for (int y = 0; y < 30; ++y) std::fill_n(line.At(20, y), 3, 0.9F);
  expect(ImageF(40, 30, 3, 0.5F), line, 0.0555898, 0.0, 0.588954);
}

TEST_F(FlipTest, IsZeroForIdenticalImages) {
  const ImageF a = Pattern(40, 30, 0, 0);
  EXPECT_EQ(Of(a, a), 0.0);
}

TEST_F(FlipTest, IsSymmetric) {
  const ImageF a = Pattern(40, 30, 0, 0), b = Pattern(40, 30, 2, 1);
  EXPECT_EQ(Of(a, b), Of(b, a));
}

TEST_F(FlipTest, GrowsWithTheDifferenceAndStaysBelowOne) {
  const ImageF a = Pattern(40, 30, 0, 0), other = Pattern(40, 30, 4, 1);
  double before = 0.0;
  for (const float share : {0.1F, 0.3F, 0.6F, 1.0F}) {
    ImageF b = a;
    for (size_t i = 0; i < b.data.size(); ++i) b.data[i] += share * (other.data[i] - a.data[i]);
    const double error = Of(a, b);
    EXPECT_GT(error, before) << share;
    before = error;
  }
  EXPECT_LE(before, 1.0);
}

// Far from the eye's resolution a fine pattern looks like its mean light.
TEST_F(FlipTest, HardlySeesAFineCheckerboard) {
  ImageF fine(48, 48, 3), coarse(48, 48, 3);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      for (int c = 0; c < 3; ++c) {
        fine.At(x, y)[c] = (x + y) % 2 == 0 ? 0.55F : 0.45F;
        coarse.At(x, y)[c] = (x / 12 + y / 12) % 2 == 0 ? 0.55F : 0.45F;
      }
    }
  }
  const ImageF grey(48, 48, 3, 0.5F);
  EXPECT_LT(Of(grey, fine), 0.3 * Of(grey, coarse));
}

TEST_F(FlipTest, ClampsToTheDisplay) {
  EXPECT_EQ(Of(ImageF(16, 16, 3, 1.5F), ImageF(16, 16, 3, -0.5F)), Of(ImageF(16, 16, 3, 1.0F), ImageF(16, 16, 3, 0.0F)));
}

TEST_F(FlipTest, HasTheSameBitsForAnyNumberOfThreads) {
  const ImageF a = Pattern(50, 300, 0, 0), b = Pattern(50, 300, 1, 0);
  base::ThreadPool one(1), five(5);
  ImageF map_one, map_five;
  EXPECT_EQ(Flip(a, b, nullptr, one, &map_one), Flip(a, b, nullptr, five, &map_five));
  EXPECT_EQ(map_one.data, map_five.data);
}

TEST_F(FlipTest, OfNothingIsNotANumber) {
  EXPECT_TRUE(std::isnan(Of(ImageF(), ImageF())));
  const Image8 nothing(9, 9, 1, 0);
  EXPECT_TRUE(std::isnan(Of(ImageF(9, 9, 3, 0.1F), ImageF(9, 9, 3, 0.9F), &nothing)));
}

TEST_F(FlipTest, RefusesShapesThatDiffer) {
  EXPECT_THROW(Of(ImageF(4, 4, 3), ImageF(4, 5, 3)), std::logic_error);
  EXPECT_THROW(Of(ImageF(4, 4, 1), ImageF(4, 4, 1)), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::metrics
