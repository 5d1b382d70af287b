// Variants of a study that are not trained, and the photos that variants train with.
#include <gtest/gtest.h>

#include <numbers>
#include <span>
#include <stdexcept>

#include "bench/study/study.h"
#include "bench/study/thin_survey.h"
#include "core/base/errors.h"
#include "tests/partition/flown_survey.h"
#include "tests/support/connect_alone.h"
#include "tests/support/nadir_photo.h"
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
  const auto names = [](const survey::Survey& of) {
    std::string joined;
    for (const survey::Photo& photo : of.photos) joined += photo.name.substr(0, 1);
    return joined;
  };
  const survey::Survey nadir = ThinSurvey(survey, {.name = "nadir", .label = "", .max_tilt_deg = 10.0});
  EXPECT_EQ(names(nadir), "acdf");
  EXPECT_EQ(names(ThinSurvey(survey, {.name = "n", .label = "", .every_nth_photo = 2, .max_tilt_deg = 10.0})), "adf");
  EXPECT_EQ(names(ThinSurvey(survey, {.name = "n", .label = ""})), "abcdef");
  EXPECT_FALSE((Variant{.name = "n", .label = "", .max_tilt_deg = 10.0}).AllPhotos());
}

TEST(ThinSurvey, KnowsOnlyWhatItsOwnPhotosSaw) {
  survey::Survey survey;
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg", "d.jpg", "e.jpg", "f.jpg"}) survey.photos.push_back(NadirPhoto({0, 0, 100}, name));
  survey.photos[3].is_test = true;
  const auto add = [&survey](double z, std::vector<int32_t> photos, bool kept) {
    (kept ? survey.kept_points : survey.points).push_back({Eigen::Vector3d(0, 0, z), {}, 0.5F, static_cast<int>(photos.size())});
    (kept ? survey.kept_tracks : survey.tracks).Add(std::move(photos));
  };
  // Of the training photos a, b, c, e, f every second stays: a, c, f; d is held out.
  for (int i = 0; i < 3; ++i) add(10.0, {0, 1, 2, 3}, false);  // a, b, c, d
  add(50.0, {1, 2, 4}, false);                                 // b, c, e
  add(51.0, {1, 4}, false);                                    // b, e
  add(52.0, {2, 3}, false);                                    // c, d
  add(53.0, {3, 4, 5, 0}, true);                               // d, e, f, a
  add(54.0, {1, 3, 5}, true);                                  // b, d, f
  const survey::Survey thin = ThinSurvey(survey, {.name = "n", .label = "", .every_nth_photo = 2});
  ASSERT_EQ(thin.photos.size(), 4U);
  ASSERT_EQ(thin.points.size(), 3U);
  const auto observers = [](std::span<const int32_t> photos) { return std::vector<int32_t>(photos.begin(), photos.end()); };
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(thin.points[i].x_in_enu.z(), 10.0);
    EXPECT_EQ(thin.points[i].track_length, 2);
    EXPECT_EQ(observers(thin.tracks.PhotosOf(i)), (std::vector<int32_t>{0, 1})) << "a and c by their new numbers";
  }
  ASSERT_EQ(thin.kept_points.size(), 1U);
  EXPECT_EQ(observers(thin.kept_tracks.PhotosOf(0)), (std::vector<int32_t>{0, 2, 3})) << "scores use the held-out photo";
  for (const survey::Photo& photo : thin.photos) EXPECT_DOUBLE_EQ(photo.agl_m, 90.0) << "above the points that are left";

  survey.tracks = {};
  survey.kept_tracks = {};
  EXPECT_EQ(ThinSurvey(survey, {.name = "n", .label = "", .every_nth_photo = 2}).points.size(), 6U) << "nothing is known of who saw them";
}

TEST_F(UntrainedRun, OnlyOtherSeedsHaveNamesOfTheirOwn) {
  const Study study = Open();
  const Variant variant{.name = "guided", .label = "blocks", .overrides = {{"run.time_budget_s", "8"}}};
  const Variant same = study.WithSeed(variant, study.settings().run.seed), other = study.WithSeed(variant, 7);
  EXPECT_EQ(same.name, "guided") << "its saved result is used";
  EXPECT_EQ(same.label, "blocks");
  EXPECT_EQ(other.name, "guided_s7");
  EXPECT_EQ(other.label, "blocks, seed 7");
  ASSERT_EQ(other.overrides.size(), 2U);
  EXPECT_EQ(other.overrides[1].key, "run.seed");
  EXPECT_EQ(other.overrides[1].value, "7");
}

}  // namespace
}  // namespace skyquilt::bench
