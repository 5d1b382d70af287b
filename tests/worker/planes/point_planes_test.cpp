// A house with a flat roof on two levels and a long wall on level ground, and what must not give planes.
#include "worker/planes/point_planes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.h"
#include "worker/planes/plane_growth.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

constexpr double kGsd_m = 0.03;
constexpr double kReach_m = 0.2;
const geo::BlockBox kBox = {{-40.0, -40.0, -5.0}, {40.0, 40.0, 20.0}, 10.0};

struct Cloud {
  survey::Survey survey;
  base::Random random{11};

  void Add(const Vector3d& x_in_enu) { survey.points.push_back({x_in_enu, {}, 0.5F, 3}); }
  // Points of a parallelogram, with noise across it.
  void AddPatch(const Vector3d& corner, const Vector3d& a, const Vector3d& b, int n, double noise_m) {
    const Vector3d normal = a.cross(b).normalized();
    for (int i = 0; i < n; ++i) Add(corner + random.UniformDouble() * a + random.UniformDouble() * b + noise_m * random.Normal() * normal);
  }
  void AddBall(const Vector3d& centre, double radius_m, int n) {
    while (n > 0) {
      const Vector3d x{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0)};
      if (x.squaredNorm() > 1.0) continue;
      Add(centre + radius_m * x);
      --n;
    }
  }
  void AddOutliers(double share) {
    const auto n = static_cast<int>(share * static_cast<double>(survey.points.size()));
    for (int i = 0; i < n; ++i) Add({random.Uniform(-15.0, 15.0), random.Uniform(-15.0, 15.0), random.Uniform(-1.0, 9.0)});
  }
  PointPlanes Planes() const { return PointPlanes(survey, kBox, kGsd_m); }
};

// Ground at height 0, roofs 8 x 8 m at heights 4 and 7 m, and the wall that looks east below the lower roof.
Cloud House(double noise_m, double outliers) {
  Cloud cloud;
  cloud.AddPatch({-15.0, -15.0, 0.0}, {30.0, 0.0, 0.0}, {0.0, 11.0, 0.0}, 700, noise_m);
  cloud.AddPatch({-8.0, -4.0, 7.0}, {8.0, 0.0, 0.0}, {0.0, 8.0, 0.0}, 200, noise_m);
  cloud.AddPatch({0.0, -4.0, 4.0}, {8.0, 0.0, 0.0}, {0.0, 8.0, 0.0}, 200, noise_m);
  cloud.AddPatch({8.0, -4.0, 0.0}, {0.0, 8.0, 0.0}, {0.0, 0.0, 4.0}, 150, noise_m);
  cloud.AddOutliers(outliers);
  return cloud;
}

void ExpectPlane(const PointPlanes& planes, const Vector3d& on_it, const Vector3d& normal, const char* what) {
  const PointPlane* plane = planes.At(on_it, kReach_m);
  ASSERT_NE(plane, nullptr) << what;
  const double cosine = plane->normal.dot(normal);
  EXPECT_GT(normal.z() > 0.5 ? cosine : std::abs(cosine), std::cos(std::numbers::pi / 180.0)) << what;
  EXPECT_LT(std::abs(plane->normal.dot(on_it - plane->point)), 0.3 * kGsd_m) << what;
  EXPECT_NEAR(plane->rms_m, 0.5 * kGsd_m, 0.25 * kGsd_m) << what;
  EXPECT_GE(plane->points, kFewestRegionPoints) << what;
  EXPECT_NEAR(plane->normal.norm(), 1.0, 1e-12);
}

