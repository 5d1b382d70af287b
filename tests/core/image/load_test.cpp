#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/file.h"
#include "core/image/image.h"
#include "core/image/jpeg_structure.h"
#include "tests/core/image/raw_files.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::image {
namespace {

using FloatTiff = InTemporaryFolder;
using LoadRgb8Test = InTemporaryFolder;
using ReadImageSizeTest = InTemporaryFolder;

std::string JpegOf(const Image8& image, int quality = 95) {
  const std::vector<uint8_t> bytes = EncodeJpeg(image, quality);
  return {bytes.begin(), bytes.end()};
}

TEST_F(LoadRgb8Test, ReadsEveryPixelOfAPng) {
  const Image8 image = Pattern(37, 23);
  WriteBytes(folder_.path() / "a.png", PngBytes({37, 23, 8, 2, image.data}));
  const Image8 loaded = LoadRgb8(folder_.path() / "a.png");
  EXPECT_EQ(loaded.width, 37);
  EXPECT_EQ(loaded.height, 23);
  EXPECT_EQ(loaded.channels, 3);
  EXPECT_EQ(loaded.data, image.data);
}

TEST_F(LoadRgb8Test, RepeatsGreyInThreeChannels) {
  WriteBytes(folder_.path() / "grey.png", PngBytes({3, 1, 8, 0, {0, 100, 255}}));
  EXPECT_EQ(LoadRgb8(folder_.path() / "grey.png").data, (std::vector<uint8_t>{0, 0, 0, 100, 100, 100, 255, 255, 255}));
}

TEST_F(LoadRgb8Test, ScalesSixteenBitsSoThatBlackAndWhiteStay) {
  // 0, 257 * 128, 65535 as big-endian RGB.
  WriteBytes(folder_.path() / "deep.png", PngBytes({1, 1, 16, 2, {0x00, 0x00, 0x80, 0x80, 0xFF, 0xFF}}));
  EXPECT_EQ(LoadRgb8(folder_.path() / "deep.png").data, (std::vector<uint8_t>{0, 128, 255}));
}

TEST_F(LoadRgb8Test, DropsAlphaWithoutTouchingColour) {
  WriteBytes(folder_.path() / "alpha.png", PngBytes({2, 1, 8, 6, {10, 20, 30, 0, 40, 50, 60, 255}}));
  EXPECT_EQ(LoadRgb8(folder_.path() / "alpha.png").data, (std::vector<uint8_t>{10, 20, 30, 40, 50, 60}));
  WriteBytes(folder_.path() / "grey_alpha.png", PngBytes({1, 1, 8, 4, {77, 128}}));
  EXPECT_EQ(LoadRgb8(folder_.path() / "grey_alpha.png").data, (std::vector<uint8_t>{77, 77, 77}));
}

TEST_F(LoadRgb8Test, DoesNotApplyExifOrientation) {
  const std::string plain = JpegOf(Pattern(48, 16));
  // APP1: little-endian TIFF with the one tag Orientation (0x0112) = 6, a quarter turn.
  std::string exif("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 32);
  const std::string app1 = std::string("\xFF\xE1\x00", 3) + static_cast<char>(exif.size() + 2) + exif;
  WriteBytes(folder_.path() / "plain.jpg", plain);
  WriteBytes(folder_.path() / "turned.jpg", plain.substr(0, 2) + app1 + plain.substr(2));
  const Image8 turned = LoadRgb8(folder_.path() / "turned.jpg");
  EXPECT_EQ(turned.width, 48);
  EXPECT_EQ(turned.data, LoadRgb8(folder_.path() / "plain.jpg").data);
}

TEST_F(LoadRgb8Test, RefusesAJpegCutAnywhere) {
  const std::string whole = JpegOf(Pattern(200, 150));
  for (size_t n = whole.size() - 1; n > 3; n -= std::max<size_t>(1, n / 12)) {
    WriteBytes(folder_.path() / "cut.jpg", whole.substr(0, n));
    const std::string message = InputErrorOf([&] { LoadRgb8(folder_.path() / "cut.jpg"); });
    EXPECT_NE(message.find("ends early (truncated JPEG)"), std::string::npos) << n << " of " << whole.size() << " bytes: " << message;
    EXPECT_NE(message.find("cut.jpg"), std::string::npos);
  }
}

TEST_F(LoadRgb8Test, RefusesAJpegWhoseTailIsZeros) {
  std::string bytes = JpegOf(Pattern(200, 150));
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end(), '\0');
  WriteBytes(folder_.path() / "zeros.jpg", bytes);
  EXPECT_NE(InputErrorOf([&] { LoadRgb8(folder_.path() / "zeros.jpg"); }), "");
}

TEST_F(LoadRgb8Test, AcceptsDataBehindTheEndOfAJpeg) {
  const std::string whole = JpegOf(Pattern(64, 64));
  WriteBytes(folder_.path() / "whole.jpg", whole);
  // Drones append preview images and their own data; a preview cut short does not harm the photo.
  WriteBytes(folder_.path() / "more.jpg", whole + whole.substr(0, whole.size() / 2) + std::string(1000, '\xFF'));
  EXPECT_EQ(LoadRgb8(folder_.path() / "more.jpg").data, LoadRgb8(folder_.path() / "whole.jpg").data);
}

TEST_F(LoadRgb8Test, NamesTheProblemOfEveryBadFile) {
  const auto message = [&](const std::string& name, const std::string& bytes) {
    WriteBytes(folder_.path() / name, bytes);
    return InputErrorOf([&] { LoadRgb8(folder_.path() / name); });
  };
  EXPECT_NE(message("notes.jpg", "these are only notes\n").find("notes.jpg: is not an image"), std::string::npos);
  EXPECT_NE(message("empty.jpg", "").find("is empty"), std::string::npos);
  const std::string png = PngBytes({64, 64, 8, 2, Pattern(64, 64).data});
  EXPECT_NE(message("cut.png", png.substr(0, png.size() / 2)).find("cannot be decoded"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { LoadRgb8(folder_.path() / "absent.jpg"); }).find("absent.jpg"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { LoadRgb8(folder_.path()); }), "");
}

TEST_F(ReadImageSizeTest, AgreesWithDecodingForEveryKind) {
  SavePng(Pattern(31, 17), folder_.path() / "a.png");
  SaveFloatTiff(ImageF(31, 17, 1, 2.5F), folder_.path() / "a.tif");
  const std::string jpeg = JpegOf(Pattern(31, 17));
  WriteBytes(folder_.path() / "a.jpg", jpeg);
  // Maker notes can put the frame header far into the file.
  std::string app;
  for (int i = 0; i < 8; ++i) app.append("\xFF\xE4\xFF\xFF", 4).append(65533, '\x5A');
  WriteBytes(folder_.path() / "far.jpg", jpeg.substr(0, 2) + app + jpeg.substr(2));
  for (const char* name : {"a.png", "a.tif", "a.jpg", "far.jpg"}) {
    int width = 0;
    int height = 0;
    ReadImageSize(folder_.path() / name, &width, &height);
    EXPECT_EQ(width, 31) << name;
    EXPECT_EQ(height, 17) << name;
  }
}

TEST_F(ReadImageSizeTest, RefusesFilesThatAreNoImages) {
  int width = 0;
  int height = 0;
  WriteBytes(folder_.path() / "notes.jpg", "text");
  EXPECT_NE(InputErrorOf([&] { ReadImageSize(folder_.path() / "notes.jpg", &width, &height); }).find("is not an image"), std::string::npos);
  WriteBytes(folder_.path() / "cut.jpg", JpegOf(Pattern(64, 64)).substr(0, 100));
  EXPECT_NE(InputErrorOf([&] { ReadImageSize(folder_.path() / "cut.jpg", &width, &height); }), "");
  EXPECT_NE(InputErrorOf([&] { ReadImageSize(folder_.path() / "absent.jpg", &width, &height); }), "");
}

TEST(LoadMask, IgnoresOnlyZero) {
  const TemporaryFolder folder;
  WriteBytes(folder.path() / "grey.png", PngBytes({3, 1, 8, 0, {0, 1, 255}}));
  EXPECT_EQ(LoadMask(folder.path() / "grey.png").data, (std::vector<uint8_t>{0, 255, 255}));
  // Black with opaque alpha is still black; one lit channel is enough.
  WriteBytes(folder.path() / "colour.png", PngBytes({2, 1, 8, 6, {0, 0, 0, 255, 0, 0, 9, 255}}));
  EXPECT_EQ(LoadMask(folder.path() / "colour.png").data, (std::vector<uint8_t>{0, 255}));
  WriteBytes(folder.path() / "deep.png", PngBytes({2, 1, 16, 0, {0, 0, 0, 1}}));
  EXPECT_EQ(LoadMask(folder.path() / "deep.png").data, (std::vector<uint8_t>{0, 255}));
}

TEST_F(FloatTiff, KeepsEveryBit) {
  ImageF depth(5, 3, 1);
  for (size_t i = 0; i < depth.data.size(); ++i) depth.data[i] = 100.0F / (static_cast<float>(i) + 0.3F);
  depth.data[4] = std::numeric_limits<float>::quiet_NaN();
  depth.data[5] = std::numeric_limits<float>::infinity();
  depth.data[6] = -1e-30F;
  SaveFloatTiff(depth, folder_.path() / "depth.tif");
  const ImageF loaded = LoadFloatTiff(folder_.path() / "depth.tif");
  ASSERT_EQ(loaded.width, 5);
  ASSERT_EQ(loaded.height, 3);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    EXPECT_TRUE(depth.data[i] == loaded.data[i] || (std::isnan(depth.data[i]) && std::isnan(loaded.data[i]))) << i;
  }
}

