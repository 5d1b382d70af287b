#include "evaluate/photos/photo_scorer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/evaluate/photos/nadir_view.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kScoredWidth = 100, kScoredHeight = 80;

// A camera 100 m above flat ground at height 0: 100 m x 80 m are in the frame, one pixel is one metre.
struct FlatGround {
  HeldOutPhoto task;
  std::vector<render::RayColor> rendered;
  SceneArea area{{{{-50, -40, -1}, {0, 40, 5}, 5.0}, {{0, -40, -1}, {50, 40, 5}, 5.0}}, {-1.0, 5.0}};
  base::ThreadPool threads{2};

  FlatGround() {
    const TrainingView view = NadirView(0, 0, 100);
    task.camera = view.camera;
    task.cam_from_enu = view.cam_from_enu;
    task.photo = image::Image8(kScoredWidth, kScoredHeight, 3, 100);
    rendered.resize(static_cast<size_t>(kScoredWidth) * kScoredHeight);
    for (int y = 0; y < kScoredHeight; ++y) {
      for (int x = 0; x < kScoredWidth; ++x) {
        render::RayColor& ray = rendered[static_cast<size_t>(y) * kScoredWidth + static_cast<size_t>(x)];
        // The western half is rendered 10/255 too bright, the eastern 20/255.
        for (float& c : ray.rgb_srgb) c = (x < 50 ? 110.0F : 120.0F) / 255.0F;
        ray.opacity = 1.0F;
        ray.depth_median = static_cast<float>(100.0 / task.camera.RayFromImg({x + 0.5, y + 0.5}).z());
        ray.depth = ray.depth_median;
      }
    }
  }
  static TrainingViews TwoEverywhere() { return TrainingViews({NadirView(0, 0, 120), NadirView(1, 0, 120)}); }
};

double Psnr(double difference) {
  return -20.0 * std::log10(difference / 255.0);
}

class ScorePhotoTest : public ::testing::Test, protected FlatGround {};

TEST_F(ScorePhotoTest, AllPixelsCoveredGiveTheFullFrameScore) {
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  EXPECT_EQ(findings.score.used_pixels, kScoredWidth * kScoredHeight);
  EXPECT_EQ(findings.score.covered_pixels, kScoredWidth * kScoredHeight);
  EXPECT_DOUBLE_EQ(findings.score.Coverage(), 1.0);
  EXPECT_NEAR(findings.score.psnr_db, Psnr(std::sqrt(250.0)), 1e-3);
  EXPECT_NEAR(findings.score.psnr_full_db, findings.score.psnr_db, 1e-9);
  EXPECT_NEAR(findings.score.ssim, findings.score.ssim_full, 1e-6);
  EXPECT_GT(findings.score.flip, 0.0);
  EXPECT_EQ(findings.score.flip, findings.score.flip_full);
}

// Errors that are as often too bright as too dark are gone at half of the width; those of the whole picture stay.
TEST_F(ScorePhotoTest, WidePicturesAreAlsoComparedAtTheCommonWidth) {
  EXPECT_TRUE(std::isnan(ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads).score.psnr_1000_db)) << "too narrow";
  constexpr int kWide = 2 * kCommonWidth, kLow = 20;
  const double scale = static_cast<double>(kWide) / kScoredWidth;
  task.camera.width = kWide;
  task.camera.height = kLow;
  task.camera.params = {scale * task.camera.FocalX(), scale * task.camera.FocalX(), 0.5 * kWide, 0.5 * kLow};
  task.camera.model = camera::CameraModel::kPinhole;
  task.photo = image::Image8(kWide, kLow, 3, 100);
  rendered.resize(static_cast<size_t>(kWide) * kLow);
  const auto score = [&](float even, float odd) {
    for (size_t i = 0; i < rendered.size(); ++i) {
      for (float& c : rendered[i].rgb_srgb) c = (i % 2 == 0 ? even : odd) / 255.0F;
      rendered[i].depth_median = 100.0F;
    }
    return ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads).score;
  };
  const PhotoScore rough = score(110.0F, 90.0F), bright = score(110.0F, 110.0F);
  EXPECT_EQ(rough.covered_pixels, kWide * kLow);
  EXPECT_NEAR(rough.psnr_db, Psnr(10.0), 1e-3);
  EXPECT_GT(rough.psnr_1000_db, rough.psnr_db + 20.0);
  EXPECT_NEAR(bright.psnr_1000_db, Psnr(10.0), 1e-3);
}

