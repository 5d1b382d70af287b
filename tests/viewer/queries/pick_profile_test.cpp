#include <gtest/gtest.h>

#include "tests/viewer/queries/analytic_field.h"

namespace skyquilt::viewer {
namespace {

PickRequest PickAlong(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  PickRequest pick;
  pick.id = 7;
  pick.origin_enu = origin;
  pick.direction_enu = direction.normalized();
  pick.pixel_pitch = 0.001;
  return pick;
}

TEST(DepthSpreads, AreStandardDeviationsOfTheDepth) {
  render::RayColor color;
  color.depth_front = 9.0F;
  color.depth_median = 10.0F;
  color.depth_back = 13.0F;
  EXPECT_NEAR(DepthSpread(color), 4.0 / 2.0729, 1e-4);
  color.depth_back = std::nanf("");
  EXPECT_NEAR(DepthSpread(color), 1.0 / 1.03643, 1e-4) << "of its front half";
  color.depth_median = std::nanf("");
  EXPECT_TRUE(std::isnan(DepthSpread(color)));
}

TEST(Pick, FindsTheSurface) {
  const FieldAccess access = AccessTo(FieldOf(GroundAndBoxes({{{-5, -5, 0}, {5, 5, 8}}}), 0.02));
  const nlohmann::json roof = AnswerOf(*MakePick(PickAlong({1, 2, 50}, {0.001, 0.002, -1})), access);
  EXPECT_EQ(roof["type"], "picked");
  EXPECT_EQ(roof["id"], 7);
  EXPECT_EQ(roof["hit"], true);
  EXPECT_NEAR(roof["point"][2].get<double>(), 8.0, 1e-5);
  EXPECT_NEAR(roof["point"][0].get<double>(), 1.042, 1e-5);
  EXPECT_NEAR(roof["depth_m"].get<double>(), 42.0, 1e-3);
  EXPECT_NEAR(roof["spread_m"].get<double>(), 0.02, 1e-5);
  EXPECT_EQ(roof["opacity"], 1.0);
  const nlohmann::json sky = AnswerOf(*MakePick(PickAlong({1, 2, 50}, {0, 0.3, 1})), access);
  EXPECT_EQ(sky["hit"], false);
  EXPECT_TRUE(sky["point"].is_null());
}

TEST(Pick, AsksTheProjectThatIsMeant) {
  PickRequest pick = PickAlong({0, 0, 50}, {0, 0, -1});
  const Surface low = Above([](double, double) { return 1.0; }), high = Above([](double, double) { return 3.0; });
  EXPECT_NEAR(AnswerOf(*MakePick(pick), AccessTo(FieldOf(low), FieldOf(high)))["point"][2].get<double>(), 1.0, 1e-5);
  pick.project = Which::kBefore;
  EXPECT_NEAR(AnswerOf(*MakePick(pick), AccessTo(FieldOf(low), FieldOf(high)))["point"][2].get<double>(), 3.0, 1e-5);
  EXPECT_THROW(AnswerOf(*MakePick(pick), AccessTo(FieldOf(low))), BadMessage);
  pick.project = Which::kMain;
  EXPECT_THROW(AnswerOf(*MakePick(pick), AccessTo({})), BadMessage);
}

// A top view whose eye is below a roof shows the roof.
TEST(Pick, OfAnOrthographicViewSeesWhatIsBehindTheEye) {
  PickRequest pick = PickAlong({1, 2, 3}, {0, 0, -1});
  pick.pixel_pitch = 0.0;
  pick.pixel_width_m = 0.1;
  const nlohmann::json roof = AnswerOf(*MakePick(pick), AccessTo(FieldOf(GroundAndBoxes({{{-5, -5, 0}, {5, 5, 8}}}))));
  EXPECT_NEAR(roof["point"][2].get<double>(), 8.0, 1e-4);
  EXPECT_NEAR(roof["depth_m"].get<double>(), -5.0, 1e-4);
}

ProfileRequest ProfileOf(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int samples) {
  ProfileRequest profile;
  profile.id = 8;
  profile.from_enu = from;
  profile.to_enu = to;
  profile.samples = samples;
  return profile;
}

TEST(Profile, ShowsAStepAndItsPlace) {
  const auto step = [](double x, double) -> std::optional<double> { return x < 3.0 ? 2.0 : -1.5; };
  FieldAccess access = AccessTo(FieldOf(Above(step), 0.1));
  access.batch = 7;
  const nlohmann::json profile = AnswerOf(*MakeProfile(ProfileOf({0, 0}, {8, 6}, 41)), access);
  EXPECT_EQ(profile["length_m"], 10.0);
  ASSERT_EQ(profile["heights_m"].size(), 41U);
  ASSERT_EQ(profile["spreads_m"].size(), 41U);
  for (int i = 0; i < 41; ++i) {
    // x = 0.2 i; the step is between the samples 14 and 15.
    EXPECT_NEAR(profile["heights_m"][static_cast<size_t>(i)].get<double>(), i < 15 ? 2.0 : -1.5, 1e-4) << i;
    EXPECT_NEAR(profile["spreads_m"][static_cast<size_t>(i)].get<double>(), 0.1, 1e-4);
  }
}

TEST(Profile, HasBothEndsAndGaps) {
  const auto slope = [](double x, double) -> std::optional<double> {
    if (x > 4.0 && x < 6.0) return {};
    return 0.5 * x;
  };
  const nlohmann::json profile = AnswerOf(*MakeProfile(ProfileOf({-10, 3}, {10, 3}, 5)), AccessTo(FieldOf(Above(slope))));
  EXPECT_NEAR(profile["heights_m"][0].get<double>(), -5.0, 1e-5);
  EXPECT_NEAR(profile["heights_m"][4].get<double>(), 5.0, 1e-5);
  EXPECT_TRUE(profile["heights_m"][3].is_null());
  EXPECT_TRUE(profile["spreads_m"][3].is_null());
}

TEST(Profile, RaysAreColumnsOfASampleButNotFinerThanThePhotos) {
  std::vector<float> widths;
  const RayCaster note = [&](std::span<const render::Ray> rays, std::span<render::RayColor>) {
    for (const render::Ray& ray : rays) widths.push_back(ray.pixel_width);
    EXPECT_GT(rays.front().origin_enu.z(), 30.0) << "from above the scene";
    EXPECT_GT(rays.front().t_far, 50.0) << "to its bottom";
  };
  AnswerOf(*MakeProfile(ProfileOf({0, 0}, {10, 0}, 101)), AccessTo(note));
  EXPECT_FLOAT_EQ(widths[0], 0.05F);
  AnswerOf(*MakeProfile(ProfileOf({0, 0}, {1, 0}, 101)), AccessTo(note));
  EXPECT_FLOAT_EQ(widths.back(), 0.01F);
}

TEST(Questions, AboutASceneOfUnknownSizeAreRefused) {
  FieldAccess access = AccessTo(FieldOf(Above([](double, double) { return 0.0; })));
  access.max_enu.z() = std::nan("");
  EXPECT_THROW(AnswerOf(*MakeProfile(ProfileOf({0, 0}, {1, 0}, 2)), access), BadMessage);
}

}  // namespace
}  // namespace skyquilt::viewer
