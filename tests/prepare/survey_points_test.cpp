// Points kept from training, and which photos saw the others.
#include "prepare/survey_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/survey/survey.h"
#include "prepare/prepare.h"
#include "tests/prepare/synthetic_flight.h"

namespace skyquilt::prepare {
namespace {

TEST(IsKeptPoint, AboutOneInTenAndNeverWithoutTheOption) {
  int kept = 0;
  for (uint64_t id = 1; id <= 100'000; ++id) {
    kept += IsKeptPoint(id, 10) ? 1 : 0;
    EXPECT_FALSE(IsKeptPoint(id, 0));
  }
  EXPECT_NEAR(kept, 10'000, 400);  // four standard deviations
}

class SurveyPointsTest : public ::testing::Test {
 protected:
  SurveyPointsTest() {
    // Photo 3 is not in the survey; a point seen twice in one photo.
    for (uint32_t id = 1; id <= 20; ++id) {
      if (id != 4) photo_of_image_[id] = static_cast<int32_t>(id < 4 ? id - 1 : id - 2);
    }
    for (survey::ColmapPoint& point : model_.points) point.image_ids = {6, 2, 4, 6};
  }
  survey::Survey Fill(int every) const {
    survey::Survey survey;
    FillPoints(model_, {}, photo_of_image_, every, survey);
    return survey;
  }

  survey::ColmapModel model_ = test::MakeFlight({47.0, 8.0, 400.0}).model;
  std::unordered_map<uint32_t, int32_t> photo_of_image_;
};

TEST_F(SurveyPointsTest, EveryPointIsEitherKeptOrTrainedOn) {
  const survey::Survey all = Fill(0), some = Fill(10);
  EXPECT_TRUE(all.kept_points.empty());
  EXPECT_EQ(all.points.size(), model_.points.size());
  EXPECT_EQ(some.points.size() + some.kept_points.size(), all.points.size());
  EXPECT_GT(some.kept_points.size(), all.points.size() / 20);
  EXPECT_LT(some.kept_points.size(), all.points.size() / 5);
  EXPECT_TRUE(some.HasTracks());
  std::set<double> trained;
  const auto key = [](const survey::SparsePoint& point) { return point.x_in_enu.x() * 1e3 + point.x_in_enu.y(); };
  for (const survey::SparsePoint& point : some.points) trained.insert(key(point));
  for (const survey::SparsePoint& point : some.kept_points) EXPECT_EQ(trained.count(key(point)), 0U);
}

TEST_F(SurveyPointsTest, TheChoiceDependsOnNothingButTheId) {
  const auto positions = [](const survey::Survey& survey) {
    std::set<std::vector<double>> set;
    for (const survey::SparsePoint& point : survey.kept_points) set.insert({point.x_in_enu.x(), point.x_in_enu.y(), point.x_in_enu.z()});
    return set;
  };
  const auto before = positions(Fill(10));
  std::reverse(model_.points.begin(), model_.points.end());
  photo_of_image_.erase(2);
  EXPECT_EQ(positions(Fill(10)), before);
  for (survey::ColmapPoint& point : model_.points) point.id += 1'000'000;
  EXPECT_NE(positions(Fill(10)), before);
}

TEST_F(SurveyPointsTest, TracksNameThePhotosOfTheSurvey) {
  const survey::Survey survey = Fill(10);
  for (const survey::PointTracks* tracks : {&survey.tracks, &survey.kept_tracks}) {
    for (size_t i = 0; i < tracks->points(); ++i) {
      const auto photos = tracks->PhotosOf(i);
      EXPECT_EQ(std::vector<int32_t>(photos.begin(), photos.end()), (std::vector<int32_t>{1, 4})) << "images 2 and 6";
    }
  }
  EXPECT_EQ(survey.points.front().track_length, 3) << "image 4 too";
}

TEST_F(SurveyPointsTest, TracksStayWithTheirPointsWhenBadOnesAreRemoved) {
  for (size_t i = 0; i < model_.points.size(); ++i) {
    model_.points[i].error_px = i % 5 == 0 ? 9.0 : 0.4;
    model_.points[i].image_ids = {1, 2, static_cast<uint32_t>(5 + i % 7)};
    model_.points[i].rgb[0] = static_cast<uint8_t>(i % 7);
  }
  const survey::Survey survey = Fill(10);
  EXPECT_LT(survey.points.size() + survey.kept_points.size(), model_.points.size() * 9 / 10);
  for (size_t i = 0; i < survey.points.size(); ++i) EXPECT_EQ(survey.tracks.PhotosOf(i).back(), 3 + survey.points[i].rgb[0]);
  for (size_t i = 0; i < survey.kept_points.size(); ++i) EXPECT_EQ(survey.kept_tracks.PhotosOf(i).back(), 3 + survey.kept_points[i].rgb[0]);
}

TEST(Prepare, SavesKeptPointsAndTracks) {
  const TemporaryFolder folder;
  base::ThreadPool threads(2);
  test::WriteFlight(test::MakeFlight({47.0, 8.0, 400.0}), folder.path());
  PrepareOptions options;
  const survey::Survey survey = Prepare({folder / "images", folder / "sparse/0", folder / "out"}, options, threads);
  const survey::Survey loaded = survey::LoadSurvey(folder / "out");
  EXPECT_GT(loaded.kept_points.size(), 50U);
  EXPECT_EQ(loaded.kept_points.size(), survey.kept_points.size());
  EXPECT_EQ(loaded.tracks, survey.tracks);
  const auto photos = loaded.kept_tracks.PhotosOf(0);
  EXPECT_EQ(std::vector<int32_t>(photos.begin(), photos.end()), (std::vector<int32_t>{0, 1, 2}));

  options.keep_points = 0;
  const survey::Survey all = Prepare({folder / "images", folder / "sparse/0", folder / "out"}, options, threads);
  EXPECT_TRUE(all.kept_points.empty());
  EXPECT_EQ(all.points.size(), survey.points.size() + survey.kept_points.size());
  EXPECT_FALSE(std::filesystem::exists(folder / "out/kept_points.ply"));
}

}  // namespace
}  // namespace skyquilt::prepare
