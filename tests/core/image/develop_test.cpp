#include "core/image/develop.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/made_photos_to_develop.h"

namespace skyquilt::image {
namespace {

constexpr int kDngWidth = 64, kDngHeight = 48;
constexpr uint32_t kDngWhite = 16'000;

class Developed : public InTemporaryFolder {
 protected:
  // All cells of a colour have the same light, as shares of white.
  std::filesystem::path Dng(const std::string& name, double red, double green, double blue, int orientation = 1) {
    std::vector<uint16_t> values;
    for (int y = 0; y < kDngHeight; ++y) {
      for (int x = 0; x < kDngWidth; ++x) {
        const double share = y % 2 == 0 ? (x % 2 == 0 ? red : green) : (x % 2 == 0 ? green : blue);
        values.push_back(static_cast<uint16_t>(share * kDngWhite));
      }
    }
    base::WriteFileAtomically(folder_ / name, test::MadeDng(kDngWidth, kDngHeight, values, kDngWhite, orientation));
    return folder_ / name;
  }
  static int Stored(double linear) { return static_cast<int>(std::lround(255.0 * static_cast<double>(SrgbFromLinear(static_cast<float>(linear))))); }
  static void ExpectMiddle(const Image8& image, int red, int green, int blue) {
    const uint8_t* rgb = image.At(image.width / 2, image.height / 2);
    EXPECT_NEAR(rgb[0], red, 2);
    EXPECT_NEAR(rgb[1], green, 2);
    EXPECT_NEAR(rgb[2], blue, 2);
  }
};

TEST_F(Developed, RawLightIsStoredAsSrgb) {
  const Image8 image = DevelopPhoto(Dng("a.DNG", 0.2, 0.2, 0.2));
  EXPECT_EQ(image.width, kDngWidth);
  EXPECT_EQ(image.height, kDngHeight);
  ExpectMiddle(image, Stored(0.2), Stored(0.2), Stored(0.2));
  ExpectMiddle(DevelopPhoto(Dng("b.dng", 0.4, 0.1, 0.2)), Stored(0.4), Stored(0.1), Stored(0.2));
}

TEST_F(Developed, DarkRawPhotosStayDark) {
  ExpectMiddle(DevelopPhoto(Dng("dark.dng", 0.01, 0.01, 0.01)), Stored(0.01), Stored(0.01), Stored(0.01));
  ExpectMiddle(DevelopPhoto(Dng("white.dng", 1.0, 1.0, 1.0)), 255, 255, 255);
}

TEST_F(Developed, RawPhotosAreNotTurned) {
  int width = 0, height = 0;
  const std::filesystem::path file = Dng("turned.dng", 0.2, 0.2, 0.2, 6);
  ReadDevelopedSize(file, &width, &height);
  EXPECT_EQ(width, kDngWidth);
  EXPECT_EQ(height, kDngHeight);
  EXPECT_EQ(DevelopPhoto(file).width, kDngWidth);
}

TEST_F(Developed, HeicIsTheMainPicture) {
  Image8 pixels(64, 48, 3);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      pixels.At(x, y)[0] = static_cast<uint8_t>(x < 32 ? 200 : 40);
      pixels.At(x, y)[1] = 120;
      pixels.At(x, y)[2] = static_cast<uint8_t>(y < 24 ? 30 : 180);
    }
  }
  if (!test::WriteHeic(pixels, folder_ / "a.HEIC")) GTEST_SKIP() << "this libheif writes no HEIC";
  int width = 0, height = 0;
  ReadDevelopedSize(folder_ / "a.HEIC", &width, &height);
  EXPECT_EQ(width, 64);
  EXPECT_EQ(height, 48);
  const Image8 image = DevelopPhoto(folder_ / "a.HEIC");
  for (const auto& [x, y] : {std::pair{10, 10}, {50, 10}, {10, 40}, {50, 40}}) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.At(x, y)[c], pixels.At(x, y)[c], 8) << x << " " << y;
  }
  const std::string bytes = base::ReadFile(folder_ / "a.HEIC");
  base::WriteFileAtomically(folder_ / "cut.heic", bytes.substr(0, bytes.size() - 40));
  EXPECT_NE(InputErrorOf([&] { DevelopPhoto(folder_ / "cut.heic"); }).find("cut.heic"), std::string::npos);
}

TEST_F(Developed, DamagedFilesAreNamed) {
  for (const char* name : {"a.heic", "a.dng", "a.nef"}) {
    for (const std::string& content : {std::string(), std::string("II*\0", 4), std::string(1000, 'x')}) {
      base::WriteFileAtomically(folder_ / name, content);
      int width = 0, height = 0;
      EXPECT_NE(InputErrorOf([&] { DevelopPhoto(folder_ / name); }).find(name), std::string::npos);
      EXPECT_NE(InputErrorOf([&] { ReadDevelopedSize(folder_ / name, &width, &height); }).find(name), std::string::npos);
    }
  }
}

TEST(NeedsDeveloping, IsByTheExtension) {
  for (const char* name : {"a.HEIC", "b.dng", "x/y.Nef"}) EXPECT_TRUE(NeedsDeveloping(name)) << name;
  for (const char* name : {"a.jpg", "heic", "a.tif", "a.x3f", "a.heic.jpg"}) EXPECT_FALSE(NeedsDeveloping(name)) << name;
}

}  // namespace
}  // namespace skyquilt::image
