#include "core/geo/ecef.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/geo/enu_frame.h"
#include "tests/core/geo/generators.h"

namespace skyquilt::geo {
namespace {

// Earth-centred metres are rounded by 1e-9 m per operation.
constexpr double kRounding_m = 1e-6;

TEST(Ecef, AxesPointWhereTheStandardSays) {
  constexpr double kEquator_m = 6378137.0;
  constexpr double kPole_m = 6356752.314245;  // semi-minor axis of WGS84
  EXPECT_LT((EcefFromGeodetic({0.0, 0.0, 0.0}) - Eigen::Vector3d(kEquator_m, 0.0, 0.0)).norm(), kRounding_m);
  EXPECT_LT((EcefFromGeodetic({0.0, 90.0, -400.0}) - Eigen::Vector3d(0.0, kEquator_m - 400.0, 0.0)).norm(), kRounding_m);
  EXPECT_LT((EcefFromGeodetic({0.0, 180.0, 0.0}) - Eigen::Vector3d(-kEquator_m, 0.0, 0.0)).norm(), kRounding_m);
  EXPECT_LT((EcefFromGeodetic({90.0, 33.0, 10.0}) - Eigen::Vector3d(0.0, 0.0, kPole_m + 10.0)).norm(), kRounding_m);
  EXPECT_LT((EcefFromGeodetic({-90.0, 33.0, 10.0}) - Eigen::Vector3d(0.0, 0.0, -kPole_m - 10.0)).norm(), kRounding_m);
}

TEST(Ecef, EastNorthAndUpAtTheEquator) {
  const Eigen::Matrix4d transform = EcefFromEnu({0.0, 90.0, 0.0});
  Eigen::Matrix3d expected;
  expected.col(0) = Eigen::Vector3d(-1.0, 0.0, 0.0);
  expected.col(1) = Eigen::Vector3d(0.0, 0.0, 1.0);
  expected.col(2) = Eigen::Vector3d(0.0, 1.0, 0.0);
  EXPECT_LT((transform.topLeftCorner<3, 3>() - expected).cwiseAbs().maxCoeff(), 1e-15);
}

RC_GTEST_PROP(Ecef, TheTransformAgreesWithEnuFrame, ()) {
  const Geodetic origin = *AnyPosition();
  const Eigen::Vector3d x(*Between(-1e4, 1e4), *Between(-1e4, 1e4), *Between(-500.0, 9000.0));
  const Eigen::Matrix4d transform = EcefFromEnu(origin);
  const Eigen::Vector3d moved = transform.topLeftCorner<3, 3>() * x + transform.topRightCorner<3, 1>();
  RC_ASSERT((moved - EcefFromGeodetic(EnuFrame(origin).GeodeticFromEnu(x))).norm() < kRounding_m);
}

RC_GTEST_PROP(Ecef, TheTransformIsRigid, ()) {
  const Eigen::Matrix4d transform = EcefFromEnu(*AnyPosition());
  const Eigen::Matrix3d rotation = transform.topLeftCorner<3, 3>();
  RC_ASSERT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-14);
  RC_ASSERT(rotation.col(0).cross(rotation.col(1)).dot(rotation.col(2)) > 0.0);
  RC_ASSERT(transform.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0));
}

TEST(Ecef, RefusesAnImpossiblePosition) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Geodetic position : {Geodetic{90.001, 0.0, 0.0}, Geodetic{nan, 0.0, 0.0}, Geodetic{0.0, HUGE_VAL, 0.0}}) {
    EXPECT_THROW(EcefFromGeodetic(position), std::invalid_argument);
    EXPECT_THROW(EcefFromEnu(position), std::invalid_argument);
  }
}

}  // namespace
}  // namespace skyquilt::geo
