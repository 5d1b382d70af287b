// The scale of footprints in the unit frame against differences of the map itself.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "core/encoding/space_map.h"

namespace skyquilt::encoding {
namespace {

double Between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'001) * 1e-6;
}

struct Corners {
  Eigen::Vector3d low, high;
};

Corners AnyBox() {
  const Eigen::Vector3d low(Between(-500.0, 500.0), Between(-500.0, 500.0), Between(-50.0, 50.0));
  return {low, low + Eigen::Vector3d(Between(20.0, 300.0), Between(20.0, 300.0), Between(5.0, 150.0))};
}

// Cube root of |det J| of UnitFromEnu, from central differences over `step` metres. The map returns floats, so that steps must be long.
double ScaleByDifferences(const SpaceMap& map, const Eigen::Vector3d& x_in_enu, double step) {
  Eigen::Matrix3d jacobian;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d ahead = x_in_enu + step * Eigen::Vector3d::Unit(axis), behind = x_in_enu - step * Eigen::Vector3d::Unit(axis);
    jacobian.col(axis) = (map.UnitFromEnu(ahead).cast<double>() - map.UnitFromEnu(behind).cast<double>()) / (2.0 * step);
  }
  return std::cbrt(std::abs(jacobian.determinant()));
}

RC_GTEST_PROP(VolumeScale, OfABoxIsTheRootOfTheJacobianEverywhere, ()) {
  const Corners box = AnyBox();
  const SpaceMap map = SpaceMap::Box(box.low, box.high);
  const Eigen::Vector3d size = box.high - box.low;
  const Eigen::Vector3d x = box.low + size.cwiseProduct(Eigen::Vector3d(Between(0.1, 0.9), Between(0.1, 0.9), Between(0.1, 0.9)));
  RC_ASSERT(std::abs(ScaleByDifferences(map, x, 0.05 * size.minCoeff()) / map.VolumeScale(x) - 1.0) < 1e-4);
}

RC_GTEST_PROP(VolumeScale, OfAContractedMapIsTheRootOfTheJacobianEverywhere, ()) {
  const Corners box = AnyBox();
  const SpaceMap map = SpaceMap::Contracted(box.low, box.high);
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  const double half = 0.5 * (box.high - box.low).head<2>().maxCoeff();
  // Longest and other coordinate in half widths. Inside the square, where the map is linear, or outside; away from its kinks at |u| = 1 and on the
  // diagonals.
  const bool inside = *rc::gen::arbitrary<bool>();
  const double norm = inside ? Between(0.1, 0.95) : std::exp(Between(std::log(1.1), std::log(20.0)));
  Eigen::Vector2d u(norm * (*rc::gen::arbitrary<bool>() ? 1.0 : -1.0), norm * Between(-0.9, 0.9));
  if (*rc::gen::arbitrary<bool>()) std::swap(u.x(), u.y());
  const Eigen::Vector3d x(centre.x() + half * u.x(), centre.y() + half * u.y(), Between(box.low.z(), box.high.z()));
  const double step = half * (inside ? 0.02 : 0.02 * norm);
  RC_ASSERT(std::abs(ScaleByDifferences(map, x, step) / map.VolumeScale(x) - 1.0) < 3e-3);
}

TEST(VolumeScale, IsContinuousAtTheSurveysEdgeAndFallsOutside) {
  const SpaceMap map = SpaceMap::Contracted({-100.0, -80.0, -5.0}, {100.0, 80.0, 40.0});
  EXPECT_NEAR(map.VolumeScale({99.999999, 3.0, 0.0}) / map.VolumeScale({100.000001, 3.0, 0.0}), 1.0, 1e-6);
  EXPECT_DOUBLE_EQ(map.VolumeScale({0.0, 0.0, 0.0}), map.VolumeScale({60.0, -99.0, 30.0}));
  double before = map.VolumeScale({100.0, 0.0, 0.0});
  for (double x = 120.0; x < 2000.0; x *= 1.2) {
    const double here = map.VolumeScale({x, 0.0, 0.0});
    EXPECT_LT(here, before) << x;
    EXPECT_GT(here, 0.0) << x;
    before = here;
  }
}

// A slab that is higher than its square is wide has another scale upwards than across.
TEST(VolumeScale, OfAHighSlabIsTheMeanOfItsScales) {
  const SpaceMap map = SpaceMap::Contracted({-10.0, -10.0, 0.0}, {10.0, 10.0, 200.0});
  EXPECT_NEAR(map.VolumeScale({0.0, 0.0, 100.0}), std::cbrt(0.025 * 0.025 * (1.0 / 200.0)), 1e-12);
}

}  // namespace
}  // namespace skyquilt::encoding
