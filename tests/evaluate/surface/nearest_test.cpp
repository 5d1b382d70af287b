#include "evaluate/surface/nearest.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace skyquilt::evaluate::surface {
namespace {

using Eigen::Vector3d;

TEST(NearestOnTriangle, IsInsideOnAnEdgeOrACorner) {
  const Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_NEAR((NearestOnTriangle({1, 1, 7}, a, b, c) - Vector3d(1, 1, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((NearestOnTriangle({1, 1, -7}, a, c, b) - Vector3d(1, 1, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((NearestOnTriangle({2, -3, 1}, a, b, c) - Vector3d(2, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((NearestOnTriangle({4, 4, 0}, a, b, c) - Vector3d(2, 2, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((NearestOnTriangle({9, -1, 0}, a, b, c) - b).norm(), 0.0, 1e-12);
}

TEST(NearestOnTriangle, WorksForTrianglesWithoutArea) {
  const Vector3d a(0, 0, 0), b(4, 0, 0);
  EXPECT_NEAR((NearestOnTriangle({3, 5, 0}, a, b, {2, 0, 0}) - Vector3d(3, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((NearestOnTriangle({3, 5, 0}, a, a, a) - a).norm(), 0.0, 1e-12);
}

TEST(NearestTriangles, FindsNothingBeyondTheLimitOrWithoutTriangles) {
  const std::vector<Eigen::Vector3f> position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<uint32_t, 3>> triangle = {{0, 1, 2}};
  const NearestTriangles one(position, triangle), none({}, {});
  EXPECT_FALSE(one.Nearest({0.2, 0.2, 2.0}, 1.9).has_value());
  EXPECT_NEAR(one.Nearest({0.2, 0.2, 2.0}, 2.1)->distance_m, 2.0, 1e-12);
  EXPECT_TRUE(one.Nearest({0.2, 0.2, 0.0}, 0.0).has_value());
  EXPECT_FALSE(one.Nearest({std::numeric_limits<double>::quiet_NaN(), 0, 0}, 10.0).has_value());
  EXPECT_FALSE(none.Nearest({0, 0, 0}, 10.0).has_value());
}

// Small triangles beside large ones, many in one place, some without area.
RC_GTEST_PROP(NearestTriangles, AgreesWithTryingAllTriangles, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const auto n = *rc::gen::inRange<uint32_t>(1, 200);
  std::vector<Eigen::Vector3f> position;
  std::vector<std::array<uint32_t, 3>> triangle;
  for (uint32_t i = 0; i < n; ++i) {
    const double size = random.Uniform() < 0.1F ? 20.0 : 0.5;
    const Vector3d at = random.Uniform() < 0.2F ? Vector3d(1, 2, 3) : Vector3d{random.Uniform(-9, 9), random.Uniform(-9, 9), random.Uniform(-2, 2)};
    const bool flat = random.Uniform() < 0.1F;
    for (int k = 0; k < 3; ++k) {
      const Vector3d off = flat ? Vector3d(size * k, 0, 0) : Vector3d{size * random.Normal(), size * random.Normal(), size * random.Normal()};
      position.push_back((at + off).cast<float>());
    }
    triangle.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const NearestTriangles nearest(position, triangle);
  for (int k = 0; k < 20; ++k) {
    const Vector3d p{random.Uniform(-12, 12), random.Uniform(-12, 12), random.Uniform(-4, 4)};
    double best = std::numeric_limits<double>::infinity();
    for (const auto& corner : triangle) {
      const Vector3d q =
          NearestOnTriangle(p, position[corner[0]].cast<double>(), position[corner[1]].cast<double>(), position[corner[2]].cast<double>());
      best = std::min(best, (q - p).norm());
    }
    const auto found = nearest.Nearest(p, 1.5);
    RC_ASSERT(found.has_value() == (best <= 1.5));
    if (!found) continue;
    RC_ASSERT(std::abs(found->distance_m - best) < 1e-9);
    RC_ASSERT(std::abs((found->point - p).norm() - best) < 1e-9);
    const auto& corner = triangle[found->triangle];
    const Vector3d q =
        NearestOnTriangle(p, position[corner[0]].cast<double>(), position[corner[1]].cast<double>(), position[corner[2]].cast<double>());
    RC_ASSERT(std::abs((q - p).norm() - best) < 1e-9);
  }
}

// No point inside or outside a triangle is nearer than the one that is returned.
RC_GTEST_PROP(NearestOnTriangle, NoOtherPointOfTheTriangleIsNearer, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const auto any = [&] { return Vector3d{random.Normal(), random.Normal(), random.Normal()}; };
  const Vector3d a = any(), b = any(), c = any(), p = 2.0 * any();
  const Vector3d nearest = NearestOnTriangle(p, a, b, c);
  for (int k = 0; k < 100; ++k) {
    double s = random.UniformDouble(), t = random.UniformDouble();
    if (s + t > 1.0) s = 1.0 - s, t = 1.0 - t;
    RC_ASSERT((a + s * (b - a) + t * (c - a) - p).norm() >= (nearest - p).norm() - 1e-9);
  }
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
