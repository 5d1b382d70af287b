#include "prepare/poses/join_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "prepare/poses/seed/verdict.h"
#include "tests/prepare/poses/seed/made_survey.h"

namespace skyquilt::test {
namespace {

using namespace prepare::poses;

// Photos of a made survey, and a model of some of them with the true poses in a frame of its own.
class Joining : public testing::Test {
 protected:
  void Make(const SurveyPlan& plan) {
    made_ = MakeSurvey(plan);
    for (const SeedPhoto& seed : made_.input.photos) {
      prepare::input::PhotoFile photo{.name = seed.name, .width = 1600, .height = 1200, .tags = {}};
      photo.tags.gps = seed.gps;
      photo.tags.gimbal_yaw_deg = seed.yaw_deg;
      photo.tags.gimbal_pitch_deg = seed.pitch_deg;
      photo.tags.gimbal_roll_deg = seed.roll_deg;
      photos_.push_back(std::move(photo));
    }
  }
  // Photos first to last - 1; tied together by points under the flight.
  Part PartOf(uint32_t first, uint32_t last, const geo::Similarity3d& part_from_enu) const {
    Part part;
    part.model.cameras[1] = made_.cameras[0];
    for (uint32_t i = first; i < last; ++i) {
      part.model.images.push_back({i + 1, 1, photos_[i].name, geo::TransformCameraWorld(made_.cam_from_enu[i], part_from_enu)});
      for (uint32_t other = i + 1; other < std::min(i + 3, last); ++other) {
        for (int k = 0; k < 12; ++k) {
          survey::ColmapPoint point;
          point.id = part.model.points.size() + 1;
          Eigen::Vector3d ground = made_.cam_from_enu[i].OriginInSource();
          ground.z() = 0.0;
          point.x_in_world = part_from_enu * ground;
          point.image_ids = {i + 1, other + 1};
          for (const uint32_t id : point.image_ids) part.observations[id].push_back({point.id, {800.0, 600.0}});
          part.model.points.push_back(point);
        }
      }
    }
    return part;
  }
  // Metres between where the joined model has the photos and the truth, relative to the first one.
  double WorstOff(const survey::ColmapModel& model) const {
    const auto off = [&](const survey::ColmapImage& image) -> Eigen::Vector3d {
      return image.cam_from_world.OriginInSource() - made_.cam_from_enu[image.id - 1].OriginInSource();
    };
    double worst = 0.0;
    for (const survey::ColmapImage& image : model.images) worst = std::max(worst, (off(image) - off(model.images.front())).norm());
    return worst;
  }

  const geo::Similarity3d a_{0.05, Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 2.0, -0.5).normalized())), {3.0, -4.0, 5.0}};
  const geo::Similarity3d b_{7.0, Eigen::Quaterniond(Eigen::AngleAxisd(-1.0, Eigen::Vector3d(0.0, 1.0, 1.0).normalized())), {100.0, 0.0, -20.0}};
  MadeSurvey made_;
  std::vector<prepare::input::PhotoFile> photos_;
};

using PartsWithoutCommonFeatures = Joining;

TEST_F(PartsWithoutCommonFeatures, ArePlacedByAnglesAndPositions) {
  for (const bool gimbal : {true, false}) {
    photos_.clear();
    Make({.strips = 6, .gimbal_tags = gimbal, .gap_m = 200.0, .seed = 3});
    const auto joined = JoinParts({PartOf(0, 18, a_), PartOf(18, 36, b_)}, photos_, true);
    ASSERT_TRUE(joined);
    ASSERT_EQ(joined->model.images.size(), 36U);
    // Means of 18 tags with errors of 1.5 m and 3 m, and what their tilt does at the far end.
    EXPECT_LT(WorstOff(joined->model), gimbal ? 5.0 : 12.0);
    EXPECT_EQ(joined->model.cameras.size(), 2U);
    EXPECT_EQ(PartsOf(joined->model).size(), 2U);
    // Every point is seen where its track says.
    std::map<uint64_t, size_t> n_seen;
    for (const auto& [id, seen] : joined->observations) {
      for (const survey::ColmapObservation& one : seen) ++n_seen[one.point_id];
    }
    for (const survey::ColmapPoint& point : joined->model.points) EXPECT_EQ(n_seen[point.id], point.image_ids.size());
  }
}

TEST_F(PartsWithoutCommonFeatures, ThatShowTheSameGroundAreJoinedOnlyWhenNothingElseIsLeft) {
  Make({.strips = 6, .seed = 4});
  const std::vector<Part> parts = {PartOf(0, 18, a_), PartOf(18, 36, b_)};
  EXPECT_FALSE(JoinParts(parts, photos_, true));
  EXPECT_TRUE(JoinParts(parts, photos_, false));
}

TEST_F(PartsWithoutCommonFeatures, APhotoInBothIsOfTheLargest) {
  Make({.strips = 6, .gap_m = 200.0, .seed = 5});
  const auto joined = JoinParts({PartOf(0, 20, a_), PartOf(18, 36, b_)}, photos_, false);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->model.images.size(), 36U);
  EXPECT_EQ(joined->observations.size(), 36U);
}

TEST_F(PartsWithoutCommonFeatures, WrongTagsHaveNoPartInIt) {
  Make({.strips = 6, .gap_m = 200.0, .seed = 6});
  for (const size_t i : {20U, 25U, 30U, 34U}) photos_[i].tags.gps->latitude_deg += 0.01;
  const auto joined = JoinParts({PartOf(0, 18, a_), PartOf(18, 36, b_)}, photos_, true);
  ASSERT_TRUE(joined);
  EXPECT_LT(WorstOff(joined->model), 6.0);
}

TEST_F(PartsWithoutCommonFeatures, StayApartWithoutTags) {
  Make({.strips = 6, .gap_m = 200.0, .seed = 7});
  const std::vector<Part> parts = {PartOf(0, 18, a_), PartOf(18, 36, b_)};
  for (size_t i = 18; i < 36; ++i) photos_[i].tags.gps.reset();
  EXPECT_FALSE(JoinParts(parts, photos_, false)) << "nothing places the second one";
  EXPECT_FALSE(JoinParts({PartOf(0, 18, a_), PartOf(0, kLeastOfPart - 1, b_)}, photos_, false)) << "too small";
  // On a line without angles: nothing holds the tilt.
  photos_.clear();
  Make({.strips = 2, .per_strip = 12, .gps_noise_m = 0.5, .gimbal_tags = false, .gap_m = 300.0, .seed = 8});
  EXPECT_FALSE(JoinParts({PartOf(0, 12, a_), PartOf(12, 24, b_)}, photos_, false));
}

}  // namespace
}  // namespace skyquilt::test
