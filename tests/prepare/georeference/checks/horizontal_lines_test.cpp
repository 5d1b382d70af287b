#include "prepare/georeference/checks/horizontal_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/image/image.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kYaw = 0.4;  // radians

// Stripes on the ground, 6 m wide, along kYaw.
bool Bright(const Vector3d& ground) {
  const double across = -std::sin(kYaw) * ground.x() + std::cos(kYaw) * ground.y();
  return static_cast<long>(std::floor(across / 6.0)) % 2 == 0;
}

// A survey of one photo from 60 m, tilted by `tilt` radians, and turned about the vertical by `turn`.
survey::Survey StripedSurvey(double tilt, double turn, const std::filesystem::path& folder) {
  survey::Survey survey;
  survey.photo_root = folder;
  survey.cameras.push_back({camera::CameraModel::kPinhole, 320, 240, {280.0, 280.0, 160.0, 120.0}});
  survey::Photo photo;
  photo.name = "stripes.png";
  const Eigen::Quaterniond enu_from_cam(Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * Eigen::AngleAxisd(M_PI + tilt, Vector3d::UnitX()));
  const Vector3d origin(5.0, -3.0, 60.0);
  photo.cam_from_enu = {enu_from_cam.conjugate(), -(enu_from_cam.conjugate() * origin)};
  survey.photos.push_back(photo);
  for (int i = 0; i < 5; ++i) survey.points.push_back({Vector3d(i, 0.0, 0.0), {}, 0.5F, 3});
  image::Image8 rgb(320, 240, 3);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      int bright = 0;
      for (int s = 0; s < 16; ++s) {
        const Vector3d ray = enu_from_cam * survey.cameras[0].RayFromImg({x + (s % 4 + 0.5) / 4.0, y + (s / 4 + 0.5) / 4.0});
        if (Bright(origin + ray * (origin.z() / -ray.z()))) ++bright;
      }
      for (int c = 0; c < 3; ++c) rgb.At(x, y)[c] = static_cast<uint8_t>(60 + 8 * bright);
    }
  }
  image::SavePng(rgb, folder / photo.name);
  return survey;
}

TEST(HorizontalLines, HaveTheYawOfTheStripes) {
  base::ThreadPool threads(2);
  for (const double tilt : {0.0, 0.15, -0.3}) {
    for (const double turn : {0.0, 1.1, 2.5}) {
      const survey::Survey survey = StripedSurvey(tilt, turn, testing::TempDir());
      const FoundLines found = FindHorizontalLines(survey, threads);
      EXPECT_EQ(found.photos, 1);
      int good = 0;
      for (const HorizontalLine& line : found.lines) {
        if (std::abs(survey::YawDifference(line.yaw_deg, kYaw * 180.0 / M_PI)) < 1.0) ++good;
        EXPECT_GT(line.length_m, 3.0);
        EXPECT_LT((line.place_enu - Vector2d(5.0, -3.0)).norm(), 90.0);
      }
      EXPECT_GE(good, 4) << tilt << " " << turn;
      EXPECT_GE(good, static_cast<int>(0.9 * static_cast<double>(found.lines.size()))) << tilt << " " << turn;
    }
  }
}

// Held-out photos cannot be read: a look at one would be missed in the count. With 256 photos every eighth one is held out, just where an even choice
// of 32 among all photos falls.
TEST(HorizontalLines, AreSearchedInTrainingPhotosOnly) {
  base::ThreadPool threads(2);
  survey::Survey survey = StripedSurvey(0.0, 0.3, testing::TempDir());
  survey.photos = std::vector<survey::Photo>(256, survey.photos[0]);
  for (size_t i = 0; i < survey.photos.size(); i += 8) {
    survey.photos[i].is_test = true;
    survey.photos[i].name = "absent.png";
  }
  const FoundLines found = FindHorizontalLines(survey, threads);
  EXPECT_EQ(found.photos, kLinePhotos);
  EXPECT_GT(found.lines.size(), 4U * kLinePhotos);
  std::erase_if(survey.photos, [](const survey::Photo& photo) { return photo.is_test; });
  const FoundLines without = FindHorizontalLines(survey, threads);
  ASSERT_EQ(found.lines.size(), without.lines.size());
  for (size_t i = 0; i < found.lines.size(); ++i) EXPECT_EQ(found.lines[i].yaw_deg, without.lines[i].yaw_deg);
}

TEST(HorizontalLines, WithoutHeldOutPhotosAllMayBeChosen) {
  base::ThreadPool threads(2);
  survey::Survey survey = StripedSurvey(0.0, 0.3, testing::TempDir());
  survey.photos = std::vector<survey::Photo>(5, survey.photos[0]);
  EXPECT_EQ(FindHorizontalLines(survey, threads).photos, 5);
  for (survey::Photo& photo : survey.photos) photo.is_test = true;
  EXPECT_EQ(FindHorizontalLines(survey, threads).photos, 0);
}

TEST(HorizontalLines, UnreadablePhotosAreLeftOut) {
  base::ThreadPool threads(1);
  survey::Survey survey = StripedSurvey(0.0, 0.0, testing::TempDir());
  survey.photos[0].name = "absent.png";
  const FoundLines found = FindHorizontalLines(survey, threads);
  EXPECT_EQ(found.photos, 0);
  EXPECT_TRUE(found.lines.empty());
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
