#include "evaluate/metrics/class_scores.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "tests/evaluate/photos/nadir_view.h"

namespace skyquilt::evaluate::metrics {
namespace {

using survey::SurfaceClass;

constexpr int kClassesWidth = 100, kClassesHeight = 80;

// A photo of level ground 100 m below, rendered exactly, all of it road on the left and roof on the right.
struct Surface {
  photos::HeldOutPhoto task;
  photos::PhotoResult findings;

  Surface() {
    const photos::TrainingView view = photos::NadirView(0, 0, 100);
    task.camera = view.camera;
    task.cam_from_enu = view.cam_from_enu;
    findings.scored = image::Image8(kClassesWidth, kClassesHeight, 1, 1);
    findings.z_depth = findings.true_depth = image::ImageF(kClassesWidth, kClassesHeight, 1, 100.0F);
    findings.true_class = image::Image8(kClassesWidth, kClassesHeight, 1);
    findings.normals = findings.true_normals = image::ImageF(kClassesWidth, kClassesHeight, 3, 0.0F);
    for (int y = 0; y < kClassesHeight; ++y) {
      for (int x = 0; x < kClassesWidth; ++x) {
        *findings.true_class.At(x, y) = static_cast<uint8_t>(x < kClassesWidth / 2 ? SurfaceClass::kRoad : SurfaceClass::kRoof);
        findings.normals.At(x, y)[2] = findings.true_normals.At(x, y)[2] = 1.0F;
      }
    }
  }
  // Moves the rendered surface of a pixel along its ray.
  void Move(int x, int y, double metres) {
    *findings.z_depth.At(x, y) += static_cast<float>(metres * task.camera.RayFromImg({x + 0.5, y + 0.5}).z());
  }
  std::vector<ClassScore> Scores() const {
    ClassErrors errors;
    errors.Add(task, findings);
    return errors.Result();
  }
};

const ClassScore& Named(const std::vector<ClassScore>& scores, const std::string& name) {
  for (const ClassScore& score : scores) {
    if (score.name == name) return score;
  }
  throw std::logic_error("no class " + name);
}

TEST(ClassErrors, WithoutTrueClassesThereAreNoScores) {
  Surface surface;
  surface.findings.true_class = image::Image8();
  EXPECT_TRUE(surface.Scores().empty());
}

TEST(ClassErrors, SurfacesThatAreNotThereAreNotMeasured) {
  const std::vector<ClassScore> scores = Surface().Scores();
  ASSERT_EQ(scores.size(), 5U);
  for (const char* name : {"wall", "tree"}) {
    EXPECT_EQ(Named(scores, name).pixels, 0);
    EXPECT_TRUE(std::isnan(Named(scores, name).depth_bias_m));
    EXPECT_TRUE(std::isnan(Named(scores, name).depth_nmad_m));
    EXPECT_TRUE(std::isnan(Named(scores, name).depth_rmse_m));
    EXPECT_TRUE(std::isnan(Named(scores, name).normal_median_deg));
    EXPECT_TRUE(std::isnan(Named(scores, name).normal_mean_deg));
  }
}

// Four of five rows of the roof are 0.1 m too far along the ray, the fifth is 1 m too near.
TEST(ClassErrors, HaveKnownValuesAlongTheRay) {
  Surface surface;
  for (int y = 0; y < kClassesHeight; ++y) {
    for (int x = kClassesWidth / 2; x < kClassesWidth; ++x) surface.Move(x, y, y % 5 == 4 ? -1.0 : 0.1);
  }
  const std::vector<ClassScore> scores = surface.Scores();
  const ClassScore& roof = Named(scores, "roof");
  EXPECT_EQ(roof.pixels, kClassesWidth / 2 * kClassesHeight);
  EXPECT_NEAR(roof.depth_bias_m, 0.1, 1e-4);
  EXPECT_NEAR(roof.depth_median_abs_m, 0.1, 1e-4);
  EXPECT_NEAR(roof.depth_nmad_m, 0.0, 1e-4);
  EXPECT_NEAR(roof.depth_rmse_m, std::sqrt((4.0 * 0.01 + 1.0) / 5.0), 1e-4);
  EXPECT_EQ(Named(scores, "ground").depth_rmse_m, 0.0);
}

TEST(ClassErrors, NmadOfNormalErrorsIsTheirStandardDeviation) {
  Surface surface;
  base::Random random(3);
  for (int y = 0; y < kClassesHeight; ++y) {
    for (int x = kClassesWidth / 2; x < kClassesWidth; ++x) surface.Move(x, y, 0.3 + 0.2 * random.Normal());
  }
  const std::vector<ClassScore> scores = surface.Scores();
  EXPECT_NEAR(Named(scores, "roof").depth_nmad_m, 0.2, 0.01);
  EXPECT_NEAR(Named(scores, "roof").depth_bias_m, 0.3, 0.015);
}

TEST(ClassErrors, RoadsArePartOfTheGround) {
  Surface surface;
  for (int y = 0; y < kClassesHeight / 2; ++y) {
    for (int x = 0; x < kClassesWidth / 2; ++x) {
      *surface.findings.true_class.At(x, y) = static_cast<uint8_t>(SurfaceClass::kGround);
      surface.Move(x, y, 0.5);
    }
  }
  const std::vector<ClassScore> scores = surface.Scores();
  EXPECT_EQ(Named(scores, "ground").pixels, kClassesWidth / 2 * kClassesHeight);
  EXPECT_EQ(Named(scores, "road").pixels, kClassesWidth / 2 * kClassesHeight / 2);
  EXPECT_NEAR(Named(scores, "ground").depth_rmse_m, std::sqrt(0.125), 1e-4);
  EXPECT_EQ(Named(scores, "road").depth_rmse_m, 0.0);
}

TEST(ClassErrors, OnlyScoredPixelsWithBothDepthsCount) {
  Surface surface;
  for (int x = 0; x < kClassesWidth; ++x) {
    *surface.findings.scored.At(x, 0) = 0;
    *surface.findings.z_depth.At(x, 1) = std::numeric_limits<float>::quiet_NaN();
    *surface.findings.true_depth.At(x, 2) = std::numeric_limits<float>::quiet_NaN();
    surface.Move(x, 0, 50.0);
  }
  const std::vector<ClassScore> scores = surface.Scores();
  const ClassScore& roof = Named(scores, "roof");
  EXPECT_EQ(roof.pixels, kClassesWidth / 2 * (kClassesHeight - 3));
  EXPECT_EQ(roof.missing_pixels, kClassesWidth / 2);
  EXPECT_EQ(roof.depth_rmse_m, 0.0);
}

TEST(ClassErrors, NormalErrorsAreAngles) {
  Surface surface;
  for (int y = 0; y < kClassesHeight; ++y) {
    for (int x = kClassesWidth / 2; x < kClassesWidth; ++x) {
      const double angle = (y % 4 == 0 ? 90.0 : 10.0) * 3.141592653589793 / 180.0;
      float* normal = surface.findings.normals.At(x, y);
      normal[0] = static_cast<float>(std::sin(angle));
      normal[2] = static_cast<float>(std::cos(angle));
    }
    surface.findings.normals.At(kClassesWidth - 1, y)[0] = std::numeric_limits<float>::quiet_NaN();
  }
  const std::vector<ClassScore> scores = surface.Scores();
  EXPECT_NEAR(Named(scores, "roof").normal_median_deg, 10.0, 1e-4);
  EXPECT_NEAR(Named(scores, "roof").normal_mean_deg, 30.0, 1e-4);
  EXPECT_EQ(Named(scores, "ground").normal_mean_deg, 0.0);
}

TEST(ClassErrors, NormalsOfDensityAndHeadAreScoredWhenTheyWereRendered) {
  Surface surface;
  EXPECT_TRUE(std::isnan(Named(surface.Scores(), "roof").density_normal_median_deg));
  EXPECT_TRUE(std::isnan(Named(surface.Scores(), "roof").head_normal_median_deg));
  const auto leaning = [](double angle_deg) {
    image::ImageF normals(kClassesWidth, kClassesHeight, 3, 0.0F);
    const double angle = angle_deg * 3.141592653589793 / 180.0;
    for (size_t i = 0; i < normals.data.size(); i += 3) {
      normals.data[i] = static_cast<float>(std::sin(angle));
      normals.data[i + 2] = static_cast<float>(std::cos(angle));
    }
    return normals;
  };
  surface.findings.density_normals = leaning(20.0);
  surface.findings.head_normals = leaning(5.0);
  const std::vector<ClassScore> scores = surface.Scores();
  EXPECT_NEAR(Named(scores, "roof").density_normal_median_deg, 20.0, 1e-4);
  EXPECT_NEAR(Named(scores, "roof").head_normal_median_deg, 5.0, 1e-4);
  EXPECT_EQ(Named(scores, "roof").normal_median_deg, 0.0);
}

// Pooling does not depend on how pixels are spread over photos.
TEST(ClassErrors, PhotosArePooled) {
  Surface good, bad;
  for (int y = 0; y < kClassesHeight; ++y) {
    for (int x = kClassesWidth / 2; x < kClassesWidth; ++x) bad.Move(x, y, 2.0);
  }
  for (int x = 0; x < kClassesWidth; ++x) *bad.findings.scored.At(x, 0) = 0;
  ClassErrors errors;
  errors.Add(good.task, good.findings);
  errors.Add(bad.task, bad.findings);
  const std::vector<ClassScore> scores = errors.Result();
  EXPECT_EQ(Named(scores, "roof").pixels, kClassesWidth / 2 * (2 * kClassesHeight - 1));
  EXPECT_EQ(Named(scores, "roof").depth_bias_m, 0.0);  // more than half of the pixels are good
}

// A surface that is too far by the same distance everywhere has another bias, and the same NMAD.
RC_GTEST_PROP(ClassErrors, AnOffsetChangesTheBiasOnly, ()) {
  const double offset_m = *rc::gen::inRange(-300, 300) / 100.0;
  const auto seed = *rc::gen::arbitrary<uint32_t>();
  Surface rough, moved;
  base::Random random(seed);
  for (int y = 0; y < kClassesHeight; ++y) {
    for (int x = 0; x < kClassesWidth; ++x) {
      const double error_m = random.Normal();
      rough.Move(x, y, error_m);
      moved.Move(x, y, error_m + offset_m);
    }
  }
  const std::vector<ClassScore> before = rough.Scores(), after = moved.Scores();
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i].pixels == 0) continue;
    RC_ASSERT(std::abs(after[i].depth_bias_m - before[i].depth_bias_m - offset_m) < 1e-4);
    RC_ASSERT(std::abs(after[i].depth_nmad_m - before[i].depth_nmad_m) < 1e-4);
    RC_ASSERT(after[i].normal_mean_deg == before[i].normal_mean_deg);
  }
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
