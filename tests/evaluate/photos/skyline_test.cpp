#include "evaluate/photos/skyline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace skyquilt::evaluate::photos {
namespace {

Eigen::Vector3d Towards(double azimuth_deg, double elevation_deg) {
  constexpr double kRadPerDeg = 0.017453292519943295;
  const double a = azimuth_deg * kRadPerDeg, e = elevation_deg * kRadPerDeg;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

TEST(Skyline, IsTheHighestPointOnEachSide) {
  const Eigen::Vector3d eye(5.0, -3.0, 2.0);
  const std::vector<survey::SparsePoint> points = {{.x_in_enu = eye + 10.0 * Towards(90.3, 20.0)},
                                                   {.x_in_enu = eye + 90.0 * Towards(90.3, 10.0)},
                                                   {.x_in_enu = eye + 20.0 * Towards(-179.9, 30.0)},
                                                   {.x_in_enu = eye}};
  const Skyline skyline(points, eye);
  EXPECT_FALSE(skyline.IsAbove(Towards(90.0, 19.0)));
  EXPECT_TRUE(skyline.IsAbove(Towards(90.0, 21.0)));
  EXPECT_TRUE(skyline.IsAbove(3.0 * Towards(90.0, 21.0))) << "of any length";
  EXPECT_FALSE(skyline.IsAbove(Towards(91.6, 19.0))) << "just beside it";
  EXPECT_TRUE(skyline.IsAbove(Towards(94.0, 1.0)));
  EXPECT_FALSE(skyline.IsAbove(Towards(94.0, -1.0))) << "falls";
  EXPECT_FALSE(skyline.IsAbove(Towards(179.5, 29.0))) << "the sides go all round";
  EXPECT_TRUE(skyline.IsAbove(Towards(179.5, 31.0)));
}

TEST(Skyline, WithoutPointsIsTheHorizon) {
  const Skyline skyline({}, Eigen::Vector3d::Zero());
  EXPECT_TRUE(skyline.IsAbove(Towards(10.0, 0.5)));
  EXPECT_FALSE(skyline.IsAbove(Towards(10.0, 0.0)));
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