TEST(PointPlanes, FindsGroundRoofsAndWallDespiteNoiseAndOutliers) {
  const PointPlanes planes = House(0.5 * kGsd_m, 0.05).Planes();
  ExpectPlane(planes, {-4.0, 0.0, 7.0}, Vector3d::UnitZ(), "upper roof");
  ExpectPlane(planes, {4.0, 0.0, 4.0}, Vector3d::UnitZ(), "lower roof");
  ExpectPlane(planes, {8.0, 0.0, 2.0}, Vector3d::UnitX(), "wall");
  ExpectPlane(planes, {0.0, -10.0, 0.0}, Vector3d::UnitZ(), "ground");
  for (const PointPlane& plane : planes.planes()) {
    EXPECT_TRUE(plane.point.allFinite() && plane.normal.allFinite());
    EXPECT_LT(plane.rms_m, 1.5 * kGsd_m);
    const bool level = plane.normal.z() > std::cos(std::numbers::pi / 180.0), vertical = std::abs(plane.normal.z()) < 0.02;
    EXPECT_TRUE(level || vertical) << plane.normal.transpose() << ", " << plane.points << " points";
  }
}

TEST(PointPlanes, SpeakOnlyWithinTheirSupportAndReach) {
  const PointPlanes planes = House(0.5 * kGsd_m, 0.0).Planes();
  const PointPlane* roof = planes.At({-4.0, 0.0, 7.0}, kReach_m);
  ASSERT_NE(roof, nullptr);
  EXPECT_EQ(planes.At({-4.0, 0.0, 7.1}, kReach_m), roof);
  EXPECT_EQ(planes.At({-4.0, 0.0, 6.9}, kReach_m), roof);
  EXPECT_EQ(planes.At({-4.0, 0.0, 7.3}, kReach_m), nullptr) << "above its reach";
  EXPECT_EQ(planes.At({-4.0, 0.0, 7.3}, 0.5), roof);
  EXPECT_EQ(planes.At({-4.0, -6.5, 7.0}, kReach_m), nullptr) << "beside the roof, in its plane";
  EXPECT_EQ(planes.At({-11.0, 0.0, 7.0}, kReach_m), nullptr);
  EXPECT_EQ(planes.At({3.0, 0.0, 7.0}, kReach_m), nullptr) << "over the lower roof";
  EXPECT_EQ(planes.At({-4.0, 0.0, 7.0}, 0.0), nullptr);
  EXPECT_EQ(planes.At({std::nan(""), 0.0, 7.0}, kReach_m), nullptr);
  EXPECT_EQ(planes.At({-4.0, 0.0, 1e300}, kReach_m), nullptr);
  EXPECT_NE(planes.At({-4.0, 0.0, 7.0}, 2.0), nullptr) << "a long reach";
}

TEST(PointPlanes, AreTheSameEachTime) {
  const Cloud cloud = House(0.5 * kGsd_m, 0.05);
  const PointPlanes a = cloud.Planes(), b = cloud.Planes();
  ASSERT_EQ(a.planes().size(), b.planes().size());
  for (size_t i = 0; i < a.planes().size(); ++i) {
    EXPECT_EQ(a.planes()[i].point, b.planes()[i].point);
    EXPECT_EQ(a.planes()[i].normal, b.planes()[i].normal);
    EXPECT_EQ(a.planes()[i].points, b.planes()[i].points);
  }
}

// The directions of roofs and slopes are any.
RC_GTEST_PROP(PointPlanes, FindsAnyTiltedPlane, ()) {
  Cloud cloud;
  cloud.random = base::Random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  base::Random& random = cloud.random;
  const Vector3d normal = Vector3d{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(0.05, 1.0)}.normalized();
  const Vector3d along = normal.unitOrthogonal(), across = normal.cross(along);
  cloud.AddPatch(-6.0 * along - 4.0 * across, 12.0 * along, 8.0 * across, 150, 0.5 * kGsd_m);
  const PointPlanes planes = cloud.Planes();
  RC_ASSERT(planes.planes().size() == 1U);
  const PointPlane* plane = planes.At(Vector3d::Zero(), kReach_m);
  RC_ASSERT(plane != nullptr);
  RC_ASSERT(plane->normal.dot(normal) > std::cos(std::numbers::pi / 180.0));
  RC_ASSERT(std::abs(plane->normal.dot(plane->point)) < 0.3 * kGsd_m);
}

