// Surveys made extreme, and the page that tells which trainings fell.
#include "bench/study/stability_bench.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/camera/camera.h"
#include "core/image/image.h"
#include "tests/partition/flown_survey.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

// Sixteen photos of 80 x 60 pixels, grey, from 100 m; two are held out.
class EditedSurvey : public testing::Test {
 protected:
  EditedSurvey() {
    survey_ = partition::FlySurvey({.photos_per_side = 4, .n_points = 500});
    survey_.cameras[0] = survey_.cameras[0].Resized(80, 60);
    survey_.photo_root = folder_ / "photos";
    std::filesystem::create_directories(survey_.photo_root);
    for (survey::Photo& photo : survey_.photos) {
      photo.agl_m = 100.0;
      photo.name = photo.name.substr(0, photo.name.size() - 4) + ".png";
      image::SavePng(image::Image8(80, 60, 3, 60), survey_.photo_root / photo.name);
    }
  }
  survey::Survey Edited(SurveyEdit edit) const { return EditSurvey(survey_, edit, folder_ / "edited"); }
  // Of the first channel, over all photos that this is asked of.
  double MeanRed(const survey::Survey& survey, size_t photo) const {
    const image::Image8 picture = image::LoadRgb8(survey.photo_root / survey.photos[photo].name);
    double sum = 0.0;
    for (size_t i = 0; i < picture.data.size(); i += 3) sum += picture.data[i];
    return 3.0 * sum / static_cast<double>(picture.data.size());
  }
  int PhotosWithRed(const survey::Survey& survey, double low, double high) const {
    int count = 0;
    for (size_t i = 0; i < survey.photos.size(); ++i) count += MeanRed(survey, i) >= low && MeanRed(survey, i) <= high ? 1 : 0;
    return count;
  }

  TemporaryFolder folder_;
  survey::Survey survey_;
};

TEST_F(EditedSurvey, OnePhotoIsBrighterAndOthersAreBlack) {
  const survey::Survey bright = Edited(SurveyEdit::kBrightPhoto);
  EXPECT_EQ(PhotosWithRed(bright, 60.0, 60.0), 15);
  EXPECT_EQ(PhotosWithRed(bright, 150.0, 255.0), 1);
  const survey::Survey black = Edited(SurveyEdit::kBlackPhotos);
  EXPECT_EQ(PhotosWithRed(black, 0.0, 0.0), 4) << "of 14 training photos";
  for (size_t i = 0; i < black.photos.size(); ++i) EXPECT_TRUE(!black.photos[i].is_test || MeanRed(black, i) == 60.0) << i;
}

TEST_F(EditedSurvey, WaterIsInTheWest) {
  const survey::Survey water = Edited(SurveyEdit::kWater);
  for (size_t i = 0; i < water.photos.size(); ++i) {
    const double east = water.photos[i].cam_from_enu.OriginInSource().x();
    EXPECT_TRUE(east > 60.0 || MeanRed(water, i) < 40.0) << east;
    EXPECT_TRUE(east < 170.0 || MeanRed(water, i) > 40.0) << east;
  }
}

TEST_F(EditedSurvey, ScalesToAGroundSamplingDistance) {
  for (const auto& [edit, gsd_m] : {std::pair{SurveyEdit::kMillimetres, 0.001}, {SurveyEdit::kTenMetres, 10.0}}) {
    const survey::Survey scaled = Edited(edit);
    EXPECT_NEAR(camera::GroundSamplingDistance(scaled.cameras[0], scaled.MedianAgl()), gsd_m, 1e-9 * gsd_m);
    // Every point is seen at the same pixel as before.
    for (size_t i = 0; i < scaled.points.size(); i += 100) {
      const auto before = survey_.cameras[0].ImgFromCam(survey_.photos[5].cam_from_enu * survey_.points[i].x_in_enu);
      const auto after = scaled.cameras[0].ImgFromCam(scaled.photos[5].cam_from_enu * scaled.points[i].x_in_enu);
      ASSERT_EQ(before.has_value(), after.has_value());
      EXPECT_TRUE(!before || (*before - *after).norm() < 1e-6);
    }
  }
}

