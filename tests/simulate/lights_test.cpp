#include "simulate/lights.h"

#include <gtest/gtest.h>

#include <set>

#include "simulate/salt_marsh.h"
#include "simulate/world.h"

namespace skyquilt::simulate {
namespace {

std::vector<PhotoPlan> Flight(size_t n) {
  std::vector<PhotoPlan> photos(n);
  for (size_t i = 0; i < n; ++i) {
    photos[i].name = PhotoName(i);
    photos[i].time_s = 2.0 * static_cast<double>(i);
    photos[i].true_depth = i % 8 == 0;
  }
  return photos;
}

TEST(Lights, AreThoseOfTheOptions) {
  SimulateOptions options;
  options.place = "hamlet";
  options.light_intensity = 0.5;
  const PlaceSpec place = ResolvePlace(options);
  ASSERT_EQ(PlanLights(options, place).size(), 1U);
  EXPECT_EQ(PlanLights(options, place)[0].folder, "");
  EXPECT_EQ(PlanLights(options, place)[0].sun_elevation_deg, place.sun_elevation_deg);
  options.lights = "sun";
  std::vector<Light> lights = PlanLights(options, place);
  ASSERT_EQ(lights.size(), 17U);
  EXPECT_EQ(lights.front().folder, "sun_05");
  EXPECT_EQ(lights.back().folder, "sun_85");
  EXPECT_EQ(lights[1].sun_elevation_deg, 10.0);
  EXPECT_EQ(lights[1].intensity, 0.5);
  options.lights = "intensity";
  options.lights_every = 4;
  lights = PlanLights(options, place);
  ASSERT_EQ(lights.size(), 3U);
  EXPECT_EQ(lights[1].folder, "light_2.00");
  EXPECT_EQ(lights[1].intensity, 1.0);
  EXPECT_EQ(lights[1].sun_elevation_deg, place.sun_elevation_deg);
}

TEST(Lights, HaveTheSamePlacesInNameOrder) {
  const std::vector<Light> lights = {{"sun_05", 5.0, 1.0}, {"sun_10", 10.0, 1.0}, {"sun_15", 15.0, 1.0}};
  std::vector<PhotoPlan> photos = Flight(21);
  RepeatUnder(lights, 8, photos);
  ASSERT_EQ(photos.size(), 3U * 16U);
  std::set<std::string> held_out;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (i > 0) EXPECT_LT(photos[i - 1].name, photos[i].name);
    if (i > 0) EXPECT_LT(photos[i - 1].time_s, photos[i].time_s);
    EXPECT_EQ(photos[i].true_depth, i % 8 == 0) << photos[i].name;
    EXPECT_EQ(photos[i].finds_points, i < 16) << photos[i].name;
    if (i % 8 == 0) held_out.insert(photos[i].name.substr(photos[i].name.find('/')));
  }
  EXPECT_EQ(held_out.size(), 2U) << "other places are held out in another light";
  std::vector<PhotoPlan> alone = Flight(21);
  RepeatUnder({{"", 48.0, 1.0}}, 8, alone);
  EXPECT_EQ(alone.size(), 21U);
  EXPECT_EQ(alone[3].name, PhotoName(3));
}

// A world whose light was changed is one that was built with that light.
TEST(Lights, ChangeNothingButTheLightOfAWorld) {
  SimulateOptions options;
  options.place = "hamlet";
  base::ThreadPool threads(2);
  options.sun_elevation_deg = 20.0;
  const World low(ResolvePlace(options), 2.0, threads);
  options.sun_elevation_deg = 70.0;
  World changed(ResolvePlace(options), 1.0, threads);
  EXPECT_NE(changed.sky().sun_direction(), low.sky().sun_direction());
  changed.SetLight(20.0, 2.0, threads);
  EXPECT_EQ(changed.sky().sun_direction(), low.sky().sun_direction());
  EXPECT_EQ(changed.sky().sun_over_pi(), low.sky().sun_over_pi());
  const Eigen::Vector3f up(0.0F, 0.0F, 1.0F);
  EXPECT_EQ(changed.sky().Radiance(up), low.sky().Radiance(up));
}

TEST(SaltMarsh, GrowsAboveTheWater) {
  const auto ground_z = [](const Eigen::Vector2d& at) { return 0.01 * at.x(); };  // from -1 to 1
  const SaltMarsh marsh({-100.0, -100.0}, {100.0, 100.0}, ground_z, -0.62, 5U);
  EXPECT_EQ(marsh.trees().size(), 60U);
  int covered = 0, high = 0;
  for (int x = -100; x < 100; x += 2) {
    for (int y = -100; y < 100; y += 2) {
      const Eigen::Vector3f at(static_cast<float>(x), static_cast<float>(y), 0.01F * static_cast<float>(x));
      if (at.z() < -0.17F) {
        EXPECT_FALSE(marsh.Covers(at));
        continue;
      }
      ++high;
      if (marsh.Covers(at)) ++covered;
    }
  }
  EXPECT_GT(covered, high / 4);
  EXPECT_LT(covered, high);
  for (const Tree& tree : marsh.trees()) {
    EXPECT_GT(tree.ground_z_m, -0.02);
    EXPECT_EQ(tree.ground_z_m, ground_z(tree.position));
  }
}

}  // namespace
}  // namespace skyquilt::simulate
