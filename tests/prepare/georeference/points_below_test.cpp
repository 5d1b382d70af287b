#include "prepare/georeference/points_below.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

namespace skyquilt::prepare::georeference {
namespace {

using Found = std::vector<std::pair<double, double>>;

// By looking at every point.
Found NearestPlainly(const std::vector<survey::SparsePoint>& points, const Eigen::Vector3d& place, size_t n) {
  Found below;
  for (const survey::SparsePoint& point : points) {
    if (point.x_in_enu.z() < place.z()) below.emplace_back((point.x_in_enu - place).head<2>().squaredNorm(), point.x_in_enu.z());
  }
  std::sort(below.begin(), below.end());
  below.resize(std::min(n, below.size()));
  return below;
}

Found Sorted(Found found) {
  std::sort(found.begin(), found.end());
  return found;
}

survey::SparsePoint PointAt(double x, double y, double z) {
  survey::SparsePoint point;
  point.x_in_enu = {x, y, z};
  return point;
}

RC_GTEST_PROP(PointsBelowProperty, AreThoseOfThePlainLoop, ()) {
  // In clusters, on lines and in layers, so that many are equally far away.
  const double spacing = *rc::gen::element(0.01, 1.0, 137.0);
  const int width = *rc::gen::element(1, 5, 60), depth = *rc::gen::element(1, 5, 60);
  std::vector<survey::SparsePoint> points;
  const int n_points = *rc::gen::inRange(0, 300);
  for (int i = 0; i < n_points; ++i) {
    const double x = *rc::gen::inRange(0, width), y = *rc::gen::inRange(0, depth), z = *rc::gen::inRange(0, 4);
    points.push_back(PointAt(spacing * x, spacing * y, z));
  }
  const PointsBelow index(points);
  Found found;
  for (int i = 0; i < 5; ++i) {
    const double x = *rc::gen::element(1.0, 1.0, 100.0) * *rc::gen::inRange(-30, 90), y = 0.7 * *rc::gen::inRange(-30, 90);
    const Eigen::Vector3d place(spacing * x, spacing * y, 0.5 * *rc::gen::inRange(0, 10));
    const auto n = *rc::gen::element<size_t>(0, 1, 3, 20, 400);
    index.Nearest(place, n, &found);
    RC_ASSERT(Sorted(found) == NearestPlainly(points, place, n));
  }
}

TEST(PointsBelow, LeavesOutWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PointsBelow index({PointAt(nan, 0, 0), PointAt(1, 2, 3), PointAt(0, std::numeric_limits<double>::infinity(), 0)});
  Found found;
  index.Nearest({0.0, 0.0, 10.0}, 5, &found);
  EXPECT_EQ(found, Found({{5.0, 3.0}}));
  index.Nearest({nan, 0.0, 10.0}, 5, &found);
  EXPECT_TRUE(found.empty());
  PointsBelow({}).Nearest({0.0, 0.0, 10.0}, 5, &found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
