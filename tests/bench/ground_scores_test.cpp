#include "bench/study/ground_scores.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/file.h"
#include "evaluate/photos/scored_pixels.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::bench {
namespace {

constexpr int kSize = 64;
constexpr double kAgl_m = 32.0;
constexpr double kRounding_db = 0.15;  // of errors kept in 8 bits

// One photo straight down from above (0, 0), which shows 64 x 64 m: the left half of the picture is west.
survey::Survey NadirSurvey() {
  survey::Survey survey;
  survey.cameras = {{.model = camera::CameraModel::kPinhole, .width = 2 * kSize, .height = 2 * kSize, .params = {64, 64, 64, 64}}};
  survey::Photo photo;
  photo.name = "a.jpg";
  photo.is_test = true;
  photo.agl_m = kAgl_m;
  photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * Eigen::Vector3d(0.0, 0.0, 100.0));
  survey.photos = {photo};
  return survey;
}

geo::BlockBox Box(double west, double east) {
  return {.min_enu = {west, -100.0, 0.0}, .max_enu = {east, 100.0, 200.0}};
}

class GroundScores : public InTemporaryFolder {
 protected:
  // Errors of the left and of the right half, in display values of 255; the first `unscored` rows are not scored.
  void Save(const std::string& variant, int left, int right, int unscored = 0) {
    const image::Image8 photo(kSize, kSize, 3, 100);
    image::Image8 render = photo, scored(kSize, kSize, 1);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        *scored.At(x, y) = y >= unscored ? 1 : 0;
        for (int c = 0; c < 3; ++c) render.At(x, y)[c] = static_cast<uint8_t>(100 + (y < kSize / 2 ? 0 : x < kSize / 2 ? left : right));
      }
    }
    const std::filesystem::path file = evaluate::photos::ScoredPixelsFile(folder_.path() / "runs" / variant / "covered", "a.jpg");
    base::RequireWritableFolder(file.parent_path());
    image::SavePng(evaluate::photos::ScoredPixels(photo, render, scored), file);
  }
  static VariantResult Result(const std::string& name) {
    VariantResult result;
    result.name = name;
    return result;
  }
};

double Psnr(double error, double share) {
  return -10.0 * std::log10(share * error * error / (255.0 * 255.0));
}

TEST_F(GroundScores, ArePerBoxOverThePixelsThatAllScore) {
  Save("one", 10, 20);
  Save("blocks", 40, 30, kSize / 2);
  const VariantResult one = Result("one"), blocks = Result("blocks");
  const auto alone = ScoreGround(folder_.path(), NadirSurvey(), {Box(-100.0, 0.0), Box(0.0, 100.0)}, {&one});
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_NEAR(alone[0][0], Psnr(10.0, 0.5), kRounding_db) << "the upper half has no error";
  EXPECT_NEAR(alone[0][1], Psnr(20.0, 0.5), kRounding_db);
  const auto both = ScoreGround(folder_.path(), NadirSurvey(), {Box(-100.0, 0.0), Box(0.0, 100.0), Box(100.0, 200.0)}, {&one, &blocks});
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(both[0][0], Psnr(10.0, 1.0), kRounding_db) << "the upper half is not scored by both";
  EXPECT_NEAR(both[1][1], Psnr(30.0, 1.0), kRounding_db);
  EXPECT_TRUE(std::isnan(both[0][2])) << "no pixel shows it";
}

TEST_F(GroundScores, UseTheFirstSeedThatSucceeded) {
  Save("one_s2", 10, 20);
  VariantResult one = Result("one"), gone = Result("gone");
  one.seeds = {Result("one"), Result("one_s2")};
  one.seeds[0].failure = "no memory";
  const auto scores = ScoreGround(folder_.path(), NadirSurvey(), {Box(-8.0, 0.0)}, {&one, &gone});
  EXPECT_NEAR(scores[0][0], Psnr(10.0, 0.5), kRounding_db) << "8 of the 32 m west of the camera";
  EXPECT_TRUE(std::isnan(scores[1][0])) << "no pictures";
}

}  // namespace
}  // namespace skyquilt::bench
