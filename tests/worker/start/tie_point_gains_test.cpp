// Gains from tie points where walls hide points: two photos that look level at a wall whose west is bright and whose east is dark.
#include "worker/start/tie_point_gains.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/image/image.h"
#include "core/image/srgb.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

TEST(TiePointGains, PhotosThatLookLevelKnowNothingOfPointsBehindWalls) {
  constexpr int kColumns = 96, kRows = 72;
  constexpr double kWallY = 20.0, kBorderX = 8.0;  // halfway between the photos at x = 0 and 16
  const TemporaryFolder folder;
  base::ThreadPool threads(2);
  survey::Survey survey;
  camera::Camera camera;
  camera.width = kColumns;
  camera.height = kRows;
  camera.params = {48.0, 48.0, kColumns / 2.0, kRows / 2.0};
  survey.cameras = {camera};
  std::vector<image::PixelSource> sources;
  for (int i = 0; i < 2; ++i) {
    survey.photos.push_back(LevelPhoto({16.0 * i, 0.0, 2.0}, "p" + std::to_string(i) + ".png"));
    image::Image8 picture(kColumns, kRows, 3);
    for (int y = 0; y < kRows; ++y) {
      for (int x = 0; x < kColumns; ++x) {
        const double wall_x = 16.0 * i + (x + 0.5 - kColumns / 2.0) * kWallY / 48.0;
        // The second photo is half a stop darker.
        const float light = image::LinearFromSrgb(wall_x < kBorderX ? 0.8F : 0.3F) * std::exp2(-0.5F * static_cast<float>(i));
        for (size_t c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0F * image::SrgbFromLinear(light)));
      }
    }
    image::SavePng(picture, folder.path() / survey.photos.back().name);
    sources.push_back({folder.path() / survey.photos.back().name, {}});
  }
  const auto add = [&](double x, double y, const std::vector<int32_t>& seen_by) {
    for (double z = -2.0; z < 6.0; z += 0.5) {
      survey.points.emplace_back();
      survey.points.back().x_in_enu = {x, y, z};
      survey.tracks.Add(seen_by);
    }
  };
  for (double x = 0.0; x < 16.0; x += 2.5) add(x, kWallY, {0, 1});
  for (double x = -8.0; x < 24.0; x += 1.0) add(x, 3.0 * kWallY, {});  // in front of them the first photo shows bright wall, the second dark wall
  const image::PixelCache pixels = image::PixelCache::Open(folder.path() / "pixels.bin", sources, 0, threads);
  brightness::Response response = brightness::Response::Neutral(2, 1);
  const RaySource source(survey, pixels, response);
  brightness::LearnerOptions learn;
  learn.learns_gain = {1, 1};
  EXPECT_TRUE(GainsFromTiePoints(survey, pixels, source, learn, response, threads).gains);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR((response.log_gain[3 + c] - response.log_gain[c]) / std::log(2.0F), -0.5F, 0.05F);
}

}  // namespace
}  // namespace skyquilt::worker
