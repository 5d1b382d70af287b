#include "evaluate/ortho/slanted_edge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace skyquilt::evaluate::ortho {
namespace {

// An edge through the middle that stands this much off the columns, blurred by a Gaussian.
image::ImageF BlurredEdge(double angle_deg, double sigma_px, int size, bool bright_left = false) {
  const double angle = angle_deg * std::numbers::pi / 180.0, middle = 0.5 * (size - 1) + 0.3;
  image::ImageF image(size, size, 1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double distance = (x - middle) * std::cos(angle) + (y - middle) * std::sin(angle);
      const double share = 0.5 * std::erfc(-distance / (sigma_px * std::numbers::sqrt2));
      *image.At(x, y) = static_cast<float>(0.05 + 0.7 * (bright_left ? 1.0 - share : share));
    }
  }
  return image;
}

TEST(SlantedEdge, FindsTheBlurOfAGaussian) {
  for (const double sigma_px : {0.5, 0.7, 1.0, 2.0}) {
    const double expected = std::sqrt(std::log(2.0) / 2.0) / (std::numbers::pi * sigma_px);
    for (const double angle_deg : {5.0, -7.0, 20.0, 85.0, 97.0, 183.0}) {
      EXPECT_NEAR(SlantedEdgeMtf50(BlurredEdge(angle_deg, sigma_px, 50)), expected, 0.05 * expected) << sigma_px << " px, " << angle_deg << " deg";
    }
    EXPECT_NEAR(SlantedEdgeMtf50(BlurredEdge(5.0, sigma_px, 50, true)), expected, 0.05 * expected) << "bright on the other side";
  }
}

TEST(SlantedEdge, SaysNothingWhereThereIsNoSuchEdge) {
  EXPECT_TRUE(std::isnan(SlantedEdgeMtf50(image::ImageF(50, 50, 1, 0.5F)))) << "no contrast";
  EXPECT_TRUE(std::isnan(SlantedEdgeMtf50(BlurredEdge(5.0, 1.0, 12)))) << "too small";
  EXPECT_TRUE(std::isnan(SlantedEdgeMtf50(BlurredEdge(0.0, 1.0, 50)))) << "along a column";
  image::ImageF hole = BlurredEdge(5.0, 1.0, 50);
  *hole.At(3, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(SlantedEdgeMtf50(hole)));
}

}  // namespace
}  // namespace skyquilt::evaluate::ortho
