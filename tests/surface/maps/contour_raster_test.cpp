#include "surface/maps/contour_raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/base/random.h"
#include "surface/maps/hillshade.h"

namespace skyquilt::surface {
namespace {

HeightRaster Raster(int width, int height, double resolution_m, const std::function<double(double, double)>& z) {
  HeightRaster raster;
  raster.grid = {.georeferenced = false, .zone = {}, .left = 0.0, .top = 0.0, .resolution_m = resolution_m, .width = width, .height = height};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector2d at = raster.grid.CellCentre(column, row);
      raster.height_m.push_back(static_cast<float>(z(at.x(), at.y())));
    }
  }
  return raster;
}

TEST(NiceNumber, IsTheNextOneTwoOrFive) {
  EXPECT_EQ(NiceNumberAbove(0.1), 0.1);
  EXPECT_EQ(NiceNumberAbove(0.11), 0.2);
  EXPECT_EQ(NiceNumberAbove(0.21), 0.5);
  EXPECT_EQ(NiceNumberAbove(0.51), 1.0);
  EXPECT_EQ(NiceNumberAbove(1.0), 1.0);
  EXPECT_EQ(NiceNumberAbove(37.0), 50.0);
  EXPECT_EQ(NiceNumberAbove(0.0031), 0.005);
}

TEST(ContourRaster, PlanesStayPlanes) {
  const auto plane = [](double x, double y) { return 100.0 + 0.2 * x + 0.1 * y; };
  const HeightRaster terrain = Raster(202, 101, 0.1, plane);
  const ContourRaster contours = MakeContourRaster(terrain, {}, 0.5);
  EXPECT_EQ(contours.heights.grid.width, 40);
  EXPECT_EQ(contours.heights.grid.height, 20);
  EXPECT_DOUBLE_EQ(contours.heights.grid.resolution_m, 0.5);
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column) {
      const Eigen::Vector2d at = contours.heights.grid.CellCentre(column, row);
      EXPECT_NEAR(contours.heights.height_m[static_cast<size_t>(row * 40 + column)], plane(at.x(), at.y()), 1e-3);
    }
  }
}

TEST(ContourRaster, IntervalFitsReliefAndNoise) {
  const auto interval = [](double relief_m, double noise_m) {
    base::Random random(3);
    const HeightRaster terrain = Raster(200, 200, 1.0, [&](double x, double) { return relief_m * x / 200.0 + noise_m * random.Normal(); });
    return MakeContourRaster(terrain, {}, 1.0).interval_m;
  };
  EXPECT_EQ(interval(0.0, 0.0), 0.1);
  EXPECT_EQ(interval(1.0, 0.0), 0.1);
  EXPECT_EQ(interval(19.0, 0.0), 0.5);
  EXPECT_EQ(interval(300.0, 0.0), 10.0);
  EXPECT_EQ(interval(1.0, 0.2), 1.0);
}

TEST(ContourRaster, MaskAndGapsAreLeftOut) {
  HeightRaster terrain = Raster(20, 20, 1.0, [](double, double) { return 5.0; });
  std::vector<uint8_t> mask(400, 1);
  mask[0] = 0;
  terrain.height_m[399] = std::numeric_limits<float>::quiet_NaN();
  const ContourRaster contours = MakeContourRaster(terrain, mask, 1.0);
  for (size_t i = 0; i < 400; ++i) EXPECT_EQ(std::isnan(contours.heights.height_m[i]), i == 0 || i == 399) << i;
  const HeightRaster one = Raster(1, 1, 1.0, [](double, double) { return 5.0; });
  EXPECT_EQ(MakeContourRaster(one, {}, 10.0).heights.height_m, std::vector<float>{5.0F});
}

TEST(Hillshade, FollowsTheLight) {
  base::ThreadPool threads(2);
  const auto shade_of = [&](double east, double north) {
    const HeightRaster raster = Raster(9, 9, 0.5, [&](double x, double y) { return east * x + north * y; });
    const std::vector<uint8_t> shade = Hillshade(raster, threads);
    for (const uint8_t value : shade) EXPECT_EQ(value, shade[0]);  // also at the edge
    return static_cast<int>(shade[40]);
  };
  EXPECT_EQ(shade_of(0.0, 0.0), 181);
  // A slope of 45 degrees that falls to the north-west faces the light; its opposite is in the shade.
  EXPECT_EQ(shade_of(std::sqrt(0.5), -std::sqrt(0.5)), 255);
  EXPECT_EQ(shade_of(-std::sqrt(0.5), std::sqrt(0.5)), 1);
  EXPECT_GT(shade_of(0.3, 0.0), 181);
  EXPECT_LT(shade_of(0.0, 0.3), 181);
}

TEST(Hillshade, GapsHaveNoValue) {
  base::ThreadPool threads(1);
  HeightRaster raster = Raster(5, 5, 1.0, [](double x, double) { return 0.4 * x; });
  const std::vector<uint8_t> whole = Hillshade(raster, threads);
  raster.height_m[12] = std::numeric_limits<float>::quiet_NaN();
  raster.height_m[3] = std::numeric_limits<float>::infinity();
  const std::vector<uint8_t> shade = Hillshade(raster, threads);
  for (size_t i = 0; i < 25; ++i) EXPECT_EQ(shade[i], i == 12 || i == 3 ? 0 : whole[i]) << i;
  EXPECT_EQ(Hillshade(Raster(1, 1, 1.0, [](double, double) { return 3.0; }), threads), std::vector<uint8_t>{181});
}

}  // namespace
}  // namespace skyquilt::surface