TEST_F(EditedSurvey, ThreeNeighboursStay) {
  // Each point was seen from up to 60 m beside it.
  for (const survey::SparsePoint& point : survey_.points) {
    std::vector<int32_t> photos;
    for (size_t i = 0; i < survey_.photos.size(); ++i) {
      const Eigen::Vector3d eye = survey_.photos[i].cam_from_enu.OriginInSource();
      if ((eye - point.x_in_enu).head<2>().norm() < 60.0) photos.push_back(static_cast<int32_t>(i));
    }
    survey_.tracks.Add(std::move(photos));
  }
  const survey::Survey three = Edited(SurveyEdit::kThreePhotos);
  std::vector<Eigen::Vector3d> eyes;
  for (const survey::Photo& photo : three.photos) {
    if (!photo.is_test) eyes.push_back(photo.cam_from_enu.OriginInSource());
  }
  ASSERT_EQ(eyes.size(), 3U);
  EXPECT_EQ(three.photos.size(), 5U);
  for (const Eigen::Vector3d& eye : eyes) EXPECT_LE((eye - eyes[0]).norm(), 150.0);
  EXPECT_GT(three.points.size(), 5U);
  EXPECT_LT(three.points.size(), survey_.points.size() / 2);
  for (size_t i = 0; i < three.points.size(); ++i) {
    const auto near =
        std::count_if(eyes.begin(), eyes.end(), [&](const Eigen::Vector3d& eye) { return (eye - three.points[i].x_in_enu).head<2>().norm() < 60.0; });
    EXPECT_GE(near, 2);
    EXPECT_EQ(static_cast<size_t>(near), three.tracks.PhotosOf(i).size());
  }
  EXPECT_EQ(Edited(SurveyEdit::kZoneEdge).origin.longitude_deg, 180.0);
}

StabilityRun Made(int seed, double psnr_db, double fall_db, double end_db) {
  StabilityRun run{.survey = "farm", .extreme = "", .blocks = "1x1", .seed = seed, .rate = 1.0, .budget_s = 8.0, .result = {}, .refused = ""};
  run.result.psnr_db = psnr_db;
  run.result.fields = {{.name = "context", .worst_fall_db = 0.1, .end_below_best_db = 0.0},
                       {.name = "r0c0", .falls = fall_db > 1.0 ? 1 : 0, .worst_fall_db = fall_db, .end_below_best_db = end_db}};
  return run;
}

TEST(StabilityPage, CountsWhatFellAndWhatEndsBelowItsBest) {
  std::vector<StabilityRun> runs = {Made(1, 25.0, 0.2, 0.1), Made(2, 25.2, 6.0, 0.3), Made(3, 21.0, 5.0, 4.0)};
  EXPECT_EQ(runs[2].WorstFall(), 5.0);
  EXPECT_EQ(runs[2].WorstEnd(), 4.0);
  EXPECT_EQ(runs[1].Falls(), 1);
  BenchPage page = StabilityPage(runs);
  EXPECT_EQ(page.figures[0].value, "3");
  EXPECT_EQ(page.figures[1].value, "1");
  EXPECT_EQ(page.figures[2].value, "2");
  EXPECT_EQ(page.verdicts[0], "1 of 3 runs end more than 0.5 dB below their best.");
  EXPECT_TRUE(page.verdicts[1].starts_with("1 of 3 runs are more than 0.3 dB below the median")) << page.verdicts[1];
  // A block that is not shown cannot be poor.
  runs[2].result.fields[1].shows_context = true;
  page = StabilityPage(runs);
  EXPECT_EQ(page.figures[1].value, "0");
  EXPECT_EQ(page.figures[3].value, "1");
  EXPECT_EQ(page.verdicts[0], "No run ends more than 0.5 dB below its best.");
}

TEST(StabilityPage, ARefusedRunHasItsReason) {
  StabilityRun refused{.survey = "farm",
                       .extreme = "three-photos",
                       .blocks = "auto",
                       .seed = 1,
                       .rate = 1.0,
                       .budget_s = 8.0,
                       .result = {},
                       .refused = "every block is empty"};
  const std::string csv = BenchCsv(StabilityPage({refused}).sections[1].tables[0]);
  EXPECT_NE(csv.find("every block is empty"), std::string::npos) << csv;
}

}  // namespace
}  // namespace skyquilt::bench
