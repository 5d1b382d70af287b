#include "tour/pictures/jpeg_quality.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/image.h"
#include "tests/support/temporary_folder.h"
#include "tour/pictures/picture_file.h"

namespace skyquilt::tour {
namespace {

TEST(JpegQuality, IsTheHighestThatKeepsToTheLimit) {
  int calls = 0;
  const auto bytes_at = [&calls](int quality) {
    ++calls;
    return int64_t{1000} * quality;
  };
  for (int64_t limit = 60'000; limit <= 93'000; limit += 250) {
    calls = 0;
    const JpegFit fit = FitQuality(bytes_at, limit);
    EXPECT_TRUE(fit.fits);
    EXPECT_EQ(fit.quality, std::min<int64_t>(limit / 1000, kMostQuality));
    EXPECT_EQ(fit.bytes, 1000 * fit.quality);
    EXPECT_LE(calls, 7);
  }
}

TEST(JpegQuality, SaysWhenNothingKeepsToTheLimit) {
  const JpegFit fit = FitQuality([](int quality) { return int64_t{1000} * quality; }, 59'999);
  EXPECT_FALSE(fit.fits);
  EXPECT_EQ(fit.quality, kLeastQuality);
  EXPECT_EQ(fit.bytes, 60'000);
}

// Tables of quantisation are rounded, so a higher quality may give a slightly smaller file.
TEST(JpegQuality, KeepsToTheLimitWhenBytesDoNotQuiteGrow) {
  const auto bytes_at = [](int quality) { return int64_t{1000} * quality + (quality % 3 == 0 ? 2500 : 0); };
  for (int64_t limit = 63'000; limit <= 95'000; limit += 111) {
    const JpegFit fit = FitQuality(bytes_at, limit);
    EXPECT_TRUE(fit.fits);
    EXPECT_LE(fit.bytes, limit);
    EXPECT_EQ(fit.bytes, bytes_at(fit.quality));
  }
}

TEST(JpegQuality, OfPicturesIsThatOfAllTogether) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  std::vector<image::Image8> pictures;
  for (int i = 0; i < 3; ++i) {
    RenderedPicture rendered;
    rendered.color = image::Image8(96, 48, 3);
    for (size_t k = 0; k < rendered.color.data.size(); ++k) {
      rendered.color.data[k] = static_cast<uint8_t>(127.0 + 120.0 * std::sin(static_cast<double>(k * k % 977) * 0.01 * (i + 1)));
    }
    pictures.push_back(rendered.color);
    const std::string key = base::HashHex(std::to_string(i));
    files.push_back(folder / PictureFileName(key));
    SavePicture(Encode(rendered), key, files.back());
  }
  files.push_back(files[0]);
  const auto together = [&](int quality) {
    int64_t bytes = 0;
    for (const image::Image8& picture : pictures) bytes += static_cast<int64_t>(image::EncodeJpeg(picture, quality).size());
    return bytes;
  };
  base::ThreadPool threads(2);
  const int64_t limit = (together(75) + together(76)) / 2;
  const JpegFit fit = FitPictures(files, limit, threads);
  EXPECT_TRUE(fit.fits);
  EXPECT_EQ(fit.quality, 75);
  EXPECT_EQ(fit.bytes, together(75));
  EXPECT_EQ(FitPictures(files, 10 * limit, threads).quality, kMostQuality);
  EXPECT_FALSE(FitPictures(files, limit / 10, threads).fits);
  base::WriteFileAtomically(files[1], "damaged");
  EXPECT_THROW(FitPictures(files, limit, threads), base::InputError);
}

}  // namespace
}  // namespace skyquilt::tour
