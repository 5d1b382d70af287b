#include "products/wall_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "products/camera_path.h"

namespace skyquilt::products {
namespace {

// The corner of a house, 20 m along x and 10 m along y, 8 m high, on level ground; turned about z. Photos stand 12 m before both walls.
survey::Survey HouseCorner(double yaw_deg, double noise_m, bool walls = true) {
  const Eigen::AngleAxisd turn(yaw_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
  base::Random random(7);
  survey::Survey survey;
  const auto add = [&](int count, const auto& place) {
    for (int i = 0; i < count; ++i) {
      survey::SparsePoint point;
      point.x_in_enu = turn * Eigen::Vector3d(place()) + noise_m * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
      point.track_length = 3;
      survey.points.push_back(point);
    }
  };
  if (walls) {
    add(600, [&] { return Eigen::Vector3d(random.Uniform(0.0, 20.0), 0.0, random.Uniform(0.0, 8.0)); });
    add(300, [&] { return Eigen::Vector3d(20.0, random.Uniform(0.0, 10.0), random.Uniform(0.0, 8.0)); });
  }
  add(800, [&] { return Eigen::Vector3d(random.Uniform(-5.0, 35.0), random.Uniform(-12.0, -0.5), 0.0); });
  add(100, [&] { return Eigen::Vector3d(random.Uniform(-5.0, 35.0), random.Uniform(-12.0, 12.0), random.Uniform(0.0, 8.0)); });
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d eye = i < 5 ? Eigen::Vector3d(2.0 + 4.0 * i, -12.0, 2.0) : Eigen::Vector3d(32.0, 2.0 + 3.0 * (i - 5), 2.0);
    const Eigen::Vector3d ahead = i < 5 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-Eigen::Vector3d::UnitX());
    survey::Photo photo;
    photo.cam_from_enu = PoseLookingAt(turn * eye, turn * (eye + ahead));
    survey.photos.push_back(photo);
  }
  return survey;
}

TEST(FindWalls, FindsBothWallsOfACorner) {
  for (const double yaw : {0.0, 33.0}) {
    for (const bool with_directions : {false, true}) {
      survey::Survey survey = HouseCorner(yaw, 0.01);
      if (with_directions) survey.directions.modes = {{.yaw_deg = yaw, .share = 1.0}};
      const std::vector<Wall> walls = FindWalls(survey);
      ASSERT_EQ(walls.size(), 2U) << yaw;
      const Eigen::AngleAxisd turn(yaw * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
      const double degree = std::numbers::pi / 180.0;
      EXPECT_GT(walls[0].normal_enu.dot(turn * Eigen::Vector3d(0, -1, 0)), std::cos(0.5 * degree));
      EXPECT_GT(walls[1].normal_enu.dot(turn * Eigen::Vector3d(1, 0, 0)), std::cos(0.5 * degree));
      EXPECT_NEAR(walls[0].width_m, 20.0, 1.5);
      EXPECT_NEAR(walls[1].width_m, 10.0, 1.5);
      for (const Wall& wall : walls) {
        EXPECT_NEAR(wall.height_m, 8.0, 0.8);
        EXPECT_EQ(wall.normal_enu.z(), 0.0);
        EXPECT_GE(wall.points, 250U);
      }
      EXPECT_NEAR(walls[0].normal_enu.dot(walls[0].middle_enu), 0.0, 0.03);
      EXPECT_NEAR((turn.inverse() * walls[1].middle_enu).x(), 20.0, 0.03);
    }
  }
}

TEST(FindWalls, TakesNoOtherPointsForWalls) {
  EXPECT_TRUE(FindWalls(HouseCorner(10.0, 0.02, false)).empty()) << "ground and scattered points";
  survey::Survey survey = HouseCorner(0.0, 0.01);
  EXPECT_EQ(FindWalls(survey, 1).size(), 1U);
  survey.photos.clear();
  EXPECT_TRUE(FindWalls(survey).empty());
  EXPECT_TRUE(FindWalls({}).empty());
}

TEST(FindWalls, LooksToThePhotosThatSawItsPoints) {
  // The survey's photos look at the wall from the south; those of the tracks stand behind it.
  survey::Survey survey = HouseCorner(0.0, 0.01);
  for (int i = 0; i < 3; ++i) {
    survey::Photo photo;
    photo.cam_from_enu = PoseLookingAt({5.0 * i, 12.0, 2.0}, {5.0 * i, 0.0, 2.0});
    survey.photos.push_back(photo);
  }
  for (size_t i = 0; i < survey.points.size(); ++i) survey.tracks.Add({8, 9, 10});
  const std::vector<Wall> walls = FindWalls(survey);
  ASSERT_FALSE(walls.empty());
  EXPECT_NEAR(walls[0].normal_enu.y(), 1.0, 1e-3);
}

}  // namespace
}  // namespace skyquilt::products
