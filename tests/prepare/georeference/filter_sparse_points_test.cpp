#include "prepare/georeference/filter_sparse_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace skyquilt::prepare::georeference {
namespace {

std::vector<survey::SparsePoint> Ground(double z) {
  std::vector<survey::SparsePoint> points;
  for (int x = -20; x < 20; ++x) {
    for (int y = -20; y < 20; ++y) points.push_back({Eigen::Vector3d(2.0 * x, 2.0 * y, z + 0.1 * std::sin(x + 3 * y)), {}, 0.5F, 4});
  }
  return points;
}

survey::Photo PhotoAt(const Eigen::Vector3d& centre) {
  survey::Photo photo;
  photo.cam_from_enu.translation = -centre;
  return photo;
}

TEST(SparseCloud, LargeErrorsShortTracksAndFarPointsGo) {
  std::vector<survey::SparsePoint> points = Ground(5.0);
  const size_t n_good = points.size();
  points.push_back({Eigen::Vector3d(0.0, 0.0, 5.0), {}, 2.5F, 4});
  points.push_back({Eigen::Vector3d(0.0, 0.0, 5.0), {}, 0.5F, 2});
  points.push_back({Eigen::Vector3d(0.0, 0.0, 5.0), {}, std::numeric_limits<float>::quiet_NaN(), 9});
  points.push_back({Eigen::Vector3d(0.0, 0.0, -900.0), {}, 0.5F, 4});
  points.push_back({Eigen::Vector3d(4000.0, 0.0, 5.0), {}, 0.5F, 4});
  FilterSparsePoints(points);
  EXPECT_EQ(points.size(), n_good);
}

TEST(SparseCloud, FewPointsAreKeptRatherThanNone) {
  std::vector<survey::SparsePoint> two_view = Ground(5.0);
  for (survey::SparsePoint& point : two_view) point.track_length = 2;
  const size_t n = two_view.size();
  FilterSparsePoints(two_view);
  EXPECT_EQ(two_view.size(), n);
  std::vector<survey::SparsePoint> none;
  FilterSparsePoints(none);
  EXPECT_TRUE(none.empty());
}

TEST(SparseCloud, AglIsMeasuredToTheGroundBelow) {
  base::ThreadPool threads(2);
  survey::Survey survey;
  survey.points = Ground(5.0);
  // A plateau to the east, a point above the camera and a pit must not change the ground height below the first camera.
  for (survey::SparsePoint& point : survey.points) {
    if (point.x_in_enu.x() > 20.0) point.x_in_enu.z() = 25.0;
  }
  survey.points.push_back({Eigen::Vector3d(0.0, 0.0, 90.0), {}, 0.5F, 4});
  survey.points.push_back({Eigen::Vector3d(0.1, 0.0, -60.0), {}, 0.5F, 4});
  survey.photos = {PhotoAt({0.0, 0.0, 55.0}), PhotoAt({30.0, 0.0, 55.0}), PhotoAt({5000.0, 0.0, 55.0}), PhotoAt({0.0, 0.0, -500.0})};
  MeasureAgl(survey, threads);
  EXPECT_NEAR(survey.photos[0].agl_m, 50.0, 0.2);
  EXPECT_NEAR(survey.photos[1].agl_m, 30.0, 0.2);
  EXPECT_TRUE(std::isnan(survey.photos[2].agl_m));
  EXPECT_TRUE(std::isnan(survey.photos[3].agl_m));
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
