#include "evaluate/page/brightness_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "core/base/progress.h"
#include "core/image/image.h"
#include "core/image/srgb.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr int kPhotoWidth = 64, kPhotoHeight = 48;

// Photos of a grey gradient, brighter to the right. Photo i recorded 2^stops[i] of its light, and the scene has these gains. All but the first two
// are held out.
struct SlopeSurvey {
  TemporaryFolder folder;
  scene::SceneInfo info;
  survey::Survey survey;
  std::unique_ptr<image::PixelCache> pixels;

  explicit SlopeSurvey(const std::vector<double>& stops, const image::Image8& mask = {}) {
    base::Progress::SetQuiet(true);
    camera::Camera camera;
    camera.width = kPhotoWidth;
    camera.height = kPhotoHeight;
    camera.params = {50.0, 50.0, kPhotoWidth / 2.0, kPhotoHeight / 2.0};
    survey.cameras = {camera};
    info.response = brightness::Response::Neutral(stops.size(), 1);
    if (!mask.Empty()) image::SavePng(mask, folder / "mask.png");
    std::vector<image::PixelSource> sources;
    for (size_t i = 0; i < stops.size(); ++i) {
      survey::Photo photo;
      photo.name = "p" + std::to_string(i) + ".png";
      photo.is_test = i >= 2;
      survey.photos.push_back(photo);
      image::Image8 picture(kPhotoWidth, kPhotoHeight, 3);
      for (int y = 0; y < kPhotoHeight; ++y) {
        for (int x = 0; x < kPhotoWidth; ++x) {
          const float at_reference = 0.25F + 0.5F * static_cast<float>(x) / static_cast<float>(kPhotoWidth);
          const float light = image::LinearFromSrgb(at_reference) * static_cast<float>(std::exp2(stops[i]));
          for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0F * image::SrgbFromLinear(light)));
        }
      }
      image::SavePng(picture, folder / photo.name);
      sources.push_back({folder / photo.name, mask.Empty() ? std::filesystem::path() : folder / "mask.png"});
      for (size_t c = 0; c < 3; ++c) info.response.log_gain[3 * i + c] = static_cast<float>(stops[i] * std::numbers::ln2);
    }
    base::ThreadPool threads(1);
    pixels = std::make_unique<image::PixelCache>(image::PixelCache::Open(folder / "pixels.bin", sources, 0, threads));
  }

  BrightnessReport Collect() const { return CollectBrightness(info, survey, *pixels); }
};

double Sum(const BrightnessHistogram& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0);
}

TEST(CollectBrightness, GainsTakeDifferencesOfExposureOut) {
  const BrightnessReport report = SlopeSurvey({0.0, -1.0, -3.0}).Collect();
  ASSERT_EQ(report.photos.size(), 3U);
  EXPECT_FALSE(report.timed);
  EXPECT_EQ(report.photos[2].time_s, 2.0);
  EXPECT_FALSE(report.photos[1].held_out);
  EXPECT_TRUE(report.photos[2].held_out);
  EXPECT_EQ(report.photos[1].exif_stops, 0.0);
  for (const double stops : report.photos[1].learned_stops) EXPECT_NEAR(stops, -1.0, 1e-6);
  // Of the training photos: 0 and -1 stops.
  EXPECT_NEAR(report.spread_before_stops, 0.5, 0.02);
  EXPECT_NEAR(report.spread_after_stops, 0.0, 0.02);
  EXPECT_NEAR(Sum(report.histogram_before), 1.0, 1e-9);
  EXPECT_NEAR(Sum(report.histogram_after), 1.0, 1e-9);
  // At reference exposure the darkest display value is a quarter; at half the light it is less.
  const auto foot = static_cast<std::ptrdiff_t>(kBrightnessBins / 4 - 1);
  EXPECT_GT(std::accumulate(report.histogram_before.begin(), report.histogram_before.begin() + foot, 0.0), 0.04);
  EXPECT_EQ(std::accumulate(report.histogram_after.begin(), report.histogram_after.begin() + foot, 0.0), 0.0);
  EXPECT_TRUE(report.vignetting.empty());
  EXPECT_TRUE(report.luminance.empty());
  EXPECT_TRUE(report.views.empty());
}

TEST(CollectBrightness, PhotosComeInOrderOfCapture) {
  SlopeSurvey small({0.0, 0.0, 0.0});
  small.survey.photos[0].time_s = 25.0;
  small.survey.photos[1].time_s = 15.0;
  small.survey.photos[2].time_s = 45.0;
  // The tags of one photo say half the light, but its pixels do not show it.
  for (const size_t i : {0U, 1U, 2U}) small.survey.photos[i].exposure.time_s = i == 1 ? 0.005 : 0.01;
  small.info.response.exif_gain[1] = 0.5F;
  for (size_t c = 0; c < 3; ++c) small.info.response.log_gain[3 + c] = std::log(2.0F);
  const BrightnessReport report = small.Collect();
  ASSERT_EQ(report.photos.size(), 3U);
  EXPECT_TRUE(report.timed);
  EXPECT_EQ(report.photos[0].name, "p1.png");
  EXPECT_EQ(report.photos[1].name, "p0.png");
  EXPECT_EQ(report.photos[2].name, "p2.png");
  EXPECT_EQ(report.photos[0].time_s, 0.0);
  EXPECT_EQ(report.photos[2].time_s, 30.0);
  EXPECT_NEAR(report.photos[0].exif_stops, -1.0, 1e-6);
  EXPECT_NEAR(report.trust_in_tags, 0.0, 1e-6);
  EXPECT_NEAR(report.spread_after_stops, 0.0, 1e-3);
}

