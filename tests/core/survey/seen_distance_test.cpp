#include "core/survey/seen_distance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::survey {
namespace {

camera::Camera Lens(camera::CameraModel model) {
  camera::Camera camera{model, 800, 600, {500.0, 500.0, 400.0, 300.0}};
  camera.params.resize(static_cast<size_t>(camera::ModelParamCount(model)), 0.0);
  return camera;
}

// At the origin, its view so many degrees below level towards north.
Photo LooksDownBy(double degrees) {
  Eigen::Matrix3d level;
  level << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  Photo photo;
  photo.cam_from_enu.rotation = Eigen::Quaterniond(level) * Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitX()));
  return photo;
}

TEST(LooksLevel, WithinSeventeenDegrees) {
  for (const double degrees : {-15.0, 0.0, 17.0}) EXPECT_TRUE(LooksLevel(LooksDownBy(degrees))) << degrees;
  for (const double degrees : {-90.0, -30.0, 18.0, 45.0, 90.0}) EXPECT_FALSE(LooksLevel(LooksDownBy(degrees))) << degrees;
}

TEST(ViewingDistance, IsAlongTheAxisExceptForFisheyes) {
  const geo::Rigid3d pose = LooksDownBy(0.0).cam_from_enu;
  EXPECT_NEAR(ViewingDistance(Lens(camera::CameraModel::kPinhole), pose, {3.0, 4.0, 0.0}), 4.0, 1e-12);
  EXPECT_NEAR(ViewingDistance(Lens(camera::CameraModel::kOpencvFisheye), pose, {3.0, 4.0, 0.0}), 5.0, 1e-12);
  EXPECT_LT(ViewingDistance(Lens(camera::CameraModel::kPinhole), pose, {0.0, -4.0, 0.0}), 0.0);
}

TEST(DistancesOfLevelPhotos, AreThoseOfThePointsObserved) {
  Survey survey;
  survey.cameras = {Lens(camera::CameraModel::kPinhole)};
  survey.photos = {LooksDownBy(0.0), LooksDownBy(60.0), LooksDownBy(0.0), LooksDownBy(0.0)};
  survey.photos[2].is_test = true;
  for (int i = 0; i <= 40; ++i) {
    SparsePoint point;
    point.x_in_enu = {0.0, 10.0 + i, 0.0};
    survey.points.push_back(point);
    survey.tracks.Add(i < 19 ? std::vector<int32_t>{0, 1, 2, 3} : std::vector<int32_t>{0, 1, 2});
  }
  // Points that are not finite tell nothing.
  survey.points.push_back({{std::nan(""), 1.0, 1.0}});
  survey.tracks.Add({0, 3});
  const std::vector<std::optional<SeenDistance>> seen = DistancesOfLevelPhotos(survey);
  ASSERT_EQ(seen.size(), 4U);
  ASSERT_TRUE(seen[0]);
  EXPECT_NEAR(seen[0]->median_m, 30.0, 1e-9);
  EXPECT_NEAR(seen[0]->far_m, 48.0, 1e-9);
  EXPECT_FALSE(seen[1]) << "does not look level";
  EXPECT_FALSE(seen[2]) << "is held out";
  EXPECT_FALSE(seen[3]) << "observed 19 points";
  survey.tracks = {};
  EXPECT_FALSE(DistancesOfLevelPhotos(survey)[0]) << "unknown";
}

}  // namespace
}  // namespace skyquilt::survey
