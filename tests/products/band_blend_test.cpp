#include "products/photo_map/band_blend.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace skyquilt::products {
namespace {

image::ImageF NoisePicture(int width, int height, uint32_t seed) {
  std::mt19937 random(seed);
  image::ImageF picture(width, height, 3);
  for (float& value : picture.data) value = static_cast<float>(random() % 1000) / 999.0F;
  return picture;
}

image::ImageF EvenPicture(int width, int height, float value) {
  return image::ImageF(width, height, 3, value);
}

// Single pixels of `dark` and `bright` by turns; phase 0 begins with a dark one.
image::ImageF Checkerboard(int width, int height, int phase, float dark, float bright) {
  image::ImageF picture(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) std::fill_n(picture.At(x, y), 3, (x + y + phase) % 2 == 0 ? dark : bright);
  }
  return picture;
}

// 1 in the columns [begin, end), else 0.
std::vector<float> ColumnMask(int width, int height, int begin, int end) {
  std::vector<float> mask;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mask.push_back(x >= begin && x < end ? 1.0F : 0.0F);
  }
  return mask;
}

std::vector<float> Complement(const std::vector<float>& mask) {
  std::vector<float> rest;
  for (const float value : mask) rest.push_back(1.0F - value);
  return rest;
}

float LargestDifference(const image::ImageF& a, const image::ImageF& b) {
  if (a.data.size() != b.data.size()) return std::numeric_limits<float>::infinity();
  float largest = 0.0F;
  for (size_t i = 0; i < a.data.size(); ++i) {
    const float difference = std::abs(a.data[i] - b.data[i]);
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

RC_GTEST_PROP(BandBlender, GivesASingleLayerBack, ()) {
  const int width = *rc::gen::inRange(1, 70);
  const int height = *rc::gen::inRange(1, 70);
  const image::ImageF picture = NoisePicture(width, height, *rc::gen::arbitrary<uint32_t>());
  BandBlender blender(width, height, *rc::gen::inRange(0, 8));
  blender.Add(picture, std::vector<float>(picture.data.size() / 3, 1.0F));
  RC_ASSERT(LargestDifference(blender.Finish(), picture) < 1e-5F);
}

RC_GTEST_PROP(BandBlender, GivesEqualLayersBackForAnyMasks, ()) {
  const int width = *rc::gen::inRange(1, 70);
  const int height = *rc::gen::inRange(1, 70);
  const uint32_t seed = *rc::gen::arbitrary<uint32_t>();
  const image::ImageF picture = NoisePicture(width, height, seed);
  std::mt19937 random(seed + 1);
  std::vector<float> mask;
  for (size_t i = 0; i < picture.data.size() / 3; ++i) mask.push_back(std::clamp(static_cast<float>(random() % 300) / 100.0F - 1.0F, 0.0F, 1.0F));
  BandBlender blender(width, height, *rc::gen::inRange(0, 6));
  blender.Add(picture, mask);
  blender.Add(picture, Complement(mask));
  RC_ASSERT(LargestDifference(blender.Finish(), picture) < 1e-4F);
}

TEST(BandBlender, KeepsAPictureWhereItIsWantedBesideNothing) {
  const image::ImageF picture = NoisePicture(90, 40, 4);
  BandBlender blender(90, 40, 4);
  blender.Add(picture, ColumnMask(90, 40, 0, 37));
  const image::ImageF blended = blender.Finish();
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 90; ++x) {
      ASSERT_TRUE(std::isfinite(*blended.At(x, y)));
      if (x < 37) ASSERT_NEAR(*blended.At(x, y), *picture.At(x, y), 1e-4F);
    }
  }
}

RC_GTEST_PROP(BandBlender, FadesBetweenTwoLights, ()) {
  const int levels = *rc::gen::inRange(0, 4);
  const int seam = *rc::gen::inRange(70, 120);
  const int width = 190;
  const int height = 20;
  BandBlender blender(width, height, levels);
  RC_ASSERT(blender.levels() == levels);
  const std::vector<float> mask = ColumnMask(width, height, 0, seam);
  blender.Add(EvenPicture(width, height, 0.2F), mask);
  blender.Add(EvenPicture(width, height, 0.7F), Complement(mask));
  const image::ImageF blended = blender.Finish();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = *blended.At(x, y);
      if (x > 0) RC_ASSERT(value >= *blended.At(x - 1, y) - 1e-6F);
      const float away = std::abs(static_cast<float>(x) + 0.5F - static_cast<float>(seam));
      const float there = x < seam ? 0.2F : 0.7F;
      if (away > static_cast<float>(2 << levels)) RC_ASSERT(std::abs(value - there) < 0.01F);
      if (away > static_cast<float>(4 << levels)) RC_ASSERT(std::abs(value - there) < 1e-5F);
    }
  }
}