TEST(PointPlanes, TreesGiveNone) {
  Cloud cloud;
  cloud.AddBall({0.0, 0.0, 6.0}, 3.0, 500);
  cloud.AddBall({10.0, 5.0, 8.0}, 5.0, 3000);
  EXPECT_TRUE(cloud.Planes().Empty());
}

// The rms of the points in a plane's band alone would be below the limit for any roughness. A few points may be flat by chance.
TEST(PointPlanes, RoughSurfacesGiveNoneOrAlmostNone) {
  for (const double noise_gsd : {2.0, 3.0, 6.0}) {
    Cloud cloud;
    cloud.AddPatch({-15.0, -15.0, 0.0}, {30.0, 0.0, 0.0}, {0.0, 30.0, 0.0}, 1500, noise_gsd * kGsd_m);
    const PointPlanes planes = cloud.Planes();
    int points = 0;
    for (const PointPlane& plane : planes.planes()) points += plane.points;
    EXPECT_LT(points, 45) << noise_gsd;
  }
}

// Noise outside the band of a plane must not become planes above and below it.
TEST(PointPlanes, ANoisyPlaneIsOne) {
  Cloud cloud;
  cloud.AddPatch({-5.0, -5.0, 0.0}, {10.0, 0.0, 0.0}, {0.0, 10.0, 0.0}, 2000, 1.2 * kGsd_m);
  const PointPlanes planes = cloud.Planes();
  for (const PointPlane& plane : planes.planes()) {
    EXPECT_GT(plane.points, 1000);
    EXPECT_NEAR(plane.rms_m, 1.2 * kGsd_m, 0.15 * kGsd_m);
  }
  EXPECT_EQ(planes.planes().size(), 1U);
}

// A dome of radius 200 m: 30 m away from the top it is 2.3 m lower.
TEST(PointPlanes, CurvedGroundIsSeveralPlanesThatAgreeWhereTheyMeet) {
  constexpr double kRadius_m = 200.0;
  Cloud cloud;
  const auto height = [](double x, double y) { return std::sqrt(kRadius_m * kRadius_m - x * x - y * y) - kRadius_m; };
  for (int i = 0; i < 6000; ++i) {
    const double x = cloud.random.Uniform(-30.0, 30.0), y = cloud.random.Uniform(-30.0, 30.0);
    cloud.Add({x, y, height(x, y) + 0.3 * kGsd_m * cloud.random.Normal()});
  }
  const PointPlanes planes = cloud.Planes();
  EXPECT_GT(planes.planes().size(), 20U);
  int found = 0, all = 0;
  double sum = 0.0, largest = 0.0;
  for (double y = -25.0; y <= 25.0; y += 0.5) {
    for (double x = -25.0; x <= 25.0; x += 0.5, ++all) {
      const Vector3d on(x, y, height(x, y));
      const PointPlane* plane = planes.At(on, kReach_m);
      if (plane == nullptr) continue;
      ++found;
      const double distance = std::abs(plane->normal.dot(on - plane->point));
      sum += distance;
      largest = std::max(largest, distance);
    }
  }
  EXPECT_LT(sum / found, kGsd_m);
  EXPECT_LT(largest, 6.0 * kGsd_m) << "in a gap between planes";
  EXPECT_GT(found, all * 9 / 10);
}

TEST(PointPlanes, LevelGroundOfAnySizeIsCoveredByPlanesOfLimitedSize) {
  Cloud cloud;
  cloud.AddPatch({-40.0, -40.0, 0.0}, {80.0, 0.0, 0.0}, {0.0, 80.0, 0.0}, 6000, 0.5 * kGsd_m);
  const PointPlanes planes = cloud.Planes();
  EXPECT_GE(planes.planes().size(), 4U);
  int found = 0, all = 0;
  for (double y = -38.0; y <= 38.0; ++y) {
    for (double x = -38.0; x <= 38.0; ++x, ++all) found += planes.At({x, y, 0.0}, kReach_m) != nullptr ? 1 : 0;
  }
  EXPECT_GT(found, all * 95 / 100);
}

