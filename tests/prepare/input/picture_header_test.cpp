#include "prepare/input/picture_header.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/base/random.h"
#include "tests/prepare/input/made_folder.h"

namespace skyquilt::prepare::input {
namespace {

PictureHeader HeaderOf(const std::string& bytes) {
  return ParsePictureHeader({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
}

std::string JpegBytes(int channels) {
  const std::vector<uint8_t> bytes = image::EncodeJpeg(image::Image8(24, 16, channels, 90), 80);
  return {bytes.begin(), bytes.end()};
}

TEST(PictureHeader, TellsSizeAndChannels) {
  const PictureHeader jpeg = HeaderOf(JpegBytes(3));
  EXPECT_EQ(jpeg.format, PictureFormat::kJpeg);
  EXPECT_TRUE(jpeg.width == 24 && jpeg.height == 16 && jpeg.channels == 3 && !jpeg.has_alpha);
  for (const int channels : {1, 3, 4}) {
    const PictureHeader png = HeaderOf(image::EncodePng(image::Image8(24, 16, channels, 90), 1));
    EXPECT_EQ(png.format, PictureFormat::kPng);
    EXPECT_TRUE(png.width == 24 && png.height == 16);
    EXPECT_EQ(png.channels, channels);
    EXPECT_EQ(png.has_alpha, channels == 4);
    const PictureHeader tiff = HeaderOf(test::TiffHeader(24, 16, channels));
    EXPECT_EQ(tiff.format, PictureFormat::kTiff);
    EXPECT_TRUE(tiff.width == 24 && tiff.height == 16 && !tiff.is_map);
    EXPECT_EQ(tiff.channels, channels);
  }
}

// A fourth channel is near infrared as often as alpha.
TEST(PictureHeader, TiffHasAlphaOnlyWhereItSaysSo) {
  EXPECT_FALSE(HeaderOf(test::TiffHeader(24, 16, 4)).has_alpha);
  EXPECT_FALSE(HeaderOf(test::TiffHeader(24, 16, 4, 0)).has_alpha);
  EXPECT_TRUE(HeaderOf(test::TiffHeader(24, 16, 4, 1)).has_alpha);
  EXPECT_TRUE(HeaderOf(test::TiffHeader(24, 16, 4, 2)).has_alpha);
  EXPECT_FALSE(HeaderOf(test::TiffHeader(24, 16, 5, 2)).has_alpha);
  EXPECT_TRUE(HeaderOf(test::TiffHeader(24, 16, 3, -1, true)).is_map);
}

RC_GTEST_PROP(PictureHeader, AcceptsAnyBytes, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const std::vector<std::string> seeds = {JpegBytes(3), image::EncodePng(image::Image8(8, 8, 4, 9), 1), test::TiffHeader(24, 16, 4, 1, true), ""};
  std::string bytes = seeds[random.Below(static_cast<uint32_t>(seeds.size()))];
  const uint32_t n_changes = random.Below(8);
  for (uint32_t i = 0; i < n_changes && !bytes.empty(); ++i) {
    const uint32_t at = random.Below(static_cast<uint32_t>(bytes.size())), value = random.Below(256);
    bytes[at] = static_cast<char>(value);
  }
  if (random.Below(2) == 0) bytes.resize(random.Below(static_cast<uint32_t>(bytes.size() + 1)));
  const PictureHeader header = HeaderOf(bytes);
  RC_ASSERT(header.width >= 0);
  RC_ASSERT(header.height >= 0);
  RC_ASSERT(header.channels >= 0);
}

}  // namespace
}  // namespace skyquilt::prepare::input
