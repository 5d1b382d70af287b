#include "bench/study/light_scores.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/light_parts.h"

namespace skyquilt::bench {
namespace {

image::Image8 Filled(uint8_t value, int channels = 3) {
  image::Image8 image(4, 2, channels);
  std::fill(image.data.begin(), image.data.end(), value);
  return image;
}

void Set(image::Image8& image, int x, uint8_t value) {
  for (int c = 0; c < 3; ++c) image.At(x, 0)[c] = value;
}

// The shadow is at x = 0, then 1, then 2.
struct MovingShadow {
  image::Image8 below = Filled(200), photo = Filled(200), above = Filled(200);
  MovingShadow() {
    Set(below, 0, 100);
    Set(photo, 1, 100);
    Set(above, 2, 100);
  }
};

TEST(LightScores, AFadingShadowFollowsNothingAndAMovingOneAll) {
  const MovingShadow shadow;
  const image::Image8 all = Filled(1, 1);
  image::Image8 fading = Filled(200);
  Set(fading, 0, 150);
  Set(fading, 2, 150);
  const MovedSums faded = CompareMoved(shadow.below, shadow.photo, shadow.above, fading, all);
  EXPECT_EQ(faded.pixels, 8);
  EXPECT_EQ(faded.moved, 3);
  EXPECT_NEAR(faded.along / faded.whole, 0.0, 1e-12);
  const MovedSums moved = CompareMoved(shadow.below, shadow.photo, shadow.above, shadow.photo, all);
  EXPECT_NEAR(moved.along / moved.whole, 1.0, 1e-12);
  EXPECT_EQ(moved.squared_error, 0.0);
  EXPECT_GT(faded.squared_error, 0.0);
  image::Image8 some = all;
  *some.At(1, 0) = 0;
  EXPECT_EQ(CompareMoved(shadow.below, shadow.photo, shadow.above, fading, some).moved, 2);
}

TEST(LightScores, PixelsOfTheMeanBrightnessHaveNotMoved) {
  const MovedSums sums = CompareMoved(Filled(100), Filled(140), Filled(180), Filled(0), Filled(1, 1));
  EXPECT_EQ(sums.pixels, 8);
  EXPECT_EQ(sums.moved, 0);
}

TEST(PlanLooks, MixesTheTrainedNeighboursByDistance) {
  const std::vector<std::string> lights = {"a", "b", "c", "d", "e"};
  const std::vector<LookPlan> plans = PlanLooks(lights, {true, false, false, true, false}, true);
  const auto look_of = [&plans](size_t light, const std::string& kind) -> std::string {
    for (const LookPlan& plan : plans) {
      for (const auto& [of, how] : plan.shown_for) {
        if (of == light && how == kind) return plan.look;
      }
    }
    return "none";
  };
  EXPECT_EQ(look_of(0, kOwnLook), "a");
  EXPECT_EQ(look_of(1, kLowerLook), "a");
  EXPECT_EQ(look_of(2, kUpperLook), "d");
  EXPECT_EQ(look_of(3, kOwnLook), "d");
  EXPECT_EQ(look_of(4, kLowerLook), "d");
  EXPECT_EQ(look_of(4, kBetweenLook), "none");
  EXPECT_EQ(look_of(1, kBetweenLook).substr(0, 5), "a:0.6");
  EXPECT_EQ(look_of(2, kBetweenLook).substr(0, 5), "a:0.3");
  EXPECT_EQ(PlanLooks(lights, std::vector<bool>(5, true), false).size(), 1U);
  EXPECT_EQ(PlanLooks(lights, std::vector<bool>(5, true), false)[0].shown_for.size(), 5U);
  EXPECT_EQ(PlanLooks(lights, std::vector<bool>(5, true), true).size(), 5U);
}

LightSet Shadows(double lower, double upper, double mixed, double own) {
  LightSet set;
  set.lights = {"sun_05", "sun_10", "sun_15"};
  set.every_second.lights = {
      {.light = "sun_10", .look = kBetweenLook, .psnr_db = 20.0, .moved_share = 0.1, .followed = mixed},
      {.light = "sun_10", .look = kLowerLook, .psnr_db = 19.0, .followed = lower},
      {.light = "sun_10", .look = kUpperLook, .psnr_db = 18.0, .followed = upper},
  };
  set.all.lights = {{.light = "sun_10", .look = kOwnLook, .psnr_db = 21.0, .followed = own}};
  set.plain.lights = {{.light = "sun_10", .look = kNoLook, .psnr_db = 15.0}};
  return set;
}

TEST(LightVerdicts, SayWhetherShadowsFadeOrMove) {
  EXPECT_NEAR(MovementOfShadows(Shadows(0.3, -0.1, 0.2, 0.5)), 0.25, 1e-12);
  EXPECT_NE(SunVerdicts(Shadows(0.3, -0.1, 0.2, 0.5))[1].find("25 % of the way"), std::string::npos);
  EXPECT_NE(SunVerdicts(Shadows(0.3, -0.1, 0.2, 0.5))[1].find("fade more than they move"), std::string::npos);
  EXPECT_NE(SunVerdicts(Shadows(0.1, 0.1, 0.7, 0.8))[1].find("move more than they fade"), std::string::npos);
  EXPECT_NE(SunVerdicts(Shadows(0.1, 0.1, 0.1, 0.2))[1].find("hardly held by codes"), std::string::npos);
  EXPECT_NE(SunVerdicts(Shadows(0.1, 0.1, LightScore::kNone, 0.2))[0].find("nothing is said"), std::string::npos);
}

TEST(LightVerdicts, TellTheStopsThatWereFound) {
  LightSet set;
  set.lights = {"light_1.00", "light_2.00", "light_4.00"};
  for (const auto& [light, stops] : {std::pair{"light_1.00", -0.5}, {"light_2.00", 0.0}, {"light_4.00", 0.5}}) {
    set.corrected.lights.push_back({.light = light, .look = kNoLook, .psnr_db = 25.0, .stops = stops});
    set.plain.lights.push_back({.light = light, .look = kNoLook, .psnr_db = 20.0});
    set.all.lights.push_back({.light = light, .look = kOwnLook, .psnr_db = 26.0});
  }
  EXPECT_NE(IntensityVerdicts(set)[0].find("finds 50 % of the stops"), std::string::npos) << IntensityVerdicts(set)[0];
  EXPECT_EQ(LightTable(set, "intensity", "intensity").rows.size(), 3U);
  EXPECT_EQ(LightTable(set, "intensity", "intensity").rows[0].size(), LightTable(set, "intensity", "intensity").columns.size());
}

}  // namespace
}  // namespace skyquilt::bench