TEST_F(FloatTiff, RefusesOtherPixels) {
  SavePng(Pattern(8, 8), folder_.path() / "photo.png");
  EXPECT_NE(InputErrorOf([&] { LoadFloatTiff(folder_.path() / "photo.png"); }).find("floating-point"), std::string::npos);
}

TEST(Labels, AreKeptAsTheyAre) {
  const TemporaryFolder folder;
  Image8 labels(3, 2, 1);
  labels.data = {0, 1, 2, 8, 255, 7};
  SavePng(labels, folder.path() / "classes.png");
  const Image8 loaded = LoadLabels(folder.path() / "classes.png");
  EXPECT_EQ(loaded.width, 3);
  EXPECT_EQ(loaded.channels, 1);
  EXPECT_EQ(loaded.data, labels.data);
  SavePng(Image8(3, 2, 3), folder.path() / "rgb.png");
  EXPECT_NE(InputErrorOf([&] { LoadLabels(folder.path() / "rgb.png"); }).find("one channel"), std::string::npos);
  EXPECT_THROW(LoadLabels(folder.path() / "none.png"), base::InputError);
}

TEST(ParseJpeg, SurvivesAnyBytes) {
  const std::string whole = JpegOf(Pattern(40, 30));
  // Replaces each byte by a few values with a meaning in JPEG.
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const char value : {'\0', '\xFF', '\xD9', '\xDA'}) {
      std::string changed = whole;
      changed[i] = value;
      const JpegStructure found = ParseJpeg({reinterpret_cast<const uint8_t*>(changed.data()), changed.size()}, false);
      EXPECT_GE(found.width, 0);
    }
  }
  EXPECT_FALSE(ParseJpeg({}, false).is_jpeg);
}

TEST(RealPhotos, AreReadWholeAndRefusedWhenCut) {
  const char* given = std::getenv("SKYQUILT_DATA");
  const std::filesystem::path data = given != nullptr ? given : SKYQUILT_SOURCE_DIR "/../shared/data";
  const std::filesystem::path photo = data / "brighton_beach/images/DJI_0018.JPG";
  if (!std::filesystem::exists(photo)) GTEST_SKIP() << "no photos at " << photo << "; set SKYQUILT_DATA to the folder that holds brighton_beach";
  const TemporaryFolder folder;
  int width = 0;
  int height = 0;
  ReadImageSize(photo, &width, &height);
  const Image8 image = LoadRgb8(photo);
  EXPECT_EQ(image.width, width);
  EXPECT_EQ(image.height, height);
  const std::string bytes = base::ReadFile(photo);
  for (const double share : {0.25, 0.9}) {
    WriteBytes(folder.path() / "cut.jpg", bytes.substr(0, static_cast<size_t>(share * static_cast<double>(bytes.size()))));
    EXPECT_NE(InputErrorOf([&] { LoadRgb8(folder.path() / "cut.jpg"); }).find("ends early"), std::string::npos) << share;
  }
}

}  // namespace
}  // namespace skyquilt::image
