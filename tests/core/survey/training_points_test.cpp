// Photos 1 and 4 of six are held out.
#include "core/survey/training_points.h"

#include <gtest/gtest.h>

namespace skyquilt::survey {
namespace {

Survey SixPhotos() {
  Survey survey;
  survey.photos.resize(6);
  survey.photos[1].is_test = survey.photos[4].is_test = true;
  return survey;
}

void AddSeen(double x, std::vector<int32_t> photos, std::vector<SparsePoint>& points, PointTracks& tracks) {
  points.push_back({Eigen::Vector3d(x, 0.0, 0.0), {1, 2, 3}, 0.5F, static_cast<int>(photos.size())});
  tracks.Add(std::move(photos));
}

Survey WithPoints() {
  Survey survey = SixPhotos();
  AddSeen(0.0, {0, 1, 2}, survey.points, survey.tracks);
  AddSeen(1.0, {1, 4}, survey.points, survey.tracks);     // held-out photos alone
  AddSeen(2.0, {1, 3, 4}, survey.points, survey.tracks);  // one training photo
  AddSeen(3.0, {2, 3, 5}, survey.points, survey.tracks);  // training photos alone
  AddSeen(4.0, {}, survey.points, survey.tracks);         // nobody
  AddSeen(5.0, {0, 1, 2, 4}, survey.kept_points, survey.kept_tracks);
  AddSeen(6.0, {1, 2, 4}, survey.kept_points, survey.kept_tracks);
  return survey;
}

std::vector<int32_t> IndicesOf(std::span<const int32_t> photos) {
  return {photos.begin(), photos.end()};
}

TEST(TrainingPoints, PointsThatFewerThanTwoTrainingPhotosObservedLeave) {
  Survey survey = WithPoints();
  EXPECT_EQ(KeepTrainingObservations(survey), 4U);
  ASSERT_EQ(survey.points.size(), 2U);
  EXPECT_EQ(survey.points[0].x_in_enu.x(), 0.0);
  EXPECT_EQ(survey.points[1].x_in_enu.x(), 3.0);
  ASSERT_EQ(survey.kept_points.size(), 1U);
  EXPECT_EQ(survey.kept_points[0].x_in_enu.x(), 5.0);
  EXPECT_EQ(survey.points[0].error_px, 0.5F);
  EXPECT_EQ(survey.points[0].rgb, (std::array<uint8_t, 3>{1, 2, 3}));
  EXPECT_TRUE(survey.HasTracks());
}

TEST(TrainingPoints, TracksLoseHeldOutPhotosButNotThoseOfKeptPoints) {
  Survey survey = WithPoints();
  KeepTrainingObservations(survey);
  EXPECT_EQ(IndicesOf(survey.tracks.PhotosOf(0)), (std::vector<int32_t>{0, 2}));
  EXPECT_EQ(IndicesOf(survey.tracks.PhotosOf(1)), (std::vector<int32_t>{2, 3, 5}));
  EXPECT_EQ(IndicesOf(survey.kept_tracks.PhotosOf(0)), (std::vector<int32_t>{0, 1, 2, 4}));
  EXPECT_EQ(survey.points[0].track_length, 2);
  EXPECT_EQ(survey.points[1].track_length, 3);
  EXPECT_EQ(survey.kept_points[0].track_length, 2);
}

TEST(TrainingPoints, AreTheSameTheSecondTime) {
  Survey once = WithPoints();
  KeepTrainingObservations(once);
  Survey twice = once;
  EXPECT_EQ(KeepTrainingObservations(twice), 0U);
  EXPECT_EQ(twice.points.size(), once.points.size());
  EXPECT_EQ(twice.kept_points.size(), once.kept_points.size());
  EXPECT_EQ(twice.tracks, once.tracks);
  EXPECT_EQ(twice.kept_tracks, once.kept_tracks);
  for (size_t i = 0; i < once.points.size(); ++i) EXPECT_EQ(twice.points[i].track_length, once.points[i].track_length);
}

// What held-out photos observed, beyond tracks of kept points, leaves no trace.
TEST(TrainingPoints, DoNotDependOnWhatHeldOutPhotosObserved) {
  Survey given = WithPoints(), other = SixPhotos();
  AddSeen(0.0, {0, 2, 4}, other.points, other.tracks);
  AddSeen(1.0, {}, other.points, other.tracks);
  AddSeen(2.0, {3}, other.points, other.tracks);
  AddSeen(3.0, {1, 2, 3, 4, 5}, other.points, other.tracks);
  AddSeen(4.0, {1, 4}, other.points, other.tracks);
  AddSeen(5.0, {0, 2}, other.kept_points, other.kept_tracks);
  KeepTrainingObservations(given);
  KeepTrainingObservations(other);
  ASSERT_EQ(other.points.size(), given.points.size());
  EXPECT_EQ(other.tracks, given.tracks);
  for (size_t i = 0; i < given.points.size(); ++i) {
    EXPECT_EQ(other.points[i].x_in_enu, given.points[i].x_in_enu);
    EXPECT_EQ(other.points[i].track_length, given.points[i].track_length);
  }
  ASSERT_EQ(other.kept_points.size(), given.kept_points.size());
  EXPECT_EQ(other.kept_points[0].track_length, given.kept_points[0].track_length);
}

TEST(TrainingPoints, WithoutTracksAllStay) {
  Survey survey = WithPoints();
  survey.tracks = survey.kept_tracks = {};
  EXPECT_EQ(KeepTrainingObservations(survey), 0U);
  EXPECT_EQ(survey.points.size(), 5U);
  EXPECT_EQ(survey.kept_points.size(), 2U);
  EXPECT_EQ(survey.points[2].track_length, 3);
}

TEST(TrainingPoints, WithNoneHeldOutNoTrackIsShorter) {
  Survey survey = WithPoints();
  for (Photo& photo : survey.photos) photo.is_test = false;
  EXPECT_EQ(KeepTrainingObservations(survey), 1U) << "the point that nobody saw";
  EXPECT_EQ(survey.tracks.observations(), 11U);
}

TEST(CountTrainingPhotos, LeavesOutHeldOutOnes) {
  const Survey survey = SixPhotos();
  EXPECT_EQ(CountTrainingPhotos(survey, std::vector<int32_t>{0, 1, 4, 5}), 2U);
  EXPECT_EQ(CountTrainingPhotos(survey, {}), 0U);
}

}  // namespace
}  // namespace skyquilt::survey
