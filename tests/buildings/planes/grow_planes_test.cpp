#include "buildings/planes/grow_planes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "buildings/planes/point_grid.h"
#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSpacing_m = 0.25;

// Rectangles of points with noise of their places and normals.
class MadePlanes {
 public:
  explicit MadePlanes(uint64_t seed) : random_(seed) {
    cloud_.middle = {1000.0, -2000.0, 50.0};
    cloud_.spacing_m = kSpacing_m;
  }
  // z = z0 + slope (x - x0) over [x0, x1) x [y0, y1).
  void Add(double x0, double x1, double y0, double y1, double z0, double slope, double noise_m) {
    const Eigen::Vector3d normal = Eigen::Vector3d(-slope, 0, 1).normalized();
    const double step = kSpacing_m * normal.z();  // along x, so that the spacing on the slope is even
    for (double x = x0 + 0.5 * step; x < x1; x += step) {
      for (double y = y0 + 0.5 * kSpacing_m; y < y1; y += kSpacing_m) {
        const double to_east = 0.05 * random_.Normal();
        const Eigen::Vector3d at(x + to_east, y + 0.05 * random_.Normal(), z0 + slope * (x + to_east - x0));
        const Eigen::Vector3d measured = at + noise_m * random_.Normal() * normal;
        AddPoint(measured, normal + 0.15 * Eigen::Vector3d{random_.Normal(), random_.Normal(), random_.Normal()});
      }
    }
    ++n_;
  }
  void AddPoint(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
    cloud_.points.push_back({at.cast<float>(), normal.normalized().cast<float>(), {128, 128, 128}, 5, 0});
    plane_.push_back(n_);
  }
  const PointCloud& cloud() const { return cloud_; }
  int PlaneOf(uint32_t point) const { return plane_[point]; }
  std::vector<uint32_t> All() const {
    std::vector<uint32_t> all(cloud_.points.size());
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }
  base::Random& random() { return random_; }

 private:
  base::Random random_;
  PointCloud cloud_;
  std::vector<int> plane_;
  int n_ = 0;
};

PlaneOptions Options() {
  return {.distance_m = 0.25, .angle_deg = 25.0, .reach_m = 0.55, .min_points = 15, .min_area_m2 = 2.0};
}

void RequireDisjoint(const std::vector<RoofPlane>& planes) {
  std::vector<uint32_t> all;
  for (const RoofPlane& plane : planes) all.insert(all.end(), plane.points.begin(), plane.points.end());
  const size_t n = all.size();
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  RC_ASSERT(all.size() == n);
}

bool Same(const std::vector<RoofPlane>& a, const std::vector<RoofPlane>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const RoofPlane& x, const RoofPlane& y) {
    return x.points == y.points && x.normal == y.normal && x.middle == y.middle && x.rms_m == y.rms_m;
  });
}

// A gable roof and a flat one beside it.
RC_GTEST_PROP(GrowPlanes, FindsTheSlopesOfAHouse, ()) {
  const double pitch = *rc::gen::inRange(15, 61) * std::numbers::pi / 180.0, slope = std::tan(pitch);
  const double noise_m = *rc::gen::inRange(0, 7) / 100.0, half = 4.0;
  MadePlanes made(*rc::gen::inRange<uint64_t>(1, 1000000));
  made.Add(0, half, 0, 6, 5, slope, noise_m);
  made.Add(half, 2 * half, 0, 6, 5 + half * slope, -slope, noise_m);
  made.Add(2 * half + 0.1, 2 * half + 5, 0, 4, 3, 0, noise_m);
  base::ThreadPool one(1), three(3);
  const std::vector<RoofPlane> planes = GrowPlanes(made.cloud(), made.All(), Options(), one);
  RC_ASSERT(Same(planes, GrowPlanes(made.cloud(), made.All(), Options(), three)));
  RequireDisjoint(planes);
  RC_ASSERT(planes.size() == 3U);
  RC_ASSERT(std::is_sorted(planes.begin(), planes.end(), [](const RoofPlane& a, const RoofPlane& b) { return a.points.size() > b.points.size(); }));
  const auto normal_of = [&](int made_plane) -> Eigen::Vector3d {
    return made_plane == 2 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(made_plane == 0 ? -slope : slope, 0, 1).normalized();
  };
  const auto distance = [&](int made_plane, uint32_t i) {
    const Eigen::Vector3d on_it = made_plane == 2 ? Eigen::Vector3d(9, 0, 3) : Eigen::Vector3d(half, 0, 5 + half * slope);
    return std::abs(normal_of(made_plane).dot(made.cloud().points[i].position.cast<double>() - on_it));
  };
  for (const RoofPlane& plane : planes) {
    std::vector<size_t> of(3, 0);
    for (const uint32_t i : plane.points) ++of[static_cast<size_t>(made.PlaneOf(i))];
    const auto main = static_cast<int>(std::max_element(of.begin(), of.end()) - of.begin());
    // Noise decides between slopes beside a flat ridge, so a share of right points would say little: each must be with the closest plane, but for the
    // errors of the fitted planes.
    for (const uint32_t i : plane.points) RC_ASSERT(distance(main, i) < distance(made.PlaneOf(i), i) + 0.06);
    RC_ASSERT(static_cast<double>(of[static_cast<size_t>(main)]) > 0.9 * static_cast<double>(plane.points.size()));
    RC_ASSERT(plane.normal.dot(normal_of(main)) > std::cos(0.035));
    RC_ASSERT(plane.rms_m < noise_m + 0.03);
    const double area = main == 2 ? 4.9 * 4 : 6 * half / std::cos(pitch);
    RC_ASSERT(std::abs(plane.area_m2 - area) < 0.1 * area);
  }
}

