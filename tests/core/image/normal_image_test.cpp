#include "core/image/normal_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors.h"

namespace skyquilt::image {
namespace {

TEST(NormalImage, KeepsDirectionsAndGaps) {
  ImageF normals(3, 1, 3, 0.0F);
  const float east_up[3] = {std::sqrt(0.5F), 0.0F, std::sqrt(0.5F)};
  std::copy(east_up, east_up + 3, normals.At(0, 0));
  normals.At(1, 0)[1] = -1.0F;
  for (int c = 0; c < 3; ++c) normals.At(2, 0)[c] = std::numeric_limits<float>::quiet_NaN();
  const auto file = std::filesystem::path(testing::TempDir()) / "normals.png";
  SaveNormals(normals, file);
  const ImageF loaded = LoadNormals(file);
  ASSERT_EQ(loaded.width, 3);
  for (int x = 0; x < 2; ++x) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(loaded.At(x, 0)[c], normals.At(x, 0)[c], 4e-5F);
  }
  EXPECT_TRUE(std::isnan(loaded.At(2, 0)[0]));
  const Image8 shown = ShowNormals(normals);
  EXPECT_EQ(shown.At(1, 0)[1], 0);
  EXPECT_EQ(shown.At(1, 0)[0], 128);
  EXPECT_EQ(shown.At(2, 0)[2], 0);
}

TEST(NormalImage, OtherPicturesAreRefused) {
  const auto file = std::filesystem::path(testing::TempDir()) / "photo.png";
  SavePng(Image8(4, 4, 3, 128), file);
  EXPECT_THROW(LoadNormals(file), base::InputError);
  EXPECT_THROW(LoadNormals(file.parent_path() / "absent.png"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::image
