// Variants of a study that are not trained, and the photos that variants train with.
#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "bench/study/study.h"
#include "bench/study/thin_survey.h"
#include "core/base/errors.h"
#include "tests/partition/flown_survey.h"
#include "tests/support/connect_alone.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

class UntrainedRun : public testing::Test {
 protected:
  UntrainedRun() { survey::SaveSurvey(partition::FlySurvey({.photos_per_side = 4, .n_points = 500}), folder_ / "project/survey"); }

  Study Open(bool restart = false) {
    return Study(
        *comm_,
        {.folder = folder_ / "bench", .survey = {.folder = folder_ / "project", .place = "", .model = {}}, .settings = {}, .restart = restart});
  }
  // A result that tells calls apart.
  Study::UntrainedWork Counting() {
    return [this](coordinator::Pipeline& pipeline, VariantResult* result) {
      EXPECT_TRUE(std::filesystem::exists(pipeline.project.BlocksFile()));
      EXPECT_TRUE(std::filesystem::exists(pipeline.project.SurveyFolder() / "survey.json"));
      result->buildings.emplace().found = ++calls_;
    };
  }

  const TemporaryFolder folder_;
  std::unique_ptr<comm::Communicator> comm_ = comm::ConnectAlone();
  int calls_ = 0;
};

TEST_F(UntrainedRun, IsDoneOnceAndReadAfterwards) {
  const Variant variant{.name = "points_s1", .label = "points"};
  EXPECT_EQ(Open().RunUntrained(variant, Counting()).buildings->found, 1);
  const VariantResult again = Open().RunUntrained(variant, Counting());
  EXPECT_EQ(calls_, 1);
  EXPECT_EQ(again.buildings->found, 1);
  EXPECT_EQ(again.label, "points");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bench/runs/points_s1/survey")) << "large files are removed";
  EXPECT_EQ(Open(true).RunUntrained(variant, Counting()).buildings->found, 2) << "restart forgets it";
}

TEST_F(UntrainedRun, RefusesAResultOfOtherSettings) {
  Open().RunUntrained({.name = "points_s1", .label = "points"}, Counting());
  const Variant other{.name = "points_s1", .label = "points", .overrides = {{"buildings.min_area_m2", "25"}}};
  EXPECT_THROW(Open().RunUntrained(other, Counting()), base::UsageError);
  EXPECT_EQ(calls_, 1);
}

TEST_F(UntrainedRun, IsDoneAgainWhenItWasInterrupted) {
  const Variant variant{.name = "points_s1", .label = "points"};
  const auto stops = [](coordinator::Pipeline&, VariantResult*) { throw std::runtime_error("stopped"); };
  EXPECT_THROW(Open().RunUntrained(variant, stops), std::runtime_error);
  EXPECT_EQ(Open().RunUntrained(variant, Counting()).buildings->found, 1);
}

survey::Photo Tilted(double tilt_deg, const std::string& name) {
  survey::Photo photo = NadirPhoto({0, 0, 100}, name);
  photo.cam_from_enu.rotation = Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX()) * photo.cam_from_enu.rotation;
  return photo;
}

TEST(ThinSurvey, LeavesOutTiltedPhotosButNoHeldOutOnes) {
  survey::Survey survey;
  survey.photos = {Tilted(0, "a.jpg"), Tilted(30, "b.jpg"), Tilted(3, "c.jpg"), Tilted(-30, "d.jpg"), Tilted(90, "e.jpg"), Tilted(2, "f.jpg")};
  survey.photos[3].is_test = true;
  EXPECT_NEAR(TiltDeg(survey.photos[1]), 30.0, 1e-9);
  EXPECT_NEAR(TiltDeg(survey.photos[4]), 90.0, 1e-9);
  survey.points.resize(2);
  survey.tracks.Add({0, 1, 2});
  survey.tracks.Add({1, 3, 5});
  const auto names = [](const survey::Survey& of) {
    std::string joined;
    for (const survey::Photo& photo : of.photos) joined += photo.name.substr(0, 1);
    return joined;
  };
  const survey::Survey nadir = ThinSurvey(survey, {.name = "nadir", .label = "", .max_tilt_deg = 10.0});
  EXPECT_EQ(names(nadir), "acdf");
  EXPECT_EQ(nadir.tracks.PhotosOf(0).size(), 2U);
  EXPECT_EQ(std::vector<int32_t>(nadir.tracks.PhotosOf(1).begin(), nadir.tracks.PhotosOf(1).end()), (std::vector<int32_t>{2, 3}));
  EXPECT_EQ(names(ThinSurvey(survey, {.name = "n", .label = "", .every_nth_photo = 2, .max_tilt_deg = 10.0})), "adf");
  EXPECT_EQ(names(ThinSurvey(survey, {.name = "n", .label = ""})), "abcdef");
  EXPECT_FALSE((Variant{.name = "n", .label = "", .max_tilt_deg = 10.0}).AllPhotos());
}

}  // namespace
}  // namespace skyquilt::bench
