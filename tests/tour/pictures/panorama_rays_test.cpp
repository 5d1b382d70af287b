#include "tour/pictures/panorama_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace skyquilt::tour {
namespace {

const Eigen::Vector3d kEye(12.5, -3.0, 40.0);

std::vector<render::Ray> AllRays(int width) {
  std::vector<size_t> pixels(static_cast<size_t>(width) * static_cast<size_t>(width / 2));
  std::iota(pixels.begin(), pixels.end(), size_t{0});
  std::vector<render::Ray> rays(pixels.size());
  PanoramaRays(kEye, width).Make(pixels, rays);
  return rays;
}

TEST(PanoramaRays, StartAtTheEyeWithLengthOne) {
  for (const render::Ray& ray : AllRays(64)) {
    EXPECT_EQ(ray.origin_enu, kEye);
    EXPECT_NEAR(ray.direction_enu.norm(), 1.0, 1e-15);
  }
}

TEST(PanoramaRays, NorthIsInTheMiddleAndEastToTheRight) {
  constexpr int kWidth = 400, kHeight = 200;
  const std::vector<render::Ray> rays = AllRays(kWidth);
  const auto at = [&](int column, int row) { return rays[static_cast<size_t>(row * kWidth + column)].direction_enu; };
  const double half_pixel = std::numbers::pi / kWidth;
  const int horizon = kHeight / 2;
  // Columns and rows meet at the horizon and at the cardinal directions, so both neighbours are half a pixel from them.
  for (const int side : {-1, 0}) {
    const double to_right = (side + 0.5) * 2.0 * half_pixel, down = to_right;
    const Eigen::Vector3d north = at(kWidth / 2 + side, horizon + side);
    EXPECT_NEAR(std::atan2(north.x(), north.y()), to_right, 1e-12);
    EXPECT_NEAR(std::asin(north.z()), -down, 1e-12);
    const Eigen::Vector3d east = at(3 * kWidth / 4 + side, horizon);
    EXPECT_NEAR(std::atan2(-east.y(), east.x()), to_right, 1e-12);
    const Eigen::Vector3d west = at(kWidth / 4 + side, horizon);
    EXPECT_NEAR(std::atan2(west.y(), -west.x()), to_right, 1e-12);
  }
  EXPECT_LT(at(0, horizon).y(), -0.99) << "south at the left end";
  EXPECT_LT(at(kWidth - 1, horizon).y(), -0.99) << "and at the right end";
  EXPECT_NEAR(std::asin(at(7, 0).z()), 0.5 * std::numbers::pi - half_pixel, 1e-9) << "the top row looks up";
  EXPECT_NEAR(std::asin(at(7, kHeight - 1).z()), -0.5 * std::numbers::pi + half_pixel, 1e-9) << "the bottom row down";
}

// The last column is as far from the first one as any two neighbours are.
TEST(PanoramaRays, TheEndsMeet) {
  constexpr int kWidth = 96;
  const std::vector<render::Ray> rays = AllRays(kWidth);
  for (size_t row = 0; row < kWidth / 2; ++row) {
    const auto azimuth = [&](size_t column) {
      const Eigen::Vector3d& d = rays[row * kWidth + column].direction_enu;
      return std::atan2(d.x(), d.y());
    };
    for (size_t column = 0; column < kWidth; ++column) {
      double step = azimuth((column + 1) % kWidth) - azimuth(column);
      if (step < 0.0) step += 2.0 * std::numbers::pi;
      EXPECT_NEAR(step, 2.0 * std::numbers::pi / kWidth, 1e-12);
    }
  }
}

// A pixel's own angle at the horizon, and nowhere narrower than the rows are apart.
TEST(PanoramaRays, ConesAreAsWideAsARow) {
  constexpr int kWidth = 128;
  for (const render::Ray& ray : AllRays(kWidth)) {
    EXPECT_FLOAT_EQ(ray.pixel_pitch, static_cast<float>(2.0 * std::numbers::pi / kWidth));
    EXPECT_EQ(ray.pixel_width, 0.0F);
  }
}

TEST(PanoramaOrder, HasEveryPixelOnceAndOneSideAfterTheOther) {
  constexpr int kWidth = 150;
  std::vector<size_t> order = PanoramaOrder(kWidth);
  // A quarter of the rays looks into hardly more than a quarter of all directions.
  size_t leftmost = kWidth, rightmost = 0;
  for (size_t i = 0; i < order.size() / 4; ++i) {
    leftmost = std::min(leftmost, order[i] % kWidth);
    rightmost = std::max(rightmost, order[i] % kWidth);
  }
  EXPECT_LE(rightmost - leftmost, 64U);
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
  EXPECT_EQ(order.size(), size_t{kWidth} * (kWidth / 2));
}

}  // namespace
}  // namespace skyquilt::tour