// A chimney on a roof: its points show that the roof is not the surface there, where a hole without any points would belong to the roof.
TEST(PointPlanes, HolesBelongToAPlaneUnlessPointsShowAnotherSurface) {
  for (const bool chimney : {false, true}) {
    Cloud cloud;
    cloud.AddPatch({-6.0, -6.0, 0.0}, {12.0, 0.0, 0.0}, {0.0, 4.5, 0.0}, 400, 0.5 * kGsd_m);
    cloud.AddPatch({-6.0, 1.5, 0.0}, {12.0, 0.0, 0.0}, {0.0, 4.5, 0.0}, 400, 0.5 * kGsd_m);
    cloud.AddPatch({-6.0, -1.5, 0.0}, {4.5, 0.0, 0.0}, {0.0, 3.0, 0.0}, 100, 0.5 * kGsd_m);
    cloud.AddPatch({1.5, -1.5, 0.0}, {4.5, 0.0, 0.0}, {0.0, 3.0, 0.0}, 100, 0.5 * kGsd_m);
    // Ten ground sampling distances high.
    if (chimney) cloud.AddPatch({-1.2, -1.2, 0.3}, {2.4, 0.0, 0.0}, {0.0, 2.4, 0.0}, 100, 0.5 * kGsd_m);
    const PointPlanes planes = cloud.Planes();
    EXPECT_NE(planes.At({3.0, 0.0, 0.0}, kReach_m), nullptr);
    EXPECT_EQ(planes.At({0.0, 0.0, 0.0}, kReach_m) != nullptr, !chimney);
    EXPECT_EQ(planes.At({0.0, 0.0, 0.3}, kReach_m) != nullptr, chimney);
  }
}

// Corners of turned planes reach the edges of the grids in which supports are kept, whose rounding must not let holes and the outside mix.
RC_GTEST_PROP(PointPlanes, NothingBesideAPlaneIsInItsSupport, ()) {
  Cloud cloud;
  cloud.random = base::Random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const double yaw = cloud.random.Uniform(0.0, 2.0 * std::numbers::pi);
  const Vector3d a(std::cos(yaw), std::sin(yaw), 0.0), b(-a.y(), a.x(), 0.0);
  cloud.AddPatch(-4.0 * a - 4.0 * b, 8.0 * a, 8.0 * b, 600, 0.5 * kGsd_m);
  const PointPlanes planes = cloud.Planes();
  RC_ASSERT(planes.planes().size() == 1U);
  for (double along = -8.0; along <= 8.0; along += 0.25) {
    for (double across = -8.0; across <= 8.0; across += 0.25) {
      const bool found = planes.At(along * a + across * b, kReach_m) != nullptr;
      const double beyond = std::max(std::abs(along), std::abs(across)) - 4.0;
      if (found) RC_ASSERT(beyond < 1.1);    // two diagonals of cells
      if (!found) RC_ASSERT(beyond > -1.6);  // bays of the edge where points happen to be few
    }
  }
}

