// The derivative of the map from ENU to the unit frame, against differences of the map back.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "core/base/random.h"
#include "core/encoding/space_map.h"

namespace skyquilt::encoding {
namespace {

// d ENU / d unit, in double.
Eigen::Matrix3d Inverse(const SpaceMap& map, const Eigen::Vector3d& x_in_unit) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d derivative;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    derivative.col(axis) = (map.EnuFromUnit(x_in_unit + step) - map.EnuFromUnit(x_in_unit - step)) / (2.0 * kStep);
  }
  return derivative;
}

TEST(SpaceMap, DerivativeIsTheInverseOfTheDerivativeBack) {
  const Eigen::Vector3d low(-80.0, 20.0, -5.0), high(120.0, 160.0, 45.0);
  base::Random random(5);
  for (const SpaceMap& map : {SpaceMap::Box(low, high), SpaceMap::Contracted(low, high)}) {
    int contracted = 0;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d x =
          map.extent().cwiseProduct(Eigen::Vector3d{random.Uniform(0.05, 0.95), random.Uniform(0.05, 0.95), random.Uniform(0.05, 0.95)});
      const Eigen::Vector3d x_in_enu = map.EnuFromUnit(x);
      contracted += map.LocalScale(x_in_enu) < 1.0 ? 1 : 0;
      EXPECT_LT((map.UnitPerEnu(x_in_enu) * Inverse(map, x) - Eigen::Matrix3d::Identity()).norm(), 1e-4) << x.transpose();
    }
    EXPECT_EQ(contracted > 50, map.contracted());
  }
}

}  // namespace
}  // namespace skyquilt::encoding
