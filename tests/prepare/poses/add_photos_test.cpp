#include "prepare/poses/add_photos.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "core/base/random.h"

namespace skyquilt::prepare::poses {
namespace {

Eigen::Quaterniond AnyTurn(base::Random& random) {
  return Eigen::Quaterniond(
      Eigen::Vector4d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(0.1, 1)).normalized());
}

// Photos of one flight line, or of an area, which look down about.
std::vector<geo::Rigid3d> Flight(size_t n, bool line, base::Random& random) {
  std::vector<geo::Rigid3d> poses;
  for (size_t i = 0; i < n; ++i) {
    geo::Rigid3d pose;
    pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi + random.Uniform(-0.1, 0.1), Eigen::Vector3d::UnitX()));
    const Eigen::Vector3d centre(10.0 * static_cast<double>(i), line ? 0.0 : random.Uniform(-40, 40), line ? 50.0 : 50.0 + random.Uniform(-2, 2));
    pose.translation = -(pose.rotation * centre);
    poses.push_back(pose);
  }
  return poses;
}

RC_GTEST_PROP(SimilarityOfPoses, IsFoundFromALineOfPhotosOfWhichSomeAreWrong, ()) {
  base::Random random(*rc::gen::inRange(1, 1'000'000));
  const auto n = static_cast<size_t>(*rc::gen::inRange(3, 40));
  const geo::Similarity3d b_from_a{
      std::pow(10.0, random.Uniform(-2, 2)), AnyTurn(random), {random.Uniform(-1e3, 1e3), random.Uniform(-1e3, 1e3), 7.0}};
  const std::vector<geo::Rigid3d> a = Flight(n, *rc::gen::arbitrary<bool>(), random);
  std::vector<geo::Rigid3d> b;
  for (const geo::Rigid3d& pose : a) b.push_back(geo::TransformCameraWorld(pose, b_from_a));
  for (size_t i = 0; i < (n - 1) / 6; ++i) {
    b[3 * i].rotation = AnyTurn(random);
    b[3 * i].translation += Eigen::Vector3d(300.0, -200.0, 100.0) * b_from_a.scale;
  }
  const geo::Similarity3d found = SimilarityOfPoses(a, b);
  RC_ASSERT(std::abs(found.scale / b_from_a.scale - 1.0) < 1e-9);
  RC_ASSERT(found.rotation.angularDistance(b_from_a.rotation) < 1e-7);
  RC_ASSERT((found.translation - b_from_a.translation).norm() < 1e-6 * (1.0 + b_from_a.scale * 500.0));
}

std::vector<input::PhotoFile> Row(size_t n, double gap_m, bool tags) {
  std::vector<input::PhotoFile> photos;
  for (size_t i = 0; i < n; ++i) {
    input::PhotoFile photo{.name = "p" + std::to_string(1000 + i), .width = 800, .height = 600};
    constexpr double kMetresPerDegree = 111'000.0;
    if (tags) photo.tags.gps = geo::Geodetic{static_cast<double>(i) * gap_m / kMetresPerDegree, 8.0, 100.0};
    photos.push_back(photo);
  }
  return photos;
}

TEST(PhotosAround, AreTheAddedOnesAndTheirNeighbours) {
  const std::vector<input::PhotoFile> photos = Row(200, 10.0, true);
  std::vector<bool> known(200, true);
  for (size_t i = 150; i < 200; ++i) known[i] = false;
  const std::vector<size_t> around = PhotosAround(photos, known);
  for (size_t i = 145; i < 200; ++i) EXPECT_NE(std::find(around.begin(), around.end(), i), around.end()) << i;
  EXPECT_GT(around.front(), 80U) << "far away ones have no part in it";
  EXPECT_TRUE(std::is_sorted(around.begin(), around.end()));
  EXPECT_EQ(PhotosAround(Row(200, 10.0, false), known).size(), 200U) << "without tags nobody knows which are near";
  EXPECT_EQ(PhotosAround(Row(20, 10.0, true), std::vector<bool>(20, true)).size(), 20U) << "of few photos all are";
}

}  // namespace
}  // namespace skyquilt::prepare::poses