TEST_F(ScorePhotoTest, BlocksAndSeamsGetTheirOwnPixels) {
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  ASSERT_EQ(findings.per_block.size(), 2U);
  EXPECT_EQ(PixelsOf(findings.per_block[0]), 50 * kScoredHeight);
  EXPECT_EQ(PixelsOf(findings.per_block[1]), 50 * kScoredHeight);
  EXPECT_NEAR(skyquilt::metrics::PsnrOf(findings.per_block[0]), Psnr(10.0), 1e-3);
  EXPECT_NEAR(skyquilt::metrics::PsnrOf(findings.per_block[1]), Psnr(20.0), 1e-3);
  EXPECT_EQ(PixelsOf(findings.seams.AllSeam()), 10 * kScoredHeight);                 // 5 m on either side
  EXPECT_EQ(PixelsOf(findings.seams.AllInterior()), 2 * 40 * (kScoredHeight - 10));  // without seam and rim
}

TEST_F(ScorePhotoTest, PixelsSeenByOneViewOnlyAreNotCovered) {
  // The second view is moved 50 m west: its frame ends at x = 0 + 10 (60 m half width at 120 m height).
  const TrainingViews views({NadirView(0, 0, 120), NadirView(-50, 0, 120)});
  const PhotoResult findings = ScorePhoto(task, rendered, views, area, threads);
  EXPECT_EQ(findings.score.covered_pixels, 60 * kScoredHeight);
  EXPECT_EQ(findings.scored.data[0], 1);
  EXPECT_EQ(findings.scored.data[kScoredWidth - 1], 0);
  EXPECT_GT(findings.score.psnr_db, findings.score.psnr_full_db);  // the worse half is partly uncovered
}

TEST_F(ScorePhotoTest, MaskedPixelsCountNowhere) {
  task.mask.assign(static_cast<size_t>(kScoredWidth) * kScoredHeight, 1);
  for (int y = 0; y < kScoredHeight; ++y) {
    for (int x = 50; x < kScoredWidth; ++x) task.mask[static_cast<size_t>(y) * kScoredWidth + static_cast<size_t>(x)] = 0;
  }
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  EXPECT_EQ(findings.score.used_pixels, 50 * kScoredHeight);
  EXPECT_NEAR(findings.score.psnr_full_db, Psnr(10.0), 1e-3);
  EXPECT_EQ(PixelsOf(findings.per_block[1]), 0);
}

TEST_F(ScorePhotoTest, HolesOverPhotographedGroundStillCount) {
  for (render::RayColor& ray : rendered) {
    ray = render::RayColor{};
    ray.depth = ray.depth_median = std::numeric_limits<float>::quiet_NaN();
  }
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  EXPECT_GT(findings.score.Coverage(), 0.9);
  EXPECT_NEAR(findings.score.psnr_full_db, Psnr(100.0), 1e-3);
}

// A camera that looks level to the north, 10 m above the ground: rows above the middle rise.
class ScoreLevelPhoto : public ::testing::Test {
 protected:
  ScoreLevelPhoto() {
    task_.camera = NadirView(0, 0, 0).camera;
    Eigen::Matrix3d rotation;
    rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    task_.cam_from_enu = {Eigen::Quaterniond(rotation), -(rotation * Eigen::Vector3d(0, 0, 10))};
    task_.photo = image::Image8(kScoredWidth, kScoredHeight, 3, 100);
    rendered_.resize(static_cast<size_t>(kScoredWidth) * kScoredHeight);
    for (render::RayColor& ray : rendered_) ray.depth = ray.depth_median = std::numeric_limits<float>::quiet_NaN();
  }
  // How many pixels of the upper half are covered.
  int64_t CoveredAbove() {
    const TrainingView view{task_.camera, task_.cam_from_enu, {}};
    const PhotoResult findings = ScorePhoto(task_, rendered_, TrainingViews({view, view}), area_, threads_);
    return std::count(findings.scored.data.begin(), findings.scored.data.begin() + kScoredWidth * kScoredHeight / 2, 1);
  }

  HeldOutPhoto task_;
  std::vector<render::RayColor> rendered_;
  SceneArea area_{{{{-5000, -5000, 0}, {5000, 5000, 20}, 5.0}}, {0.0, 20.0}};
  base::ThreadPool threads_{2};
};

