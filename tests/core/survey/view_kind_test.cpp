#include "core/survey/view_kind.h"

#include <gtest/gtest.h>

#include <numbers>

namespace skyquilt::survey {
namespace {

// A photo that looks north, `pitch_deg` above the horizon, turned about its own axis.
Photo Looking(double pitch_deg, double roll_deg = 0.0) {
  constexpr double kRad = std::numbers::pi / 180.0;
  Photo photo;
  // From level north (x east, y down, z north) to the pitch, then about the view.
  Eigen::Matrix3d level;
  level << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(roll_deg * kRad, Eigen::Vector3d::UnitZ()) *
                                                   Eigen::AngleAxisd(-pitch_deg * kRad, Eigen::Vector3d::UnitX()) * Eigen::Quaterniond(level));
  return photo;
}

TEST(LooksLevel, TakesTheMedianOfTrainingPhotos) {
  Survey survey;
  EXPECT_FALSE(LooksLevel(survey));
  survey.photos = {Looking(0.0), Looking(-29.0), Looking(-90.0)};
  EXPECT_TRUE(LooksLevel(survey));
  survey.photos[0] = Looking(-31.0);
  EXPECT_FALSE(LooksLevel(survey));
  survey.photos[2].is_test = true;  // of two the upper one counts
  EXPECT_FALSE(LooksLevel(survey));
  survey.photos[0].is_test = true;
  EXPECT_TRUE(LooksLevel(survey));
  survey.photos[1].is_test = true;
  EXPECT_FALSE(LooksLevel(survey)) << "no training photo";
}

TEST(LooksLevel, CountsUpAsDownAndNoRoll) {
  Survey survey;
  for (const double roll : {0.0, 90.0, 180.0}) {
    survey.photos = {Looking(29.5, roll)};
    EXPECT_TRUE(LooksLevel(survey)) << roll;
    survey.photos = {Looking(30.5, roll)};
    EXPECT_FALSE(LooksLevel(survey)) << roll;
  }
}

TEST(LooksLevel, OfSomePhotos) {
  Survey survey;
  survey.photos = {Looking(0.0), Looking(-90.0), Looking(-80.0)};
  EXPECT_TRUE(LooksLevel(survey, std::vector<int>{0}));
  EXPECT_FALSE(LooksLevel(survey, std::vector<int>{1, 2}));
  EXPECT_FALSE(LooksLevel(survey, std::vector<int>{}));
}

}  // namespace
}  // namespace skyquilt::survey
