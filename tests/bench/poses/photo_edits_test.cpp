#include "bench/poses/photo_edits.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/camera/camera.h"

namespace skyquilt::bench {
namespace {

image::Image8 Numbered(int width, int height) {
  image::Image8 photo(width, height, 3);
  for (size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = static_cast<uint8_t>(i);
  return photo;
}

TEST(PhotoEdits, AQuarterTurnMovesPixelsAsItMovesTheCamera) {
  const image::Image8 photo = Numbered(8, 6);
  const image::Image8 turned = TurnedClockwise(photo);
  ASSERT_EQ(turned.width, 6);
  ASSERT_EQ(turned.height, 8);
  EXPECT_EQ(*turned.At(5, 0), *photo.At(0, 0));
  EXPECT_EQ(*turned.At(0, 0), *photo.At(0, 5));
  const camera::Camera camera{camera::CameraModel::kPinhole, 8, 6, {7.0, 7.0, 4.0, 3.0}};
  const camera::Camera turned_camera{camera::CameraModel::kPinhole, 6, 8, {7.0, 7.0, 3.0, 4.0}};
  const geo::Rigid3d pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 2).normalized())), {0.3, -0.2, 9.0}};
  const Eigen::Vector3d x(1.5, 1.0, 2.0);
  const auto before = camera.ImgFromCam(pose * x), after = turned_camera.ImgFromCam(TurnedClockwise(pose) * x);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(after->x(), 6.0 - before->y(), 1e-9);
  EXPECT_NEAR(after->y(), before->x(), 1e-9);
}

TEST(PhotoEdits, MovementBlursAlongColumnsOnly) {
  image::Image8 photo(3, 9, 1);
  *photo.At(1, 4) = 90;
  const image::Image8 blurred = MovedWhileOpen(photo, 3);
  for (int y = 0; y < 9; ++y) {
    EXPECT_EQ(*blurred.At(1, y), y >= 3 && y <= 5 ? 30 : 0) << y;
    EXPECT_EQ(*blurred.At(0, y), 0);
  }
  EXPECT_EQ(MovedWhileOpen(Numbered(4, 5), 1).data, Numbered(4, 5).data);
  // Fewer pixels at the ends, so that they do not get dark.
  const image::Image8 even(2, 7, 3, 200);
  EXPECT_EQ(MovedWhileOpen(even, 50).data, even.data);
  EXPECT_THROW(MovedWhileOpen(even, 0), std::logic_error);
}

TEST(PhotoEdits, TheMiddleStaysTheMiddle) {
  const image::Image8 photo = Numbered(8, 6);
  const image::Image8 middle = MiddleOf(photo, 4, 2);
  EXPECT_EQ(middle.width, 4);
  EXPECT_EQ(middle.height, 2);
  EXPECT_EQ(*middle.At(0, 0), *photo.At(2, 2));
  EXPECT_EQ(middle.At(3, 1)[2], photo.At(5, 3)[2]);
  EXPECT_THROW(MiddleOf(photo, 5, 2), std::logic_error);
  EXPECT_THROW(MiddleOf(photo, 10, 2), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::bench
