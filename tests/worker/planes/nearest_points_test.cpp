#include "worker/planes/nearest_points.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "core/base/random.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

RC_GTEST_PROP(NearestPoints, AreThoseOfAWholeSearch, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const auto count = static_cast<size_t>(*rc::gen::inRange(0, 200));
  // On a lattice of few numbers, so that many coordinates and points are equal.
  const auto any = [&random] { return Vector3d{1.0 * random.Below(6), 1.0 * random.Below(6), 0.5 * random.Below(3)}; };
  std::vector<Vector3d> points;
  for (size_t i = 0; i < count; ++i) points.push_back(any());
  const Vector3d x = any() + Vector3d(0.1, 0.2, 0.3);
  std::vector<int32_t> found(16, -1);
  const size_t n = NearestPoints(points).Find(x, found);
  RC_ASSERT(n == std::min<size_t>(16, count));
  std::vector<double> expected;
  expected.reserve(points.size());
  for (const Vector3d& point : points) expected.push_back((point - x).squaredNorm());
  std::sort(expected.begin(), expected.end());
  for (size_t i = 0; i < n; ++i) RC_ASSERT((points[static_cast<size_t>(found[i])] - x).squaredNorm() == expected[i]);
  found.resize(n);
  std::sort(found.begin(), found.end());
  RC_ASSERT(std::adjacent_find(found.begin(), found.end()) == found.end());
}

TEST(NearestPoints, ManyEqualPointsAreSearchedFast) {
  const NearestPoints tree(std::vector<Vector3d>(20'000, Vector3d(1, 2, 3)));
  std::vector<int32_t> found(16);
  for (int i = 0; i < 20'000; ++i) ASSERT_EQ(tree.Find({1, 2, 3}, found), 16U);
}

}  // namespace
}  // namespace skyquilt::worker
