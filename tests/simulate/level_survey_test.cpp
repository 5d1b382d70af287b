// What simulate writes of level flights.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "simulate/simulate.h"
#include "simulate/sky.h"
#include "simulate/sparse_points.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;

class LevelSurvey : public testing::Test {
 protected:
  void SetUp() override {
    base::Progress::SetQuiet(true);
    folder_ = fs::temp_directory_path() / ("skyquilt_level_survey_" + std::to_string(getpid()));
  }
  void TearDown() override { fs::remove_all(folder_); }

  SimulateSummary Make(const std::string& flight, const std::function<void(SimulateOptions&)>& change = {}) {
    SimulateOptions options;
    options.place = "hamlet";
    options.flight = flight;
    options.image_width = 128;
    options.samples_per_pixel = 1;
    if (change) change(options);
    base::ThreadPool threads(2);
    return Simulate(options, folder_, threads);
  }
  nlohmann::json Summary() const { return base::ParseJson(base::ReadFile(folder_ / "simulate.json")); }
  survey::ColmapModel Model() const { return survey::ReadColmapModel(folder_ / "sparse/0"); }

  fs::path folder_;
};

// Share of NaN in a true depth.
double SkyIn(const fs::path& depth_file) {
  const image::ImageF depth = image::LoadFloatTiff(depth_file);
  const auto n = std::count_if(depth.data.begin(), depth.data.end(), [](float d) { return std::isnan(d); });
  return static_cast<double>(n) / static_cast<double>(depth.data.size());
}

TEST_F(LevelSurvey, AFacadeHasNoPlaceButPointsDepthAndSky) {
  const SimulateSummary made = Make("facade");
  EXPECT_EQ(made.n_photos, 12);
  EXPECT_EQ(made.n_test, 2);
  const survey::ColmapModel model = Model();
  ASSERT_EQ(model.images.size(), 12U);
  EXPECT_GT(model.points.size(), 100U);
  for (const survey::ColmapPoint& point : model.points) EXPECT_GE(point.image_ids.size(), 2U);
  std::set<double> exposures;
  for (const survey::ColmapImage& image : model.images) {
    const survey::PhotoTags tags = survey::ReadPhotoTags(folder_ / "images" / image.name);
    EXPECT_FALSE(tags.gps || tags.relative_altitude_m || tags.absolute_altitude_m || tags.speed_mps);
    EXPECT_FALSE(tags.gimbal_yaw_deg || tags.gimbal_pitch_deg || tags.gimbal_roll_deg);
    ASSERT_TRUE(tags.exposure.time_s && tags.focal_length_35mm && tags.capture_time_s);
    exposures.insert(*tags.exposure.time_s);
  }
  EXPECT_GT(exposures.size(), 4U);
  // The first photo looks past the corner of the house.
  EXPECT_GT(SkyIn(folder_ / "truth/depth/IMG_0001.tiff"), 0.01);
  EXPECT_LT(SkyIn(folder_ / "truth/depth/IMG_0001.tiff"), 0.9);
  const auto summary = Summary();
  EXPECT_EQ(summary["flight"], "facade");
  EXPECT_EQ(summary["options"]["flight"], "facade");
  EXPECT_EQ(summary["truth"]["up_in_model"], nlohmann::json({0.0, 0.0, 1.0}));
  EXPECT_EQ(summary["blocks"]["rows"], 1);
}

TEST_F(LevelSurvey, TheTruthHasUpInAnyFrameAndTagsOnRequest) {
  Make("facade", [](SimulateOptions& options) {
    options.exact_frame = false;
    options.tags = "all";
  });
  const auto truth = Summary()["truth"];
  const auto up = truth["up_in_model"].get<std::vector<double>>();
  const auto q = truth["enu_from_model"]["rotation_wxyz"].get<std::vector<double>>();
  const Eigen::Vector3d up_in_enu = Eigen::Quaterniond(q[0], q[1], q[2], q[3]) * Eigen::Vector3d(up[0], up[1], up[2]);
  EXPECT_LT((up_in_enu - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  const survey::PhotoTags tags = survey::ReadPhotoTags(folder_ / "images/IMG_0001.jpg");
  EXPECT_TRUE(tags.gps && tags.relative_altitude_m && tags.gimbal_pitch_deg);
}

TEST_F(LevelSurvey, ARoomIsNeitherDarkNorClipped) {
  const SimulateSummary made = Make("room", [](SimulateOptions& options) { options.photos = 40; });
  EXPECT_EQ(made.n_photos, 40);
  EXPECT_EQ(made.n_buildings, 0);
  EXPECT_EQ(Summary()["place"], "room");
  const survey::ColmapModel model = Model();
  EXPECT_GT(model.points.size(), 100U);
  for (const survey::ColmapPoint& point : model.points) EXPECT_GE(point.image_ids.size(), 2U);
  int n_glaring = 0;  // into the window
  for (const survey::ColmapImage& image : model.images) {
    const image::Image8 pixels = image::LoadRgb8(folder_ / "images" / image.name);
    double sum = 0.0;
    size_t n_clipped = 0;
    for (const uint8_t value : pixels.data) {
      sum += value;
      n_clipped += value == 255 || value == 0 ? 1U : 0U;
    }
    const auto n = static_cast<double>(pixels.data.size());
    EXPECT_GT(sum / n, 40.0) << image.name;
    EXPECT_LT(sum / n, 200.0) << image.name;
    n_glaring += static_cast<double>(n_clipped) > 0.1 * n ? 1 : 0;
  }
  EXPECT_LT(n_glaring, 14);
  EXPECT_LT(SkyIn(folder_ / "truth/depth/IMG_0001.tiff"), 0.3);
}

// A photo without tags of its place, of a survey.
TEST_F(LevelSurvey, ASurveyCanBeWithoutTagsToo) {
  Make("survey", [](SimulateOptions& options) {
    options.tags = "none";
    options.speed_tags = true;
  });
  const survey::PhotoTags tags = survey::ReadPhotoTags(folder_ / "images/IMG_0001.jpg");
  EXPECT_FALSE(tags.gps || tags.relative_altitude_m || tags.gimbal_pitch_deg || tags.speed_mps);
  const auto summary = Summary();
  EXPECT_EQ(summary["options"]["tags"], "none");
  EXPECT_FALSE(summary.contains("truth"));
}

TEST(LevelSurveyPoints, AreSoughtWhereThereIsTexture) {
  image::Image8 wall(20, 10, 3, 120);
  EXPECT_FALSE(HasTexture(wall, 10, 5));
  EXPECT_FALSE(HasTexture(wall, 0, 9));
  for (int y = 0; y < 10; ++y) wall.At(12, y)[1] = 150;
  EXPECT_TRUE(HasTexture(wall, 10, 5));
  EXPECT_FALSE(HasTexture(wall, 9, 5));
}

TEST(LevelSky, IsBrighterOnTheSunsSideAndPlainBelowTheHorizon) {
  const Sky sky(180.0, 40.0, 1.0, 0.0, 1);
  const auto towards = [](float north, float up) { return Eigen::Vector3f(0.0F, north, up).normalized(); };
  EXPECT_GT(sky.Seen(towards(-1.0F, 0.3F)).sum(), 1.05F * sky.Seen(towards(1.0F, 0.3F)).sum());
  // Paler at the horizon than above.
  EXPECT_GT(sky.Seen(towards(1.0F, 0.05F)).sum(), sky.Seen(towards(1.0F, 1.0F)).sum());
  EXPECT_TRUE(sky.Seen(towards(-1.0F, -0.1F)) == sky.ground_radiance());
}

}  // namespace
}  // namespace skyquilt::simulate
