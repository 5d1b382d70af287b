#include "simulate/place_spec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "core/base/errors.h"
#include "simulate/simulate.h"
#include "tests/support/error_of.h"

namespace skyquilt::simulate {
namespace {

TEST(Presets, EveryNameResolvesToUsableNumbers) {
  const std::vector<std::string> names = PlaceNames();
  for (const char* wanted : {"hamlet", "town", "smallcity", "tidalflat", "solar_farm"})
    EXPECT_NE(std::find(names.begin(), names.end(), wanted), names.end());
  for (const std::string& name : names) {
    SimulateOptions options;
    options.place = name;
    const PlaceSpec place = ResolvePlace(options);
    EXPECT_EQ(place.name, name);
    EXPECT_EQ(place.camera.Problem(), "");
    EXPECT_EQ(place.altitudes_agl_m.size(), static_cast<size_t>(place.rows * place.columns));
  }
}

TEST(Presets, SmallCityFliesTheMatrixCityHeights) {
  SimulateOptions options;
  options.place = "smallcity";
  EXPECT_EQ(ResolvePlace(options).altitudes_agl_m, (std::vector<double>{150, 150, 300, 500, 450, 450, 350, 350, 250, 200}));
}

TEST(Presets, OptionsAreLaidOver) {
  SimulateOptions options;
  options.place = "town";
  options.image_width = 320;
  options.forward_overlap = 0.6;
  options.altitudes = {120.0};
  options.gps_noise_m = 0.0;
  options.oblique = false;
  const PlaceSpec place = ResolvePlace(options);
  EXPECT_EQ(place.camera.width, 320);
  EXPECT_EQ(place.camera.height, 180);
  EXPECT_EQ(place.forward_overlap, 0.6);
  EXPECT_EQ(place.altitudes_agl_m, (std::vector<double>{120.0, 120.0, 120.0, 120.0}));
  EXPECT_EQ(place.gps_noise_m, 0.0);
  EXPECT_EQ(place.oblique_lines, 0);
}

TEST(Presets, LightIsAsTheTagsTellUnlessAskedFor) {
  SimulateOptions options;
  const PlaceSpec plain = ResolvePlace(options);
  EXPECT_EQ(plain.exposure_offset_stops, 0.0);
  EXPECT_EQ(plain.exposure_error_stops, 0.0);
  EXPECT_EQ(plain.color_drift_stops, 0.0);
  EXPECT_EQ(plain.vignetting, 0.0);
  EXPECT_EQ(plain.exposure_tags, ExposureTags::kAll);
  options.exposure_offset_stops = -10.0;
  options.exposure_error_stops = 3.0;
  options.color_drift_stops = 0.5;
  options.vignetting = 0.9;
  options.exposure_tags = "half";
  const PlaceSpec changed = ResolvePlace(options);
  EXPECT_EQ(changed.exposure_offset_stops, -10.0);
  EXPECT_EQ(changed.exposure_error_stops, 3.0);
  EXPECT_EQ(changed.color_drift_stops, 0.5);
  EXPECT_EQ(changed.vignetting, 0.9);
  EXPECT_EQ(changed.exposure_tags, ExposureTags::kHalf);
  options.exposure_tags = "none";
  EXPECT_EQ(ResolvePlace(options).exposure_tags, ExposureTags::kNone);
}

TEST(Presets, TagsAreRightUnlessAskedFor) {
  SimulateOptions options;
  const TagFaults none = ResolvePlace(options).tag_faults;
  EXPECT_EQ(none.lag_s, 0.0);
  EXPECT_EQ(none.drift_m, 0.0);
  EXPECT_EQ(none.jump_m, 0.0);
  EXPECT_EQ(none.outlier_share, 0.0);
  EXPECT_EQ(none.bias_m, 0.0);
  EXPECT_EQ(none.height_offset_m, 0.0);
  EXPECT_EQ(none.heights, HeightTags::kTrue);
  EXPECT_FALSE(none.swapped || none.equal || none.speed_tags);
  EXPECT_TRUE(none.gimbal_tags);
  EXPECT_EQ(none.gimbal_common_error_deg, 0.0);
  EXPECT_EQ(none.gimbal_random_error_deg, 0.0);
}

void ExpectRefused(const std::string& named, const std::function<void(SimulateOptions&)>& change) {
  SimulateOptions options;
  options.place = "town";
  change(options);
  const std::string error = UsageErrorOf([&] { ResolvePlace(options); });
  EXPECT_NE(error.find(named), std::string::npos) << named << ": " << error;
}

TEST(Presets, BadOptionsAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectRefused("place", [](SimulateOptions& o) { o.place = "metropolis"; });
  ExpectRefused("seed", [](SimulateOptions& o) { o.seed = -1; });
  ExpectRefused("image_width", [](SimulateOptions& o) { o.image_width = 3; });
  ExpectRefused("image_width", [](SimulateOptions& o) { o.image_width = -640; });
  ExpectRefused("forward_overlap", [](SimulateOptions& o) { o.forward_overlap = 1.0; });
  ExpectRefused("forward_overlap", [&](SimulateOptions& o) { o.forward_overlap = nan; });
  ExpectRefused("side_overlap", [](SimulateOptions& o) { o.side_overlap = 80.0; });
  ExpectRefused("altitudes", [](SimulateOptions& o) { o.altitudes = {80.0, 90.0}; });
  ExpectRefused("altitudes", [](SimulateOptions& o) { o.altitudes = {-80.0}; });
  ExpectRefused("altitudes", [&](SimulateOptions& o) { o.altitudes = {nan}; });
  ExpectRefused("exposure_offset_stops", [](SimulateOptions& o) { o.exposure_offset_stops = -10.1; });
  ExpectRefused("exposure_offset_stops", [](SimulateOptions& o) { o.exposure_offset_stops = 11.0; });
  ExpectRefused("exposure_offset_stops", [&](SimulateOptions& o) { o.exposure_offset_stops = nan; });
  // Each is possible alone.
  ExpectRefused("exposure_offset_stops", [](SimulateOptions& o) {
    o.exposure_offset_stops = -10.0;
    o.exposure_drift_stops = 4.0;
  });
  ExpectRefused("exposure_error_stops", [](SimulateOptions& o) { o.exposure_error_stops = -0.1; });
  ExpectRefused("exposure_error_stops", [](SimulateOptions& o) { o.exposure_error_stops = 3.1; });
  ExpectRefused("color_drift_stops", [](SimulateOptions& o) { o.color_drift_stops = -0.1; });
  ExpectRefused("color_drift_stops", [&](SimulateOptions& o) { o.color_drift_stops = nan; });
  ExpectRefused("vignetting", [](SimulateOptions& o) { o.vignetting = 0.95; });
  ExpectRefused("vignetting", [](SimulateOptions& o) { o.vignetting = -0.1; });
  ExpectRefused("city_yaw_deg", [](SimulateOptions& o) { o.city_yaw_deg = 361.0; });
  ExpectRefused("district_turn_deg", [](SimulateOptions& o) { o.district_turn_deg = 13.0; });
  ExpectRefused("exposure_tags", [](SimulateOptions& o) { o.exposure_tags = "some"; });
  ExpectRefused("all, half or none", [](SimulateOptions& o) { o.exposure_tags = ""; });
  ExpectRefused("latitude_deg", [](SimulateOptions& o) { o.latitude_deg = 91.0; });
  ExpectRefused("test_every", [](SimulateOptions& o) { o.test_every = 0; });
  ExpectRefused("samples_per_pixel", [](SimulateOptions& o) { o.samples_per_pixel = 5; });
  ExpectRefused("light_intensity", [](SimulateOptions& o) { o.light_intensity = 0.0; });
  ExpectRefused("tag_heights", [](SimulateOptions& o) { o.tag_heights = "wrong"; });
  ExpectRefused("tag_outliers", [](SimulateOptions& o) { o.tag_outliers = 1.0; });
  ExpectRefused("tag_lag_s", [](SimulateOptions& o) { o.tag_lag_s = 11.0; });
  ExpectRefused("gimbal_random_error_deg", [&](SimulateOptions& o) { o.gimbal_random_error_deg = nan; });
  ExpectRefused("jpeg_quality", [](SimulateOptions& o) { o.jpeg_quality = 101; });
  ExpectRefused("moving_cars", [](SimulateOptions& o) {
    o.place = "tidalflat";
    o.moving_cars = 2;
  });
  ExpectRefused("people", [](SimulateOptions& o) {
    o.place = "tidalflat";
    o.people = 2;
  });
  ExpectRefused("lamps", [](SimulateOptions& o) {
    o.place = "solar_farm";
    o.lamps = 2;
  });
  ExpectRefused("marsh", [](SimulateOptions& o) { o.marsh = true; });
  ExpectRefused("lights", [](SimulateOptions& o) { o.lights = "moon"; });
  ExpectRefused("class_images", [](SimulateOptions& o) { o.class_images = "some"; });
}

// A swapped longitude of more than 90 degrees is no latitude.
TEST(Presets, SwappedTagsNeedALongitudeThatCanBeALatitude) {
  const auto swapped = [](double latitude, double longitude) {
    return [=](SimulateOptions& o) {
      o.tags_swapped = true;
      o.latitude_deg = latitude;
      o.longitude_deg = longitude;
    };
  };
  ExpectRefused("tags_swapped", swapped(-33.9, 151.2));
  ExpectRefused("longitude_deg", swapped(46.8, -92.0));
  ExpectRefused("latitude_deg", swapped(89.0, 10.0));
  SimulateOptions options;
  swapped(47.0, 88.0)(options);
  EXPECT_TRUE(ResolvePlace(options).tag_faults.swapped);
}

TEST(Presets, AHillMustStayBelowTheFlight) {
  SimulateOptions options;
  options.place = "town";
  options.hillside_deg = 8.0;
  EXPECT_EQ(ResolvePlace(options).hillside_deg, 8.0);
  // The corner is 141 m from the middle: 75 m higher at 28 degrees.
  options.hillside_deg = 24.0;
  EXPECT_EQ(ResolvePlace(options).hillside_deg, 24.0);
  ExpectRefused("hillside_deg", [](SimulateOptions& o) { o.hillside_deg = 28.5; });
  options.hillside_deg = 28.5;
  options.altitudes = {120.0};
  EXPECT_EQ(ResolvePlace(options).hillside_deg, 28.5);
  // Only the block in the north-east is in danger.
  options.altitudes = {85.0, 85.0, 85.0, 120.0};
  EXPECT_EQ(ResolvePlace(options).hillside_deg, 28.5);
  options.altitudes = {120.0, 120.0, 120.0, 85.0};
  EXPECT_THROW(ResolvePlace(options), base::UsageError);
  ExpectRefused("hillside_deg", [](SimulateOptions& o) {
    o.place = "tidalflat";
    o.hillside_deg = 1.0;
  });
}

TEST(Presets, BuildingsArePlainUnlessAskedFor) {
  SimulateOptions options;
  EXPECT_FALSE(ResolvePlace(options).city.varied);
  EXPECT_EQ(ResolvePlace(options).city.tower_m, 0.0);
  options.building_shapes = "varied";
  EXPECT_TRUE(ResolvePlace(options).city.varied);
  ExpectRefused("building_shapes", [](SimulateOptions& o) { o.building_shapes = "round"; });
  ExpectRefused("building_shapes", [](SimulateOptions& o) {
    o.place = "tidalflat";
    o.building_shapes = "varied";
  });
}

TEST(Presets, SpecialCasesAreRefusedWhereTheyCannotBe) {
  const CityPlan usual = ResolvePlace({}).city;
  EXPECT_EQ(usual.building_share, 1.0);
  EXPECT_EQ(usual.tree_density, 1.0);
  EXPECT_FALSE(usual.bridge);
  EXPECT_EQ(usual.trucks, 0);
  const auto at_sea = [](void (*change)(SimulateOptions&)) {
    return [change](SimulateOptions& o) {
      o.place = "tidalflat";
      change(o);
    };
  };
  ExpectRefused("building_share", at_sea([](SimulateOptions& o) { o.building_share = 0.5; }));
  ExpectRefused("tree_density", at_sea([](SimulateOptions& o) { o.tree_density = 2.0; }));
  ExpectRefused("bridge", at_sea([](SimulateOptions& o) { o.bridge = true; }));
  ExpectRefused("trucks", at_sea([](SimulateOptions& o) { o.trucks = 1; }));
  ExpectRefused("building_share", [](SimulateOptions& o) {
    o.building_share = 0.0;
    o.tower_m = 30.0;
  });
  ExpectRefused("bridge", [](SimulateOptions& o) {
    o.bridge = true;
    o.hillside_deg = 5.0;
  });
}

TEST(Presets, ATowerMustStayBelowTheFlight) {
  SimulateOptions options;
  options.tower_m = 60.0;
  EXPECT_EQ(ResolvePlace(options).city.tower_m, 60.0);
  ExpectRefused("tower_m", [](SimulateOptions& o) { o.tower_m = 80.0; });
  ExpectRefused("tower_m", [](SimulateOptions& o) { o.tower_m = 201.0; });
  ExpectRefused("tower_m", [](SimulateOptions& o) {
    o.place = "tidalflat";
    o.tower_m = 30.0;
  });
  options.tower_m = 200.0;
  options.altitudes = {230.0};
  EXPECT_EQ(ResolvePlace(options).city.tower_m, 200.0);
  // On a slope the tower may stand uphill from take-off.
  options.hillside_deg = 20.0;
  EXPECT_THROW(ResolvePlace(options), base::UsageError);
  // Every block is checked, as flight lines cross the middle.
  options.hillside_deg = 0.0;
  options.altitudes = {230.0, 230.0, 230.0, 150.0};
  EXPECT_THROW(ResolvePlace(options), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::simulate
