#include "core/scene/surround.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace skyquilt::scene {
namespace {

constexpr int kCells = 10;
constexpr double kCell_m = 10.0;

// Red ground at height 0, x and y from 0 to 100 m; the cells of column c are shown by c photos.
Background Ground() {
  Background background;
  const geo::PlaneGrid grid({0.0, 0.0}, kCell_m, kCells, kCells);
  background.surface = HeightMap(grid, std::vector<double>(grid.size(), 0.0));
  for (size_t i = 0; i < grid.size(); ++i) {
    background.rgb_srgb.insert(background.rgb_srgb.end(), {1.0F, 0.0F, 0.0F});
    background.photos.push_back(static_cast<uint8_t>(i % kCells));
  }
  background.mean_srgb = {0.6F, 0.3F, 0.3F};
  return background;
}

double Furthest(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  double most = 0.0;
  for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(static_cast<double>(a[c]) - static_cast<double>(b[c])));
  return most;
}

TEST(Surround, TrustsGroundThatThreePhotosShow) {
  const Background ground = Ground();
  const Surround surround(ground);
  EXPECT_EQ(surround.SeenShare({5.0, 50.0}), 0.0) << "no photo";
  EXPECT_EQ(surround.SeenShare({15.0, 50.0}), 0.0) << "one";
  EXPECT_NEAR(surround.SeenShare({25.0, 50.0}), 0.5, 1e-9) << "two";
  EXPECT_EQ(surround.SeenShare({35.0, 50.0}), 1.0) << "three";
  EXPECT_EQ(surround.SeenShare({85.0, 50.0}), 1.0);
  EXPECT_EQ(surround.SeenShare({85.0, -21.0}), 0.0) << "beyond the map";
  EXPECT_GT(surround.SeenShare({85.0, -10.0}), 0.0) << "the edge has no step";

  const Eigen::Vector3d down(0.0, 0.0, -1.0);
  EXPECT_EQ(surround.Behind({85.0, 50.0, 20.0}, down), ground.Color({85.0, 50.0, 20.0}, down));
  const std::array<float, 3> plain = surround.Behind({5.0, 50.0, 20.0}, down);
  EXPECT_LT(Furthest(plain, ground.mean_srgb), 0.15) << "near the survey's mean";
  EXPECT_LT(plain[0] - plain[1], 0.5F * (ground.mean_srgb[0] - ground.mean_srgb[1])) << "but greyer";
}

TEST(Surround, GroundBecomesSkyWithoutAStepAtTheHorizon) {
  const Background ground = Ground();
  const Surround surround(ground);
  const auto at = [&](double slope) { return surround.Behind({50.0, 50.0, 30.0}, {1.0, 0.0, slope}); };
  EXPECT_LT(Furthest(at(-1e-4), at(1e-4)), 0.02);
  EXPECT_GT(Furthest(at(-0.5), at(1e-4)), 0.1);
  EXPECT_GT(at(5.0)[2], at(5.0)[0]) << "blue above";
  Background seen_sky = ground;
  seen_sky.sky_srgb.assign(size_t{3} * Background::kSkyRows * Background::kSkyColumns, 0.25F);
  EXPECT_EQ(Surround(seen_sky).Behind({50.0, 50.0, 30.0}, {1.0, 0.0, 1.0})[0], 0.25F) << "the photos' own sky";
}

TEST(Surround, WithoutNumbersOfPhotosTheWholeMapIsTrusted) {
  Background ground = Ground();
  ground.photos.clear();
  EXPECT_EQ(Surround(ground).SeenShare({5.0, 50.0}), 1.0);
  EXPECT_EQ(Surround(ground).SeenShare({-25.0, 50.0}), 0.0);
  render::RayColor beyond{.rgb_srgb = {0.5F, 0.5F, 0.5F}, .opacity = 1.0F, .depth = 20.0F, .depth_median = 20.0F};
  Surround(ground).Fade({.origin_enu = {-60.0, 50.0, 20.0}, .direction_enu = {0.0, 0.0, -1.0}}, &beyond);
  EXPECT_EQ(beyond.opacity, 1.0F) << "a wall behind the ground that level photos show";
  const Background flat{.surface = {}, .rgb_srgb = {}, .mean_srgb = {0.1F, 0.2F, 0.3F}};
  EXPECT_EQ(Surround(flat).SeenShare({1e6, 0.0}), 1.0);
  EXPECT_EQ(Surround(flat).Behind({0.0, 0.0, 0.0}, {1.0, 0.0, 1.0}), flat.mean_srgb);
}

RC_GTEST_PROP(Surround, OnlyTakesAwayAndKeepsDepths, ()) {
  const Background ground = Ground();
  const Surround surround(ground);
  const auto number = [](int low, int high) { return 0.01 * *rc::gen::inRange(100 * low, 100 * high); };
  const render::Ray ray{.origin_enu = {number(-50, 150), number(-50, 150), 40.0}, .direction_enu = {0.0, 0.6, -0.8}};
  render::RayColor color;
  color.opacity = static_cast<float>(number(0, 1));
  for (float& value : color.rgb_srgb) value = color.opacity * static_cast<float>(number(0, 1));
  color.depth = color.depth_median = static_cast<float>(number(10, 60));
  if (*rc::gen::inRange(0, 2) == 1) color.depth_median = std::nanf("");
  const render::RayColor before = color;
  surround.Fade(ray, &color);
  const double share = surround.SeenShare((ray.origin_enu + static_cast<double>(before.depth) * ray.direction_enu).head<2>());
  RC_ASSERT(share >= 0.0 && share <= 1.0);
  RC_ASSERT(std::abs(color.opacity - static_cast<float>(share) * before.opacity) < 1e-6F);
  for (int c = 0; c < 3; ++c) RC_ASSERT(std::abs(color.rgb_srgb[c] - static_cast<float>(share) * before.rgb_srgb[c]) < 1e-6F);
  RC_ASSERT(color.depth == before.depth);
}

}  // namespace
}  // namespace skyquilt::scene