TEST(BandBlender, DoesNotMixDetail) {
  const int width = 160;
  const int height = 64;
  const image::ImageF left = Checkerboard(width, height, 0, 0.3F, 0.7F);
  const image::ImageF right = Checkerboard(width, height, 1, 0.4F, 0.6F);
  BandBlender blender(width, height, 4);
  const std::vector<float> mask = ColumnMask(width, height, 0, 81);
  blender.Add(left, mask);
  blender.Add(right, Complement(mask));
  const image::ImageF blended = blender.Finish();
  for (int y = 16; y < height - 16; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x >= 79 && x < 83) continue;
      ASSERT_NEAR(*blended.At(x, y), *(x < 81 ? left : right).At(x, y), 2e-3F) << x << " " << y;
    }
  }
}

RC_GTEST_PROP(BandBlender, BlendsAPartAsItDoesTheWhole, ()) {
  const int width = 131;
  const int height = 121;
  const int levels = 3;
  const uint32_t seed = *rc::gen::arbitrary<uint32_t>();
  const image::ImageF below = NoisePicture(width, height, seed);
  const image::ImageF above = NoisePicture(width, height, seed + 1);
  const int begin_x = *rc::gen::inRange(0, 90);
  const int begin_y = *rc::gen::inRange(0, 80);
  const int end_x = std::min(begin_x + *rc::gen::inRange(1, 40), width);
  const int end_y = std::min(begin_y + *rc::gen::inRange(1, 40), height);
  std::vector<float> mask(below.data.size() / 3, 0.0F);
  for (int y = begin_y; y < end_y; ++y) std::fill_n(mask.begin() + y * width + begin_x, end_x - begin_x, 1.0F);

  BandBlender whole(width, height, levels);
  whole.Add(below, Complement(mask));
  whole.Add(above, mask);
  const image::ImageF expected = whole.Finish();

  const int margin = 4 << levels;
  const int x0 = std::max(begin_x - margin, 0) >> levels << levels;
  const int y0 = std::max(begin_y - margin, 0) >> levels << levels;
  image::ImageF part(std::min(end_x + margin, width) - x0, std::min(end_y + margin, height) - y0, 3);
  std::vector<float> part_mask;
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(above.At(x0, y0 + y), 3 * part.width, part.At(0, y));
    const auto row = mask.begin() + (y0 + y) * width + x0;
    part_mask.insert(part_mask.end(), row, row + part.width);
  }
  BandBlender parts(width, height, levels);
  parts.Add(part, part_mask, x0, y0);
  parts.Add(below, Complement(mask));
  RC_ASSERT(LargestDifference(parts.Finish(), expected) < 1e-5F);
}

TEST(BandBlender, HardlyDependsOnPixelsFarFromTheMask) {
  const int width = 160;
  const int height = 20;
  const int levels = 3;
  const int seam = 64;
  image::ImageF left = EvenPicture(width, height, 0.5F);
  for (int y = 0; y < height; ++y) {
    for (int x = seam + (2 << levels); x < width; ++x) std::fill_n(left.At(x, y), 3, std::numeric_limits<float>::quiet_NaN());
  }
  const std::vector<float> mask = ColumnMask(width, height, 0, seam);
  BandBlender blender(width, height, levels);
  blender.Add(left, mask);
  blender.Add(EvenPicture(width, height, 0.5F), Complement(mask));
  EXPECT_LT(LargestDifference(blender.Finish(), EvenPicture(width, height, 0.5F)), 1e-5F);

  for (float& value : left.data) value = std::isfinite(value) ? value : 1.0F;
  BandBlender wrong(width, height, levels);
  wrong.Add(left, mask);
  wrong.Add(EvenPicture(width, height, 0.5F), Complement(mask));
  EXPECT_LT(LargestDifference(wrong.Finish(), EvenPicture(width, height, 0.5F)), 0.01F);
}

TEST(BandBlender, RefusesWrongShapes) {
  BandBlender blender(64, 64, 3);
  const std::vector<float> mask(16 * 16, 1.0F);
  EXPECT_THROW(blender.Add(EvenPicture(16, 16, 0.5F), mask, 4, 0), std::logic_error);
  EXPECT_THROW(blender.Add(EvenPicture(16, 16, 0.5F), mask, 0, 56), std::logic_error);
  EXPECT_THROW(blender.Add(EvenPicture(16, 15, 0.5F), mask), std::logic_error);
  blender.Finish();
  EXPECT_THROW(blender.Finish(), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::products
