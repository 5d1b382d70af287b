#include "bench/study/picture_sheet.h"

#include <gtest/gtest.h>

namespace skyquilt::bench {
namespace {

image::Image8 Counting(int width, int height) {
  image::Image8 image(width, height, 3);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<uint8_t>(i);
  return image;
}

TEST(EnlargedMiddle, RepeatsPixelsOfTheCentre) {
  image::Image8 image(4, 4, 3);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<uint8_t>(i);
  const image::Image8 enlarged = EnlargedMiddle(image, 2, 2, 3);
  ASSERT_EQ(enlarged.width, 6);
  ASSERT_EQ(enlarged.height, 6);
  EXPECT_EQ(*enlarged.At(0, 0), *image.At(1, 1));
  EXPECT_EQ(*enlarged.At(2, 2), *image.At(1, 1));
  EXPECT_EQ(*enlarged.At(3, 2), *image.At(2, 1));
  EXPECT_EQ(EnlargedMiddle(image, 100, 100, 1).data, image.data);
}

TEST(EnlargedPart, IsMovedInsideTheImage) {
  const image::Image8 image = Counting(4, 3);
  const image::Image8 corner = EnlargedPart(image, {3, -5, 2, 2}, 1);
  ASSERT_EQ(corner.width, 2);
  ASSERT_EQ(corner.height, 2);
  EXPECT_EQ(*corner.At(0, 0), *image.At(2, 0));
  EXPECT_EQ(*corner.At(1, 1), *image.At(3, 1));
  const image::Image8 inside = EnlargedPart(image, {1, 1, 2, 1}, 2);
  ASSERT_EQ(inside.width, 4);
  ASSERT_EQ(inside.height, 2);
  EXPECT_EQ(inside.At(3, 1)[2], image.At(2, 1)[2]);
  EXPECT_EQ(EnlargedPart(image, {1, 1, 100, 100}, 1).data, image.data);
}

TEST(PictureSheet, HoldsEveryImageBesideTheOther) {
  const image::Image8 sheet =
      PictureSheet({{{"", image::Image8(6, 4, 3, 10)}, {"", image::Image8(6, 4, 3, 20)}}, {{"", image::Image8(6, 4, 3, 30)}}});
  std::vector<int> pixels(256, 0);
  for (size_t i = 0; i < sheet.data.size(); i += 3) ++pixels[sheet.data[i]];
  EXPECT_EQ(pixels[10], 24);
  EXPECT_EQ(pixels[20], 24);
  EXPECT_EQ(pixels[30], 24);
  EXPECT_EQ(pixels[255], sheet.width * sheet.height - 72) << "the rest is white";
}

}  // namespace
}  // namespace skyquilt::bench
