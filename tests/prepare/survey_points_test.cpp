// Points kept from training, and which photos saw the others.
#include "prepare/survey_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <span>

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
  survey::Survey Fill(int every, const std::set<size_t>& held_out = {}) const {
    survey::Survey survey;
    survey.photos.resize(19);
    for (const size_t i : held_out) survey.photos[i].is_test = true;
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
  for (survey::ColmapPoint& point : model_.points) point.image_ids = {6, 2, 8};
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
  EXPECT_EQ(survey.points.front().track_length, 2) << "not image 4";
}

TEST_F(SurveyPointsTest, PointsNeedTwoTrainingPhotosAndCountWithThese) {
  // Photos 4 and 5, images 6 and 7, are held out.
  for (size_t i = 0; i < model_.points.size(); ++i) {
    const std::vector<std::vector<uint32_t>> observers = {{6, 7, 1}, {1, 2, 3}, {1, 2, 3, 6}, {6, 7}};
    model_.points[i].image_ids = observers[i % 4];
    model_.points[i].rgb[0] = static_cast<uint8_t>(i % 4);
  }
  const survey::Survey survey = Fill(10, {4, 5});
  EXPECT_NEAR(static_cast<double>(survey.points.size() + survey.kept_points.size()), 0.5 * static_cast<double>(model_.points.size()), 2.0);
  const auto list = [](std::span<const int32_t> photos) { return std::vector<int32_t>(photos.begin(), photos.end()); };
  for (size_t i = 0; i < survey.points.size(); ++i) {
    EXPECT_TRUE(survey.points[i].rgb[0] == 1 || survey.points[i].rgb[0] == 2);
    EXPECT_EQ(survey.points[i].track_length, 3);
    EXPECT_EQ(list(survey.tracks.PhotosOf(i)), (std::vector<int32_t>{0, 1, 2}));
  }
  for (size_t i = 0; i < survey.kept_points.size(); ++i) {
    EXPECT_EQ(survey.kept_points[i].track_length, 3);
    const bool seen_by_held_out = survey.kept_points[i].rgb[0] == 2;
    EXPECT_EQ(list(survey.kept_tracks.PhotosOf(i)), seen_by_held_out ? (std::vector<int32_t>{0, 1, 2, 4}) : (std::vector<int32_t>{0, 1, 2}));
  }
}

// Two training photos and a held-out one are no track of three photos: such a point is as uncertain as any of two.
TEST_F(SurveyPointsTest, HeldOutPhotosMakeNoTrackLongEnough) {
  for (size_t i = 0; i < model_.points.size(); ++i)
    model_.points[i].image_ids = i % 3 == 0 ? std::vector<uint32_t>{1, 2, 6} : std::vector<uint32_t>{1, 2, 3};
  const size_t with_held_out = (model_.points.size() + 2) / 3;
  const auto count = [](const survey::Survey& survey) { return survey.points.size() + survey.kept_points.size(); };
  EXPECT_EQ(count(Fill(10)), model_.points.size());
  EXPECT_EQ(count(Fill(10, {4})), model_.points.size() - with_held_out);
}

// The model's observations in held-out photos may be anything.
TEST_F(SurveyPointsTest, DoNotDependOnWhatHeldOutPhotosObserved) {
  const auto observe = [&](bool others) {
    for (size_t i = 0; i < model_.points.size(); ++i) {
      survey::ColmapPoint& point = model_.points[i];
      point.image_ids = i % 7 == 0 ? std::vector<uint32_t>{1} : std::vector<uint32_t>{1, 2, 3};
      if ((i % 2 == 0) != others) point.image_ids.insert(point.image_ids.end(), {6, 7, 8});
    }
    return Fill(10, {4, 5, 6});
  };
  const survey::Survey given = observe(false), other = observe(true);
  ASSERT_EQ(other.points.size(), given.points.size());
  EXPECT_EQ(other.kept_points.size(), given.kept_points.size());
  EXPECT_EQ(other.tracks, given.tracks);
  EXPECT_NE(other.kept_tracks, given.kept_tracks) << "scores look from held-out photos";
  for (size_t i = 0; i < given.points.size(); ++i) {
    EXPECT_EQ(other.points[i].x_in_enu, given.points[i].x_in_enu);
    EXPECT_EQ(other.points[i].track_length, given.points[i].track_length);
  }
}

TEST_F(SurveyPointsTest, OfAModelWithoutTracksAllGoodPointsAreUsed) {
  for (survey::ColmapPoint& point : model_.points) point.image_ids.clear();
  const survey::Survey survey = Fill(10, {4, 5});
  EXPECT_EQ(survey.points.size() + survey.kept_points.size(), model_.points.size());
  EXPECT_FALSE(survey.HasTracks());
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
  const auto trained = loaded.tracks.PhotosOf(0);
  EXPECT_EQ(std::vector<int32_t>(trained.begin(), trained.end()), (std::vector<int32_t>{1, 2})) << "photo 0 is held out";
  EXPECT_EQ(loaded.points.front().track_length, 2);

  options.keep_points = 0;
  const survey::Survey all = Prepare({folder / "images", folder / "sparse/0", folder / "out"}, options, threads);
  EXPECT_TRUE(all.kept_points.empty());
  EXPECT_EQ(all.points.size(), survey.points.size() + survey.kept_points.size());
  EXPECT_FALSE(std::filesystem::exists(folder / "out/kept_points.ply"));
}

}  // namespace
}  // namespace skyquilt::prepare