// A low block on a roof that surrounds it: between the two levels nothing says which one is meant.
TEST(PointPlanes, TheMiddleBetweenTwoPlanesIsAmbiguous) {
  constexpr double kBlock_m = 0.6;
  Cloud cloud;
  const double noise_m = 0.3 * kGsd_m;
  cloud.AddPatch({-5.0, -5.0, 0.0}, {10.0, 0.0, 0.0}, {0.0, 3.0, 0.0}, 300, noise_m);
  cloud.AddPatch({-5.0, 2.0, 0.0}, {10.0, 0.0, 0.0}, {0.0, 3.0, 0.0}, 300, noise_m);
  cloud.AddPatch({-5.0, -2.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, 120, noise_m);
  cloud.AddPatch({2.0, -2.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, 120, noise_m);
  cloud.AddPatch({-2.0, -2.0, kBlock_m}, {4.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, 160, noise_m);
  const PointPlanes planes = cloud.Planes();
  const PointPlane* lower = planes.At({0.0, 0.0, 0.0}, kReach_m);
  const PointPlane* upper = planes.At({0.0, 0.0, kBlock_m}, kReach_m);
  ASSERT_NE(lower, nullptr) << "what points surround is in the support";
  ASSERT_NE(upper, nullptr);
  EXPECT_NE(lower, upper);
  EXPECT_EQ(planes.At({0.0, 0.0, 0.25}, 0.5), nullptr);
  EXPECT_EQ(planes.At({0.0, 0.0, 0.25}, 0.3), lower) << "the upper one is out of reach";
  EXPECT_EQ(planes.At({0.0, -4.0, 0.25}, 0.5), lower) << "nothing above";
  EXPECT_EQ(planes.At({0.0, 0.0, 0.25}, 0.7), lower) << "both in reach, and not farther apart than that";
}

TEST(PointPlanes, TooFewOrUnsuitablePointsGiveNone) {
  Cloud cloud;
  EXPECT_TRUE(cloud.Planes().Empty());
  EXPECT_EQ(cloud.Planes().At({0, 0, 0}, kReach_m), nullptr);
  EXPECT_EQ(PointPlanes().At({0, 0, 0}, kReach_m), nullptr);
  cloud.AddPatch({0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 5.0, 0.0}, kFewestRegionPoints - 1, 0.0);
  EXPECT_TRUE(cloud.Planes().Empty()) << "too few";
  cloud.AddPatch({0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 5.0, 0.0}, 10, 0.0);
  EXPECT_EQ(cloud.Planes().planes().size(), 1U);
  EXPECT_TRUE(PointPlanes(cloud.survey, kBox, 0.0).Empty());
  EXPECT_TRUE(PointPlanes(cloud.survey, kBox, std::nan("")).Empty());
  for (survey::SparsePoint& point : cloud.survey.points) point.error_px = 2.5F;
  EXPECT_TRUE(cloud.Planes().Empty()) << "large errors";

  Cloud equal;
  for (int i = 0; i < 100; ++i) equal.Add({1.0, 2.0, 3.0});
  EXPECT_TRUE(equal.Planes().Empty());
  Cloud line;
  for (int i = 0; i < 100; ++i) line.Add(Vector3d(1.0, 2.0, 3.0) + 0.1 * i * Vector3d(0.3, 0.5, 0.2));
  EXPECT_TRUE(line.Planes().Empty());
  Cloud broken;
  broken.AddPatch({0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 5.0, 0.0}, 100, 0.0);
  for (const Vector3d& x :
       {Vector3d(1.0, 1.0, std::nan("")), Vector3d(std::nan(""), 1.0, 0.0), Vector3d(1.0, 1.0, std::numeric_limits<double>::infinity())})
    broken.Add(x);
  EXPECT_EQ(broken.Planes().planes().size(), 1U) << "points without numbers do no harm";
}

TEST(PointPlanes, PointsOutsideThePlanAndKeptPointsAreNotUsed) {
  Cloud cloud;
  cloud.AddPatch({52.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {0.0, 10.0, 0.0}, 300, 0.0);
  EXPECT_TRUE(cloud.Planes().Empty()) << "beyond the margin";
  Cloud below;
  below.AddPatch({35.0, 0.0, -50.0}, {20.0, 0.0, 0.0}, {0.0, 10.0, 0.0}, 300, 0.0);
  const PointPlanes planes = below.Planes();
  EXPECT_NE(planes.At({48.0, 5.0, -50.0}, kReach_m), nullptr) << "in the margin, below the box";
  EXPECT_EQ(planes.At({53.0, 5.0, -50.0}, kReach_m), nullptr);
  below.survey.kept_points.swap(below.survey.points);
  EXPECT_TRUE(below.Planes().Empty());
}

}  // namespace
}  // namespace skyquilt::worker
