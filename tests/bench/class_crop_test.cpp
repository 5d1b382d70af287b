#include <gtest/gtest.h>

#include "bench/study/picture_sheet.h"

namespace skyquilt::bench {
namespace {

using survey::SurfaceClass;

image::Image8 Classes(int width, int height, SurfaceClass everywhere) {
  return {width, height, 1, static_cast<uint8_t>(everywhere)};
}

void Fill(image::Image8* classes, const PicturePart& part, SurfaceClass with) {
  for (int y = part.top; y < part.top + part.height; ++y) {
    for (int x = part.left; x < part.left + part.width; ++x) *classes->At(x, y) = static_cast<uint8_t>(with);
  }
}

TEST(CropWithMost, FindsEachClassWhereItIs) {
  image::Image8 classes = Classes(40, 30, SurfaceClass::kGround);
  Fill(&classes, {3, 2, 8, 6}, SurfaceClass::kRoof);
  Fill(&classes, {30, 20, 8, 6}, SurfaceClass::kTree);
  Fill(&classes, {20, 20, 2, 2}, SurfaceClass::kTree);
  const ClassCrop roofs = CropWithMost(classes, SurfaceClass::kRoof, 8, 6);
  EXPECT_EQ(roofs.part.left, 3);
  EXPECT_EQ(roofs.part.top, 2);
  EXPECT_EQ(roofs.part.width, 8);
  EXPECT_EQ(roofs.part.height, 6);
  EXPECT_EQ(roofs.pixels, 48);
  const ClassCrop trees = CropWithMost(classes, SurfaceClass::kTree, 8, 6);
  EXPECT_EQ(trees.part.left, 30);
  EXPECT_EQ(trees.part.top, 20);
  EXPECT_EQ(trees.pixels, 48);
}

TEST(CropWithMost, PrefersTheMiddleAmongEquals) {
  const ClassCrop everywhere = CropWithMost(Classes(20, 12, SurfaceClass::kRoof), SurfaceClass::kRoof, 8, 6);
  EXPECT_EQ(everywhere.part.left, 6);
  EXPECT_EQ(everywhere.part.top, 3);
  EXPECT_EQ(everywhere.pixels, 48);
  // A wall that fits in many crops: of those that have all of it, the one closest to the middle.
  image::Image8 classes = Classes(20, 12, SurfaceClass::kGround);
  Fill(&classes, {4, 2, 2, 2}, SurfaceClass::kWall);
  const ClassCrop wall = CropWithMost(classes, SurfaceClass::kWall, 8, 6);
  EXPECT_EQ(wall.part.left, 4);
  EXPECT_EQ(wall.part.top, 2);
  EXPECT_EQ(wall.pixels, 4);
}

TEST(CropWithMost, IsTheMiddleWithoutTheClass) {
  const ClassCrop none = CropWithMost(Classes(20, 12, SurfaceClass::kGround), SurfaceClass::kWall, 8, 6);
  EXPECT_EQ(none.part.left, 6);
  EXPECT_EQ(none.part.top, 3);
  EXPECT_EQ(none.pixels, 0);
}

TEST(CropWithMost, IsNotLargerThanTheImage) {
  const ClassCrop whole = CropWithMost(Classes(5, 4, SurfaceClass::kTree), SurfaceClass::kTree, 100, 100);
  EXPECT_EQ(whole.part.width, 5);
  EXPECT_EQ(whole.part.height, 4);
  EXPECT_EQ(whole.pixels, 20);
}

}  // namespace
}  // namespace skyquilt::bench
