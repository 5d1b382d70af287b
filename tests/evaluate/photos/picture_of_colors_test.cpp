#include "evaluate/photos/picture_of_colors.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace skyquilt::evaluate::photos {
namespace {

TEST(PictureOf, IsClampedAndNeverNan) {
  std::vector<render::RayColor> colors(2);
  colors[0].rgb_srgb[0] = 2.0F;
  colors[1].rgb_srgb[2] = std::numeric_limits<float>::quiet_NaN();
  const image::Image8 picture = PictureOf(colors, 2, 1);
  EXPECT_EQ(picture.data, (std::vector<uint8_t>{255, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
