// Means of squares of photo pixels in linear light, from which rays of reduced photos get their colour.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/image/image.h"
#include "core/image/pixel_cache.h"
#include "core/image/srgb.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::image {
namespace {

constexpr int kWidth = 37, kHeight = 29;  // no multiples of the squares
constexpr size_t kOpen = 0, kMasked = 1;  // photos without and with a mask

// IEC 61966-2-1.
double Light(uint8_t value) {
  const double srgb = value / 255.0;
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

class MeanLightTest : public testing::Test {
 protected:
  void SetUp() override {
    base::Progress::SetQuiet(true);
    base::Random random(21);
    std::vector<PixelSource> sources;
    for (const size_t photo : {kOpen, kMasked}) {
      const std::filesystem::path file = folder_.path() / ("photo" + std::to_string(photo) + ".png");
      for (uint8_t& value : photos_[photo].data) value = static_cast<uint8_t>(random.Below(256));
      SavePng(photos_[photo], file);
      sources.push_back({file, {}});
    }
    // Dense holes on the left, few on the right; the top left corner is whole.
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float holes = x < 8 && y < 8 ? 0.0F : x < kWidth / 2 ? 0.5F : 0.1F;
        if (random.Uniform() < holes) *mask_.At(x, y) = 0;
      }
    }
    sources[kMasked].mask = folder_.path() / "mask.png";
    SavePng(mask_, sources[kMasked].mask);
    base::ThreadPool threads(1);
    cache_ = std::make_unique<PixelCache>(PixelCache::Open(folder_.path() / "pixels.cache", sources, 0, threads));
    ASSERT_EQ(cache_->Width(kOpen), kWidth);
    ASSERT_EQ(cache_->Height(kOpen), kHeight);
  }
  void TearDown() override { base::Progress::SetQuiet(false); }

  // The pixels of a square that count, and the mean of their light.
  struct Plain {
    int counted = 0;
    double light[3] = {0.0, 0.0, 0.0};
  };
  Plain PlainMean(size_t photo, int x, int y, int size) {
    Plain plain;
    for (int row = y; row < y + size; ++row) {
      for (int column = x; column < x + size; ++column) {
        if (photo == kMasked && *mask_.At(column, row) == 0) continue;
        ++plain.counted;
        for (int c = 0; c < 3; ++c) plain.light[c] += Light(photos_[photo].At(column, row)[c]);
      }
    }
    for (double& light : plain.light) light /= plain.counted;
    return plain;
  }
  void ExpectPlainMean(size_t photo, int x, int y, int size) {
    const Plain plain = PlainMean(photo, x, y, size);
    float light[3] = {-1.0F, -1.0F, -1.0F};
    const bool enough = cache_->MeanLight(photo, x, y, size, light);
    ASSERT_EQ(enough, 2 * plain.counted >= size * size) << photo << " " << x << " " << y << " " << size;
    (enough ? kept_ : refused_) += 1;
    for (size_t c = 0; c < 3 && enough; ++c) ASSERT_NEAR(static_cast<double>(light[c]), plain.light[c], 3e-6) << x << " " << y << " " << size;
  }

  TemporaryFolder folder_;
  Image8 photos_[2] = {Image8(kWidth, kHeight, 3), Image8(kWidth, kHeight, 3)};
  Image8 mask_ = Image8(kWidth, kHeight, 1, 255);
  std::unique_ptr<PixelCache> cache_;
  int kept_ = 0, refused_ = 0;
};

TEST_F(MeanLightTest, IsThePlainMeanOfEverySquareUpToTheBorders) {
  for (const int size : {1, 2, 3, 4, 8}) {
    for (int y = 0; y + size <= kHeight; ++y) {
      for (int x = 0; x + size <= kWidth; ++x) ExpectPlainMean(kOpen, x, y, size);
    }
  }
  EXPECT_EQ(refused_, 0);
}

TEST_F(MeanLightTest, LeavesOutMaskedPixelsAndRefusesSquaresThatAreMostlyMasked) {
  for (const bool streaming : {false, true}) {
    cache_->Stream(streaming);
    kept_ = refused_ = 0;
    for (const int size : {1, 2, 4, 8}) {
      for (int y = 0; y + size <= kHeight; ++y) {
        for (int x = 0; x + size <= kWidth; ++x) ExpectPlainMean(kMasked, x, y, size);
      }
    }
    EXPECT_GT(kept_, 1000);
    EXPECT_GT(refused_, 300);
  }
}

TEST_F(MeanLightTest, OfOnePixelIsThePixel) {
  for (size_t pixel = 0; pixel < size_t{kWidth} * kHeight; ++pixel) {
    uint8_t rgb[3];
    float light[3];
    const bool counts = cache_->Pixel(kMasked, pixel, rgb);
    ASSERT_EQ(cache_->MeanLight(kMasked, static_cast<int>(pixel) % kWidth, static_cast<int>(pixel) / kWidth, 1, light), counts);
    for (size_t c = 0; c < 3 && counts; ++c) EXPECT_EQ(light[c], LinearFromSrgb(static_cast<float>(rgb[c]) / 255.0F));
  }
}

// Averaging display values instead would make the squares of a checkerboard too dark.
TEST_F(MeanLightTest, OfBlackAndWhiteIsHalfTheLight) {
  Image8 board(8, 8, 3);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int c = 0; c < 3; ++c) board.At(x, y)[c] = (x + y) % 2 == 0 ? 255 : 0;
    }
  }
  SavePng(board, folder_.path() / "board.png");
  base::ThreadPool threads(1);
  const PixelCache cache = PixelCache::Open(folder_.path() / "board.cache", {{folder_.path() / "board.png", {}}}, 0, threads);
  for (const int size : {2, 4, 8}) {
    float light[3];
    ASSERT_TRUE(cache.MeanLight(0, 0, 0, size, light));
    for (const float value : light) EXPECT_FLOAT_EQ(value, 0.5F);
  }
}

}  // namespace
}  // namespace skyquilt::image