TEST(GrowPlanes, SeesNoPlanesInScatteredPoints) {
  MadePlanes made(3);
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d at(made.random().Uniform(0, 6), made.random().Uniform(0, 6), made.random().Uniform(0, 6));
    made.AddPoint(at, {made.random().Normal(), made.random().Normal(), made.random().Normal()});
  }
  base::ThreadPool threads(2);
  EXPECT_TRUE(GrowPlanes(made.cloud(), made.All(), Options(), threads).empty());
}

TEST(GrowPlanes, StepsAboveTheToleranceSeparate) {
  MadePlanes made(4);
  made.Add(0, 5, 0, 5, 10.0, 0, 0.03);
  made.Add(5, 10, 0, 5, 10.6, 0, 0.03);
  base::ThreadPool threads(2);
  const std::vector<RoofPlane> planes = GrowPlanes(made.cloud(), made.All(), Options(), threads);
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_NEAR(std::abs(planes[0].middle.z() - planes[1].middle.z()), 0.6, 0.02);
  EXPECT_NEAR(planes[0].middle.z() + planes[1].middle.z(), 120.6, 0.02);  // ENU, not relative to the cloud's middle
}

TEST(GrowPlanes, OnlyChosenPointsAndLargeEnoughPlanes) {
  MadePlanes made(5);
  made.Add(0, 6, 0, 6, 10.0, 0, 0.02);
  made.Add(20, 21, 0, 1.5, 10.0, 0, 0.02);  // 1.5 m2
  std::vector<uint32_t> chosen;
  for (const uint32_t i : made.All()) {
    if (made.PlaneOf(i) == 1 || made.cloud().points[i].position.x() < 3.0F) chosen.push_back(i);
  }
  base::ThreadPool threads(2);
  const std::vector<RoofPlane> planes = GrowPlanes(made.cloud(), chosen, Options(), threads);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].area_m2, 18.0, 1.5);
  for (const uint32_t i : planes[0].points) EXPECT_TRUE(std::binary_search(chosen.begin(), chosen.end(), i));
  EXPECT_TRUE(GrowPlanes(made.cloud(), {}, Options(), threads).empty());
}

// Both sides of a thin slab lie within the tolerance of one plane, but look in opposite directions.
TEST(GrowPlanes, KeepsTheSidesOfASlabApart) {
  MadePlanes made(6);
  made.Add(0, 5, 0, 5, 10.0, 0, 0.01);
  for (const uint32_t i : made.All()) {
    const Eigen::Vector3d at = made.cloud().points[i].position.cast<double>();
    made.AddPoint(at - Eigen::Vector3d(0.02, 0.03, 0.15), -Eigen::Vector3d::UnitZ());
  }
  base::ThreadPool threads(2);
  for (const RoofPlane& plane : GrowPlanes(made.cloud(), made.All(), Options(), threads)) {
    for (const uint32_t i : plane.points) EXPECT_GT(plane.normal.dot(made.cloud().points[i].normal.cast<double>()), 0.0);
  }
}

RC_GTEST_PROP(PointGrid, FindsTheNearest, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000000));
  PointCloud cloud;
  std::vector<uint32_t> chosen;
  for (uint32_t i = 0; i < 300; ++i) {
    const Eigen::Vector3d at{random.Uniform(-3, 3), random.Uniform(-3, 3), random.Uniform(-1, 1)};
    cloud.points.push_back({at.cast<float>(), Eigen::Vector3f::UnitZ(), {0, 0, 0}, 0, 0});
    if (i % 3 != 0) chosen.push_back(i);
  }
  const double reach_m = random.Uniform(0.2, 1.5);
  const auto most = static_cast<size_t>(1 + random.Below(20));
  const PointGrid grid(cloud, chosen, reach_m);
  const uint32_t place = random.Below(static_cast<uint32_t>(chosen.size()));
  std::vector<std::pair<float, uint32_t>> expected;
  for (uint32_t p = 0; p < chosen.size(); ++p) {
    const float squared = (cloud.points[chosen[p]].position - cloud.points[chosen[place]].position).squaredNorm();
    if (squared <= static_cast<float>(reach_m * reach_m)) expected.emplace_back(squared, p);
  }
  std::sort(expected.begin(), expected.end());
  expected.resize(std::min(expected.size(), most));
  std::vector<PointGrid::Found> found;
  grid.Near(place, reach_m, most, &found);
  RC_ASSERT(found.size() == expected.size());
  for (size_t i = 0; i < found.size(); ++i) RC_ASSERT(found[i].place == expected[i].second);
}

}  // namespace
}  // namespace skyquilt::buildings
