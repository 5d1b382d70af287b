#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coordinator/simulate/survey_writer.h"
#include "core/image/srgb.h"

namespace skyquilt::simulate {
namespace {

TEST(Develop, GainsActOnLinearLight) {
  image::ImageF dim(64, 1, 3);
  image::ImageF bright(64, 1, 3);
  for (size_t i = 0; i < dim.data.size(); ++i) {
    dim.data[i] = 0.3F * static_cast<float>(i) / static_cast<float>(dim.data.size());
    bright.data[i] = 2.0F * dim.data[i];
  }
  EXPECT_EQ(Develop(dim, 2.0).data, Develop(bright, 1.0).data);
  // Twice the light is twice the linear value, up to one 8-bit step.
  const image::Image8 one = Develop(dim, 1.0);
  const image::Image8 two = Develop(dim, 2.0);
  for (size_t i = 0; i < one.data.size(); ++i) {
    const float linear = image::LinearFromSrgb(static_cast<float>(one.data[i]) / 255.0F);
    const float expected = 255.0F * image::SrgbFromLinear(std::min(2.0F * linear, 1.0F));
    EXPECT_NEAR(static_cast<float>(two.data[i]), expected, 7.5F * (one.data[i] < 8 ? 1.0F : 0.2F)) << i;
  }
}

TEST(Develop, ClipsAtWhiteAndNeverWraps) {
  image::ImageF light(3, 1, 3);
  light.data = {0.0F, 1e-6F, 0.5F, 10.0F, 1e6F, 1e30F, -1.0F, -0.0F, 1.0F};
  const image::Image8 out = Develop(light, 4.0);
  EXPECT_EQ(out.data[0], 0);
  for (size_t i = 2; i < 6; ++i) EXPECT_EQ(out.data[i], 255) << i;
  EXPECT_EQ(out.data[6], 0);
}

}  // namespace
}  // namespace skyquilt::simulate
