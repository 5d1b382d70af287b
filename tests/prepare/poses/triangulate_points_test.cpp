#include "prepare/poses/triangulate_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>

#include "core/base/child_process.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/poses/pairs.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

// A camera at x that looks along the direction.
geo::Rigid3d Looking(const Eigen::Vector3d& x, const Eigen::Vector3d& direction) {
  const Eigen::Quaterniond cam_from_world = linear::RotationBetween(direction, Eigen::Vector3d::UnitZ());
  return {cam_from_world, -(cam_from_world * x)};
}

TEST(PairsByPose, FewPhotosAreAllPaired) {
  const std::vector<geo::Rigid3d> poses(7, Looking({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}));
  EXPECT_EQ(PairsByPose(poses, {}).size(), 21U);
}

// Lines of photos: neighbours on the same line and across, in a world of any scale.
TEST(PairsByPose, NeighboursOfAGridArePaired) {
  for (const double scale : {1e-3, 1.0, 1e4}) {
    std::vector<geo::Rigid3d> poses;
    for (uint32_t i = 0; i < 100; ++i) poses.push_back(Looking(scale * Eigen::Vector3d(i % 10, 2.0 * (i / 10), 0.0), {0.0, 1.0, 0.2}));
    const PhotoPairs pairs = PairsByPose(poses, {});
    const auto has = [&pairs](uint32_t a, uint32_t b) { return std::binary_search(pairs.begin(), pairs.end(), MakePair(a, b)); };
    for (const uint32_t other : {43U, 45U, 34U, 54U, 33U, 53U, 35U, 55U}) EXPECT_TRUE(has(44, other)) << other << " at scale " << scale;
    EXPECT_FALSE(has(44, 49));
    EXPECT_LT(pairs.size(), 1400U);
  }
}

// Two rings of the same positions that look down and out: photos that look the same way come first, and the rings are linked.
TEST(PairsByPose, DirectionsCountAndGroupsAreLinked) {
  std::vector<geo::Rigid3d> poses;
  for (int i = 0; i < 80; ++i) {
    const Eigen::Vector3d x(static_cast<double>(i % 40), 0.0, 0.0);
    poses.push_back(Looking(x, i < 40 ? Eigen::Vector3d(0.0, 0.0, -1.0) : Eigen::Vector3d(0.0, 1.0, -0.2)));
  }
  PairRules rules;
  rules.neighbors = 4;
  const PhotoPairs pairs = PairsByPose(poses, rules);
  size_t n_between = 0;
  for (const PhotoPair& pair : pairs) n_between += (pair.a < 40) != (pair.b < 40) ? 1 : 0;
  EXPECT_GT(n_between, 0U);
  EXPECT_LT(n_between, 10U);
  EXPECT_EQ(CountGroups(poses.size(), pairs), 1U);
}

// Brighton Beach's own model without its points: where both have a point of the same feature in a photo, its depth must be the same. The tolerance is
// that of a point's depth between neighbouring photos: half a pixel of 1200 at a parallax of a fifth of the photo, 240 pixels, is 0.2 %.
TEST(TriangulatePoints, OfARealModelLieWhereItsOwnPointsWere) {
  const char* data = std::getenv("SKYQUILT_DATA");
  const std::filesystem::path folder = std::filesystem::path(data == nullptr ? "../shared/data" : data) / "brighton_beach";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real photos in " << folder;
  if (base::FindProgram("colmap").empty()) GTEST_SKIP() << "no COLMAP";
  const survey::ColmapModel given = survey::ReadColmapModel(folder / "sparse/0");
  survey::ColmapModel poses;
  poses.cameras = given.cameras;
  std::vector<input::PhotoFile> photos;
  std::map<uint32_t, survey::ColmapImage> images;
  std::map<std::string, survey::ColmapImage> by_name;
  for (const survey::ColmapImage& image : given.images) by_name.emplace(image.name, image);
  for (const auto& [name, image] : by_name) {
    if (photos.size() == 6) break;
    poses.images.push_back(image);
    images.emplace(image.id, image);
    const camera::Camera& camera = given.cameras.at(image.camera_id);
    photos.push_back({.name = image.name, .width = camera.width, .height = camera.height, .tags = {}});
  }
  const TemporaryFolder work;
  const ColmapJob job{.photo_root = folder / "images", .masks = {}, .folder = work / "colmap"};
  PoseOptions options;
  options.max_image_size = 1200;
  base::ThreadPool threads(2);
  const std::vector<survey::ColmapPoint> points = TriangulatePoints(job, photos, poses, options, threads);
  EXPECT_GT(points.size(), 60U);  // woods: few features in three photos

  std::vector<double> off;
  for (const auto& entry : images) {
    // Not [id, image], which clang 14 does not capture.
    const uint32_t id = entry.first;
    const auto& image = entry.second;
    const auto in_photo = [&](const std::vector<survey::ColmapPoint>& all) {
      std::vector<Eigen::Vector3d> seen;  // pixel and depth
      for (const survey::ColmapPoint& point : all) {
        if (std::find(point.image_ids.begin(), point.image_ids.end(), id) == point.image_ids.end()) continue;
        const Eigen::Vector3d x = image.cam_from_world * point.x_in_world;
        if (const auto pixel = given.cameras.at(image.camera_id).ImgFromCam(x)) seen.push_back({pixel->x(), pixel->y(), x.z()});
      }
      return seen;
    };
    const std::vector<Eigen::Vector3d> own = in_photo(given.points);
    for (const Eigen::Vector3d& point : in_photo(points)) {
      for (const Eigen::Vector3d& other : own) {
        if ((point - other).head<2>().norm() < 2.0) off.push_back(std::abs(point.z() / other.z() - 1.0));
      }
    }
  }
  ASSERT_GT(off.size(), 150U);
  std::cout << points.size() << " points, " << off.size() << " compared, median depth difference " << 100.0 * base::Median(off) << " %\n";
  EXPECT_LT(base::Median(off), 0.002);
  std::sort(off.begin(), off.end());
  EXPECT_LT(off[off.size() * 9 / 10], 0.02);

  // Nothing is repeated, and the poses alone repeat only the last step.
  const auto time = std::filesystem::last_write_time(job.Database());
  EXPECT_EQ(TriangulatePoints(job, photos, poses, options, threads).size(), points.size());
  EXPECT_EQ(std::filesystem::last_write_time(job.Database()), time);
  // Poses of other photos: hardly any point fits.
  for (size_t i = 0; i < poses.images.size(); ++i) {
    poses.images[i].cam_from_world.rotation = Eigen::Quaterniond::UnitRandom();
  }
  EXPECT_NE(InputErrorOf([&] { TriangulatePoints(job, photos, poses, options, threads); }).find("Check that the model was made from these photos"),
            std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
