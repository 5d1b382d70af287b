#include "core/image/pixel_format.h"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "core/image/image.h"
#include "tests/core/image/raw_files.h"
#include "tests/support/error_of.h"
#include "tests/support/raw_tiff.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::image {
namespace {

std::string TiffOf(int bands, int bits, int photometric, std::vector<uint16_t> extra = {}, std::map<uint16_t, uint16_t> more = {},
                   bool floating = false) {
  const auto n = static_cast<size_t>(4 * 3 * bands * bits / 8);
  return test::TiffBytes({.width = 4,
                          .height = 3,
                          .bands = bands,
                          .bits = bits,
                          .floating = floating,
                          .photometric = photometric,
                          .extra = std::move(extra),
                          .pixels = std::vector<uint8_t>(n, 7),
                          .more = std::move(more)});
}

PixelFormat FormatOf(const std::string& bytes) {
  return PixelFormatOf({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
}

TEST(PixelFormat, SaysWhatATiffHolds) {
  const PixelFormat rgb = FormatOf(TiffOf(3, 16, 2));
  EXPECT_EQ(rgb.kind, FileKind::kTiff);
  EXPECT_EQ(rgb.width, 4);
  EXPECT_EQ(rgb.height, 3);
  EXPECT_EQ(rgb.bands, 3);
  EXPECT_EQ(rgb.bits, 16);
  EXPECT_TRUE(rgb.is_rgb);
  EXPECT_FALSE(rgb.floating);
  EXPECT_FALSE(rgb.white);
  const PixelFormat five = FormatOf(TiffOf(5, 16, 1, {0, 0, 0, 2}));
  EXPECT_EQ(five.bands, 5);
  EXPECT_EQ(five.alpha_bands, 1);
  EXPECT_FALSE(five.is_rgb);
  EXPECT_TRUE(FormatOf(TiffOf(3, 32, 2, {}, {}, true)).floating);
}

TEST(PixelFormat, TakesWhiteFromTagsThatSayMoreThanTheType) {
  constexpr uint16_t kMaxSampleValue = 281, kWhiteLevel = 50717;
  EXPECT_EQ(FormatOf(TiffOf(3, 16, 2, {}, {{kMaxSampleValue, 4095}})).white, 4095.0);
  EXPECT_FALSE(FormatOf(TiffOf(3, 16, 2, {}, {{kMaxSampleValue, 65535}})).white);
  EXPECT_EQ(FormatOf(TiffOf(3, 16, 2, {}, {{kMaxSampleValue, 4095}, {kWhiteLevel, 16000}})).white, 16000.0);
  EXPECT_FALSE(FormatOf(TiffOf(3, 8, 2, {}, {{kMaxSampleValue, 255}})).white);
}

TEST(PixelFormat, PlainIsWhatAllProgramsRead) {
  const auto plain_tiff = [](int bands, int bits, int photometric, std::vector<uint16_t> extra = {}, bool floating = false) {
    return IsPlain(FormatOf(TiffOf(bands, bits, photometric, std::move(extra), {}, floating)));
  };
  EXPECT_TRUE(plain_tiff(1, 8, 1));
  EXPECT_TRUE(plain_tiff(3, 8, 2));
  EXPECT_TRUE(plain_tiff(3, 8, 1));
  EXPECT_TRUE(plain_tiff(4, 8, 2, {2}));
  EXPECT_FALSE(plain_tiff(3, 16, 2));
  EXPECT_FALSE(plain_tiff(1, 16, 1));
  EXPECT_FALSE(plain_tiff(3, 32, 2, {}, true));
  EXPECT_FALSE(plain_tiff(2, 8, 1, {2}));
  EXPECT_FALSE(plain_tiff(4, 8, 5));
  EXPECT_FALSE(plain_tiff(4, 8, 1, {0, 0, 0}));
  EXPECT_FALSE(plain_tiff(5, 8, 2, {0, 0}));
  const auto plain_png = [](int bits, int colour_type, size_t bytes) {
    return IsPlain(FormatOf(PngBytes({1, 1, bits, colour_type, std::vector<uint8_t>(bytes, 9)})));
  };
  EXPECT_TRUE(plain_png(8, 0, 1));
  EXPECT_TRUE(plain_png(8, 4, 2));
  EXPECT_TRUE(plain_png(8, 6, 4));
  EXPECT_FALSE(plain_png(16, 2, 6));
  const std::vector<uint8_t> jpeg = EncodeJpeg(Pattern(16, 8), 90);
  const PixelFormat of_jpeg = PixelFormatOf(jpeg);
  EXPECT_EQ(of_jpeg.kind, FileKind::kJpeg);
  EXPECT_EQ(of_jpeg.width, 16);
  EXPECT_EQ(of_jpeg.bands, 3);
  EXPECT_EQ(of_jpeg.bits, 8);
  EXPECT_TRUE(IsPlain(of_jpeg));
}

TEST(PixelFormat, ReadsBigEndianAndBigTiff) {
  // 4 x 3, 16 bits in three bands: the lengths are told by counts, the bits are elsewhere in the file.
  std::string big("MM\0*\0\0\0\x08\0\x04", 10);
  big += std::string("\x01\0\0\x03\0\0\0\x01\0\x04\0\0", 12) + std::string("\x01\x01\0\x03\0\0\0\x01\0\x03\0\0", 12);
  big += std::string("\x01\x02\0\x03\0\0\0\x03\0\0\0\x3E", 12) + std::string("\x01\x15\0\x03\0\0\0\x01\0\x03\0\0", 12);
  big += std::string("\0\0\0\0", 4) + std::string("\0\x10\0\x10\0\x10", 6);
  const PixelFormat format = FormatOf(big);
  EXPECT_EQ(format.width, 4);
  EXPECT_EQ(format.height, 3);
  EXPECT_EQ(format.bits, 16);
  EXPECT_EQ(format.bands, 3);
  std::string bigtiff("II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0", 24);
  bigtiff += std::string("\0\x01\x04\0\x01\0\0\0\0\0\0\0\x2C\x01\0\0\0\0\0\0", 20);
  EXPECT_EQ(FormatOf(bigtiff).width, 300);
}

TEST(PixelFormat, SurvivesAnyBytes) {
  const std::string whole = TiffOf(5, 16, 1, {0, 0, 0, 2}, {{281, 4095}});
  for (size_t i = 0; i < std::min<size_t>(whole.size(), 260); ++i) {
    for (const char value : {'\0', '\x01', '\x7F', '\xFF'}) {
      std::string changed = whole;
      changed[i] = value;
      EXPECT_GE(FormatOf(changed).bands, 0);
      EXPECT_GE(FormatOf(whole.substr(0, i)).width, 0);
    }
  }
  EXPECT_EQ(FormatOf("").kind, FileKind::kOther);
  EXPECT_EQ(FormatOf("\x89PNG\r\n\x1A\n").width, 0);
}

TEST(ReadImageSize, OfATiffThatIsNotPlainComesFromItsHeader) {
  const TemporaryFolder folder;
  WriteBytes(folder / "five.tif", TiffOf(5, 16, 1, {0, 0, 0, 0}));
  int width = 0, height = 0;
  ReadImageSize(folder / "five.tif", &width, &height);
  EXPECT_EQ(width, 4);
  EXPECT_EQ(height, 3);
}

TEST(LoadRgb8, SaysThatATiffHasSeveralBandsAndPrintsNothing) {
  const TemporaryFolder folder;
  WriteBytes(folder / "five.tif", TiffOf(5, 8, 1, {0, 0, 0, 0}));
  WriteBytes(folder / "cut.tif", TiffOf(3, 8, 2).substr(0, 60));
  std::ostringstream printed;
  std::streambuf* const kept = std::cerr.rdbuf(printed.rdbuf());
  const std::string several = InputErrorOf([&] { LoadRgb8(folder / "five.tif"); });
  const std::string cut = InputErrorOf([&] { LoadRgb8(folder / "cut.tif"); });
  std::cerr.rdbuf(kept);
  EXPECT_NE(several.find("has 5 bands"), std::string::npos) << several;
  EXPECT_NE(several.find("prepare.bands"), std::string::npos) << several;
  EXPECT_EQ(several.find("memory card"), std::string::npos) << several;
  EXPECT_NE(cut.find("cannot be decoded"), std::string::npos) << cut;
  EXPECT_EQ(printed.str(), "");
  EXPECT_TRUE(LoadAlphaMask(folder / "five.tif").Empty());
}

TEST(LoadRgb8, SaysThatAJpegHasTwelveBits) {
  const TemporaryFolder folder;
  const std::vector<uint8_t> whole = EncodeJpeg(Pattern(16, 8), 90);
  std::string bytes(whole.begin(), whole.end());
  const size_t frame = bytes.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  bytes[frame + 4] = 12;
  WriteBytes(folder / "deep.jpg", bytes);
  const std::string message = InputErrorOf([&] { LoadRgb8(folder / "deep.jpg"); });
  EXPECT_NE(message.find("is a JPEG of 12 bits"), std::string::npos) << message;
}

}  // namespace
}  // namespace skyquilt::image