TEST_F(ScoreLevelPhoto, SkyIsNotCoveredButHolesInWallsAre) {
  EXPECT_EQ(CoveredAbove(), kScoredWidth * kScoredHeight / 2) << "all rays pass below the upper end of the heights within the block";
  // A wall 100 m to the north, 60 m wide and 25 m high, of points: 30 columns to both sides of the middle, 15 rows above it.
  std::vector<survey::SparsePoint> wall;
  for (int x = -30; x <= 30; ++x) {
    for (int z = 0; z <= 25; ++z) wall.push_back({.x_in_enu = Eigen::Vector3d(x, 100.0, z)});
  }
  area_.points = wall;
  const int64_t behind_points = CoveredAbove();
  EXPECT_GE(behind_points, 60 * 15) << "a hole in the wall counts";
  EXPECT_LE(behind_points, 70 * 16) << "the sky above and beside it does not";
  // What is rendered there counts, wrong or not.
  render::RayColor& matter = rendered_[5 * kScoredWidth + 50];
  matter.depth = matter.depth_median = 12.0F;
  EXPECT_EQ(CoveredAbove(), behind_points + 1);
  matter.depth = matter.depth_median = 1000.0F;
  EXPECT_EQ(CoveredAbove(), behind_points) << "behind the upper end of the heights";
}

TEST_F(ScorePhotoTest, DepthIsComparedAlongTheOpticalAxis) {
  task.true_depth = image::ImageF(2 * kScoredWidth, 2 * kScoredHeight, 1, 100.5F);  // of twice the size; the render is half a metre too near
  *task.true_depth.At(0, 0) = std::numeric_limits<float>::quiet_NaN();
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  EXPECT_NEAR(findings.score.depth_rmse_m, 0.5, 1e-4);
  EXPECT_NEAR(findings.score.depth_median_abs_m, 0.5, 1e-3);
}

TEST_F(ScorePhotoTest, NormalsAndClassesComeAtTheScoredSize) {
  EXPECT_TRUE(ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads).normals.Empty());
  task.true_normals = image::ImageF(2 * kScoredWidth, 2 * kScoredHeight, 3, 0.0F);
  for (size_t i = 2; i < task.true_normals.data.size(); i += 3) task.true_normals.data[i] = 1.0F;
  task.true_class = image::Image8(2 * kScoredWidth, 2 * kScoredHeight, 1, 3);
  for (int y = 0; y < 2 * kScoredHeight; ++y) {
    for (int x = 20; x < 40; ++x) *task.true_class.At(x, y) = 5;
  }
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  ASSERT_EQ(findings.true_class.width, kScoredWidth);
  ASSERT_EQ(findings.true_class.height, kScoredHeight);
  for (int x = 0; x < kScoredWidth; ++x) EXPECT_EQ(*findings.true_class.At(x, 7), x >= 10 && x < 20 ? 5 : 3) << x;
  ASSERT_EQ(findings.true_normals.data.size(), findings.normals.data.size());
  EXPECT_EQ(findings.true_normals.At(kScoredWidth - 1, kScoredHeight - 1)[2], 1.0F);
  EXPECT_NEAR(findings.normals.At(30, 30)[2], 1.0F, 1e-5F);  // of the rendered level ground
}

TEST_F(ScorePhotoTest, SameResultForAnyNumberOfThreads) {
  base::ThreadPool one(1);
  const TrainingViews views = FlatGround::TwoEverywhere();
  const PhotoResult a = ScorePhoto(task, rendered, views, area, threads);
  const PhotoResult b = ScorePhoto(task, rendered, views, area, one);
  EXPECT_EQ(a.score.psnr_db, b.score.psnr_db);
  EXPECT_EQ(a.seams.AllInterior().sum, b.seams.AllInterior().sum);
  EXPECT_EQ(a.score.flip, b.score.flip);
  EXPECT_EQ(a.scored.data, b.scored.data);
}

TEST_F(ScorePhotoTest, NonFiniteRenderedColoursAreBlackNotNan) {
  rendered[5].rgb_srgb[1] = std::numeric_limits<float>::quiet_NaN();
  const PhotoResult findings = ScorePhoto(task, rendered, FlatGround::TwoEverywhere(), area, threads);
  EXPECT_TRUE(std::isfinite(findings.score.psnr_db));
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