TEST(CollectBrightness, MaskedPixelsDoNotCount) {
  image::Image8 mask(kPhotoWidth, kPhotoHeight, 1, 255);
  for (int y = 0; y < kPhotoHeight; ++y) std::fill_n(mask.At(0, y), kPhotoWidth / 2, uint8_t{0});
  const BrightnessReport report = SlopeSurvey({0.0, 0.0}, mask).Collect();
  EXPECT_NEAR(Sum(report.histogram_before), 1.0, 1e-9);
  const auto dark_end = static_cast<std::ptrdiff_t>(kBrightnessBins / 2 - 1);
  EXPECT_EQ(std::accumulate(report.histogram_before.begin(), report.histogram_before.begin() + dark_end, 0.0), 0.0);
}

TEST(CollectBrightness, WhatIsBrighterThanWhiteIsInTheLastBin) {
  SlopeSurvey small({0.0, 0.0});
  small.info.response.log_gain.assign(6, -5.0F);
  EXPECT_NEAR(small.Collect().histogram_after.back(), 1.0, 1e-9);
}

TEST(CollectBrightness, TellsVignettingAndConcealingField) {
  SlopeSurvey small({0.0, 0.0});
  small.info.response.vignetting = {-0.5F, 0.0F, 0.0F};
  small.info.luminance.mode = brightness::LuminanceMode::kUnder;
  small.info.luminance.target = 0.4;
  small.info.luminance_state.mean_log_gain = -2.0 * std::numbers::ln2;
  const BrightnessReport report = small.Collect();
  ASSERT_EQ(report.vignetting.size(), 1U);
  EXPECT_EQ(report.vignetting[0].front(), 1.0);
  EXPECT_NEAR(report.vignetting[0][5], std::exp(-0.125), 1e-6);
  EXPECT_NEAR(report.vignetting[0].back(), std::exp(-0.5), 1e-6);
  EXPECT_NE(report.luminance.find("too dark"), std::string::npos);
  EXPECT_NE(report.luminance.find("0.40"), std::string::npos);
  EXPECT_NE(report.luminance.find("2.00"), std::string::npos);
}

TEST(CollectBrightness, ListsTheShadingOfTrainingPhotosInStops) {
  SlopeSurvey small({0.0, 0.0});
  small.info.response.AddShading({2, 2}, 0.3F);
  small.info.response.shading = {std::log(2.0F), 0.0F, -std::log(2.0F), 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const BrightnessReport report = small.Collect();
  const std::vector<float> wanted = {1.0F, 0.0F, -1.0F, 0.0F};
  ASSERT_EQ(report.photos[0].shading_stops.size(), wanted.size());
  for (size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(report.photos[0].shading_stops[k], wanted[k], 1e-5F);
  const std::string json = BrightnessJson(report);
  EXPECT_NE(json.find("shading_stops\": [\n"), std::string::npos);
}

TEST(CollectBrightness, IsEmptyForASceneOfOtherPhotos) {
  SlopeSurvey small({0.0, 0.0});
  small.info.response = brightness::Response::Neutral(3, 1);
  EXPECT_TRUE(small.Collect().Empty());
  EXPECT_TRUE(ChooseViews(small.info, small.survey, {0, 1}).empty());
}

TEST(ChooseViews, TakesDarkestAndBrightestThatDiffer) {
  scene::SceneInfo info;
  survey::Survey survey;
  survey.photos.resize(5);
  info.response = brightness::Response::Neutral(5, 1);
  info.response.exif_gain = {1.0F, 0.5F, 2.0F, 1.05F, 1.0F};
  // Learned gains count like the tags.
  for (size_t c = 0; c < 3; ++c) info.response.log_gain[12 + c] = -2.0F * std::log(2.0F);
  EXPECT_NEAR(ExposureStops(info.response, 4), -2.0, 1e-6);
  EXPECT_EQ(ChooseViews(info, survey, {0, 1, 2, 3, 4}), (std::vector<int>{4, 2}));
  EXPECT_EQ(ChooseViews(info, survey, {0, 1, 2, 3}), (std::vector<int>{1, 2}));
  EXPECT_EQ(ChooseViews(info, survey, {3, 0, 2}), (std::vector<int>{2}));
  EXPECT_EQ(ChooseViews(info, survey, {0, 3}), (std::vector<int>{3}));
  EXPECT_EQ(ChooseViews(info, survey, {1}), (std::vector<int>{1}));
  EXPECT_TRUE(ChooseViews(info, survey, {}).empty());
}

}  // namespace
}  // namespace skyquilt::evaluate::page
