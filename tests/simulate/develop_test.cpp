#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/srgb.h"
#include "core/survey/exif.h"
#include "simulate/survey_writer.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;

Development Gain(double gain) {
  Development development;
  development.gain = {gain, gain, gain};
  return development;
}

TEST(Develop, GainsActOnLinearLight) {
  image::ImageF dim(64, 1, 3);
  image::ImageF bright(64, 1, 3);
  for (size_t i = 0; i < dim.data.size(); ++i) {
    dim.data[i] = 0.3F * static_cast<float>(i) / static_cast<float>(dim.data.size());
    bright.data[i] = 2.0F * dim.data[i];
  }
  EXPECT_EQ(Develop(dim, Gain(2.0)).data, Develop(bright, Gain(1.0)).data);
  // Twice the light is twice the linear value, up to one 8-bit step.
  const image::Image8 one = Develop(dim, Gain(1.0));
  const image::Image8 two = Develop(dim, Gain(2.0));
  for (size_t i = 0; i < one.data.size(); ++i) {
    const float linear = image::LinearFromSrgb(static_cast<float>(one.data[i]) / 255.0F);
    const float expected = 255.0F * image::SrgbFromLinear(std::min(2.0F * linear, 1.0F));
    EXPECT_NEAR(static_cast<float>(two.data[i]), expected, 7.5F * (one.data[i] < 8 ? 1.0F : 0.2F)) << i;
  }
}

TEST(Develop, ClipsAtWhiteAndNeverWraps) {
  image::ImageF light(3, 1, 3);
  light.data = {0.0F, 1e-6F, 0.5F, 10.0F, 1e6F, 1e30F, -1.0F, -0.0F, 1.0F};
  const image::Image8 out = Develop(light, Gain(4.0));
  EXPECT_EQ(out.data[0], 0);
  for (size_t i = 2; i < 6; ++i) EXPECT_EQ(out.data[i], 255) << i;
  EXPECT_EQ(out.data[6], 0);
}

TEST(Develop, ChannelsHaveTheirOwnGains) {
  image::ImageF light(50, 2, 3);
  for (size_t i = 0; i < light.data.size(); ++i) light.data[i] = static_cast<float>(i) / static_cast<float>(light.data.size());
  Development mixed;
  mixed.gain = {1.3, 1.0, 0.4};
  const image::Image8 out = Develop(light, mixed);
  for (size_t c = 0; c < 3; ++c) {
    const image::Image8 same = Develop(light, Gain(mixed.gain[c]));
    for (size_t i = c; i < out.data.size(); i += 3) EXPECT_EQ(out.data[i], same.data[i]) << i;
  }
}

TEST(Develop, VignettingHalvesTheLightInTheCorners) {
  const image::ImageF light(401, 301, 3, 0.4F);
  const image::Image8 even = Develop(light, Gain(1.0));
  const image::Image8 dark = Develop(light, Gain(0.5));
  Development fading = Gain(1.0);
  fading.vignetting = 0.5;
  fading.principal_point = {200.5, 150.5};
  const image::Image8 out = Develop(light, fading);
  EXPECT_EQ(*out.At(200, 150), *even.At(200, 150));
  // The centre of the corner pixel is half a pixel inside.
  for (const int x : {0, 400}) {
    for (const int y : {0, 300}) EXPECT_NEAR(*out.At(x, y), *dark.At(x, y), 1) << x << " " << y;
  }
  // Half-way to the corner the exponent is a quarter.
  const image::Image8 half_way = Develop(light, Gain(std::pow(0.5, 0.25)));
  EXPECT_NEAR(*out.At(300, 225), *half_way.At(300, 225), 1);
  for (int x = 201; x < 401; ++x) EXPECT_LE(*out.At(x, 150), *out.At(x - 1, 150));
}

TEST(Develop, VignettingIsAboutThePrincipalPoint) {
  const image::ImageF light(401, 301, 3, 0.4F);
  const image::Image8 even = Develop(light, Gain(1.0));
  Development fading = Gain(1.0);
  fading.principal_point = {0.5, 0.5};
  EXPECT_EQ(Develop(light, fading).data, even.data);  // no loss, wherever the centre is
  fading.vignetting = 0.5;
  const image::Image8 out = Develop(light, fading);
  EXPECT_EQ(*out.At(0, 0), *even.At(0, 0));
  EXPECT_NEAR(*out.At(400, 300), *Develop(light, Gain(0.5)).At(400, 300), 1);
}

class SurveyFiles : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"images", "truth"}) fs::create_directories(root_ / name);
  }
  void TearDown() override { fs::remove_all(root_); }

  const fs::path root_ = fs::temp_directory_path() / ("skyquilt_survey_files_test_" + std::to_string(getpid()));
};

TEST_F(SurveyFiles, PhotosCarryExposureTagsOnlyWhereThePlanHasThem) {
  camera::Camera camera;
  camera.width = 32;
  camera.height = 16;
  camera.params = {30.0, 30.0, 16.0, 8.0};
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  PhotoPlan photo;
  photo.exposure_time_s = 1.0 / 800.0;
  for (const bool tagged : {true, false}) {
    photo.name = tagged ? "tagged.jpg" : "bare.jpg";
    photo.exposure_tagged = tagged;
    WritePhoto(root_, photo, image::Image8(32, 16, 3, 100), camera, frame, 90);
    const survey::PhotoTags tags = survey::ReadPhotoTags(root_ / "images" / photo.name);
    EXPECT_TRUE(tags.gps && tags.capture_time_s && tags.focal_length_mm);
    EXPECT_EQ(tags.exposure.time_s.has_value(), tagged);
    EXPECT_EQ(tags.exposure.f_number.has_value(), tagged);
    EXPECT_EQ(tags.exposure.iso.has_value(), tagged);
  }
}

TEST_F(SurveyFiles, TruthTellsTheLightThatNoTagTells) {
  SimulateOptions options;
  options.place = "hamlet";
  options.exposure_offset_stops = -1.0;
  options.exposure_error_stops = 0.3;
  options.color_drift_stops = 0.4;
  options.vignetting = 0.2;
  const PlaceSpec place = ResolvePlace(options);
  const std::vector<PhotoPlan> photos = PlanFlight(place, 0.0);
  WriteExposureTruth(root_, photos, place);
  const auto truth = base::ParseJson(base::ReadFile(root_ / "truth" / "exposure.json"));
  EXPECT_EQ(truth["vignetting"], 0.2);
  ASSERT_EQ(truth["photos"].size(), photos.size());
  double largest_error = 0.0;
  for (size_t i = 0; i < photos.size(); ++i) {
    const auto& told = truth["photos"][i];
    EXPECT_EQ(told["name"], photos[i].name);
    EXPECT_EQ(told["gain"], photos[i].gain);
    EXPECT_EQ((told["light_rgb"].get<std::array<double, 3>>()), LightRgb(photos[i]));
    const double green = told["light_rgb"][1].get<double>();
    largest_error = std::max(largest_error, std::abs(std::log2(green / photos[i].gain) - place.exposure_offset_stops));
  }
  EXPECT_GT(largest_error, 0.3);
}

}  // namespace
}  // namespace skyquilt::simulate
