#include "simulate/cloud_shadows.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "simulate/place_spec.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {
namespace {

const Eigen::Vector3f kToSun = Eigen::Vector3f(0.3F, -0.4F, 0.8F).normalized();
constexpr CloudShadowSpec kSpec = {.stops = 1.0, .size_m = 100.0, .penumbra_m = 30.0, .speed_mps = 5.0, .cover = 0.4};

TEST(CloudShadows, CoverTheWantedShareAndTakeTheWantedLight) {
  const CloudShadows clouds(kSpec, kToSun, 7U);
  double shadow = 0.0, n = 0.0;
  float least = 1.0F, most = 0.0F;
  for (float x = 0.0F; x < 4000.0F; x += 23.0F) {
    for (float y = 0.0F; y < 4000.0F; y += 23.0F) {
      const float share = clouds.SunShare({x, y, 0.0F});
      least = std::min(least, share);
      most = std::max(most, share);
      shadow += static_cast<double>(-std::log2(share));
      n += 1.0;
    }
  }
  EXPECT_FLOAT_EQ(least, 0.5F);
  EXPECT_FLOAT_EQ(most, 1.0F);
  EXPECT_NEAR(shadow / n, 0.4, 0.06);
}

TEST(CloudShadows, EdgesAreAsWideAsAskedFor) {
  // Nowhere steeper than the middle of a smooth step of 30 m.
  const CloudShadows clouds(kSpec, kToSun, 7U);
  float steepest = 0.0F;
  for (float y = 0.0F; y < 1500.0F; y += 11.0F) {
    for (float x = 0.0F; x < 1500.0F; x += 2.0F) {
      const float before = -std::log2(clouds.SunShare({x, y, 0.0F})), after = -std::log2(clouds.SunShare({x + 1.0F, y, 0.0F}));
      steepest = std::max(steepest, std::abs(after - before));
    }
  }
  EXPECT_LT(steepest, 2.0F * 1.5F / 30.0F);  // distances to the edges are of first order
  EXPECT_GT(steepest, 0.7F * 1.5F / 30.0F);
}

TEST(CloudShadows, LieAlongTheRaysToTheSunAndDriftWithTheWind) {
  const CloudShadows clouds(kSpec, kToSun, 7U), later = clouds.At(10.0);
  const Eigen::Vector3f place(140.0F, 220.0F, 0.0F);
  EXPECT_NEAR(clouds.SunShare(place), clouds.SunShare(place + 60.0F * kToSun), 1e-4F);
  // 50 m on, in one direction for all places: the nearest fit over directions is exact.
  float best = 1e9F;
  for (int degrees = 0; degrees < 360; ++degrees) {
    const float angle = static_cast<float>(degrees) * 0.0174533F;
    float worst = 0.0F;
    for (float x = 0.0F; x < 900.0F; x += 37.0F) {
      const Eigen::Vector3f at(x, 0.7F * x, 0.0F);
      worst = std::max(worst, std::abs(later.SunShare(at + 50.0F * Eigen::Vector3f(std::cos(angle), std::sin(angle), 0.0F)) - clouds.SunShare(at)));
    }
    best = std::min(best, worst);
  }
  EXPECT_LT(best, 0.02F);
}

TEST(CloudShadows, NoneByDefaultAndNoneInARoom) {
  EXPECT_EQ(CloudShadows().SunShare({1.0F, 2.0F, 3.0F}), 1.0F);
  EXPECT_EQ(CloudShadows({}, kToSun, 7U).At(9.0).SunShare({1.0F, 2.0F, 3.0F}), 1.0F);
  SimulateOptions options;
  options.flight = "room";
  options.cloud_shadows = 1.0;
  try {
    ResolvePlace(options);
    FAIL() << "clouds in a room";
  } catch (const base::UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("cloud_shadows"), std::string::npos) << error.what();
  }
  options.flight = "survey";
  options.cloud_cover = 1.0;
  EXPECT_THROW(ResolvePlace(options), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::simulate
