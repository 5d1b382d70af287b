#include "prepare/poses/rig_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace skyquilt::prepare::poses {
namespace {

// Shots of four cameras around, 10 m apart to the north; headings differ by 90 degrees from shot to shot.
std::vector<input::PhotoFile> Walk(int n_shots, bool with_gps, bool with_yaw) {
  std::vector<input::PhotoFile> photos;
  for (int camera = 0; camera < 4; ++camera) {
    for (int shot = 0; shot < n_shots; ++shot) {
      input::PhotoFile& photo = photos.emplace_back();
      photo.name = "c" + std::to_string(camera) + "/" + std::to_string(100 + shot) + ".jpg";
      photo.width = photo.height = 100;
      input::RigPlace place{.rig = "r.json", .shot = std::to_string(100 + shot) + ".jpg", .camera = "c" + std::to_string(camera), .cam_from_rig = {}};
      place.cam_from_rig.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(-0.5 * std::numbers::pi * camera, Eigen::Vector3d::UnitY()));
      photo.rig = place;
      photo.tags.capture_time_s = 10.0 * shot;
      if (with_gps) photo.tags.gps = geo::Geodetic{47.0 + 9e-5 * shot, 8.0, 500.0};
      if (with_yaw) photo.tags.gimbal_yaw_deg = 90.0 * (camera + shot);
      photo.tags.gimbal_pitch_deg = 0.0;
    }
  }
  return photos;
}

int ShotNumber(const input::PhotoFile& photo) {
  return std::stoi(photo.rig->shot.substr(0, 3)) - 100;
}

TEST(RigPairs, AreOfNearShotsAndLookTheSameWay) {
  const std::vector<input::PhotoFile> photos = Walk(8, true, true);
  const PhotoPairs pairs = PairsOfRigs(photos, 2);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  for (const PhotoPair& pair : pairs) {
    const int apart = std::abs(ShotNumber(photos[pair.a]) - ShotNumber(photos[pair.b]));
    EXPECT_GE(apart, 1);  // views of one shot are 90 degrees apart here
    EXPECT_LE(apart, 2);
    const double turn = std::remainder(*photos[pair.a].tags.gimbal_yaw_deg - *photos[pair.b].tags.gimbal_yaw_deg, 360.0);
    EXPECT_NEAR(turn, 0.0, 1e-9);
  }
  // Each of the seven steps from shot to shot has four pairs; those at the ends reach two steps.
  EXPECT_EQ(pairs.size(), 4U * 9U);
  EXPECT_TRUE(RigsTellAllPairs(photos));
}

TEST(RigPairs, WithoutHeadingsAllViewsOfNearShotsArePaired) {
  EXPECT_EQ(PairsOfRigs(Walk(3, true, false), 1).size(), 2U * 16U);
}

TEST(RigPairs, WithoutPlacesNeighboursInTimeArePaired) {
  const std::vector<input::PhotoFile> photos = Walk(5, false, true);
  const PhotoPairs pairs = PairsOfRigs(photos, 1);
  EXPECT_EQ(pairs.size(), 4U * 4U);
  EXPECT_FALSE(RigsTellAllPairs(photos));
}

TEST(RigPairs, DistantPartsAreConnected) {
  std::vector<input::PhotoFile> photos = Walk(6, true, true);
  for (input::PhotoFile& photo : photos) {
    if (ShotNumber(photo) >= 3) photo.tags.gps->latitude_deg += 0.01;
  }
  const PhotoPairs pairs = PairsOfRigs(photos, 1);
  EXPECT_TRUE(std::any_of(pairs.begin(), pairs.end(),
                          [&](const PhotoPair& pair) { return (ShotNumber(photos[pair.a]) < 3) != (ShotNumber(photos[pair.b]) < 3); }));
}

TEST(RigPairs, ViewsOfOneShotThatOverlapArePaired) {
  std::vector<input::PhotoFile> photos = Walk(1, true, true);
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].rig->cam_from_rig.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(-0.25 * std::numbers::pi * static_cast<double>(i), Eigen::Vector3d::UnitY()));
  }
  EXPECT_EQ(PairsOfRigs(photos, 2).size(), 3U);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
