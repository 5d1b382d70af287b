#include "core/geo/enu_frame.h"

#include <Eigen/Geometry>
#include <limits>

#include "tests/core/geo/generators.h"

namespace skyquilt::geo {
namespace {

// Earth-centred coordinates in closed form (WGS84 defining constants), independent of the library under test.
Eigen::Vector3d Ecef(const Geodetic& position) {
  constexpr double kRadius_m = 6378137.0;
  constexpr double kFlattening = 1.0 / 298.257223563;
  constexpr double kEccentricitySquared = kFlattening * (2.0 - kFlattening);
  const double latitude = position.latitude_deg * std::numbers::pi / 180.0;
  const double longitude = position.longitude_deg * std::numbers::pi / 180.0;
  const double normal = kRadius_m / std::sqrt(1.0 - kEccentricitySquared * std::sin(latitude) * std::sin(latitude));
  const double across = (normal + position.height_m) * std::cos(latitude);
  return {across * std::cos(longitude), across * std::sin(longitude),
          (normal * (1.0 - kEccentricitySquared) + position.height_m) * std::sin(latitude)};
}

Eigen::Vector3d ReferenceEnu(const Geodetic& origin, const Geodetic& position) {
  const double latitude = origin.latitude_deg * std::numbers::pi / 180.0;
  const double longitude = origin.longitude_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d east(-std::sin(longitude), std::cos(longitude), 0.0);
  const Eigen::Vector3d up(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  const Eigen::Vector3d difference = Ecef(position) - Ecef(origin);
  return {difference.dot(east), difference.dot(up.cross(east)), difference.dot(up)};
}

// Earth-centred metres are rounded by 1e-9 m per operation; a micrometre allows for a few hundred operations.
constexpr double kTolerance_m = 1e-6;

RC_GTEST_PROP(EnuFrame, AgreesWithTheClosedForm, ()) {
  const Geodetic origin = *AnyPosition();
  const Geodetic position = *AnyPosition();
  const Eigen::Vector3d enu = EnuFrame(origin).EnuFromGeodetic(position);
  RC_ASSERT((enu - ReferenceEnu(origin, position)).norm() < kTolerance_m);
}

RC_GTEST_PROP(EnuFrame, LocalPointsComeBack, ()) {
  const EnuFrame frame(*AnyPosition());
  const Eigen::Vector3d x(*Between(-1e5, 1e5), *Between(-1e5, 1e5), *Between(-1000.0, 9000.0));
  const Geodetic position = frame.GeodeticFromEnu(x);
  RC_ASSERT(IsValid(position));
  RC_ASSERT(position.longitude_deg >= -180.0 && position.longitude_deg < 180.0);
  RC_ASSERT((frame.EnuFromGeodetic(position) - x).norm() < kTolerance_m);
}

RC_GTEST_PROP(EnuFrame, PositionsComeBack, ()) {
  const EnuFrame frame(*AnyPosition());
  const Geodetic position = *AnyPosition();
  const Geodetic back = frame.GeodeticFromEnu(frame.EnuFromGeodetic(position));
  RC_ASSERT(GroundDistanceMetres(position, back) < kTolerance_m);
  RC_ASSERT(std::abs(position.height_m - back.height_m) < kTolerance_m);
}

TEST(EnuFrame, OriginIsZeroAndUpIsUp) {
  for (const Geodetic origin :
       {Geodetic{90.0, 0.0, 0.0}, Geodetic{-90.0, 120.0, 2800.0}, Geodetic{0.0, -180.0, -400.0}, Geodetic{27.99, 86.93, 8849.0}}) {
    const EnuFrame frame(origin);
    EXPECT_LT(frame.EnuFromGeodetic(origin).norm(), kTolerance_m);
    const Eigen::Vector3d above = frame.EnuFromGeodetic({origin.latitude_deg, origin.longitude_deg, origin.height_m + 100.0});
    EXPECT_LT((above - Eigen::Vector3d(0.0, 0.0, 100.0)).norm(), kTolerance_m);
  }
}

TEST(EnuFrame, CrossesTheDateLineWithoutAJump) {
  const EnuFrame frame({-16.5, 179.9999, 10.0});
  const Eigen::Vector3d x = frame.EnuFromGeodetic({-16.5, -179.9999, 10.0});
  // 0.0002 degrees of a parallel whose radius is N cos(latitude).
  EXPECT_NEAR(x.x(), 21.348, 0.01);
  EXPECT_NEAR(x.y(), 0.0, 0.01);
  const Geodetic east = frame.GeodeticFromEnu({100.0, 0.0, 0.0});
  EXPECT_LT(east.longitude_deg, -179.99);
}

TEST(EnuFrame, RefusesAnImpossibleOrigin) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Geodetic origin : {Geodetic{90.001, 0.0, 0.0}, Geodetic{nan, 0.0, 0.0}, Geodetic{0.0, nan, 0.0}, Geodetic{0.0, 0.0, HUGE_VAL}}) {
    EXPECT_THROW(EnuFrame{origin}, std::invalid_argument);
  }
}

TEST(Geodetic, LongitudeWrapsToTheHalfOpenCircle) {
  for (const auto& [given, expected] : std::vector<std::pair<double, double>>{
           {0.0, 0.0}, {180.0, -180.0}, {-180.0, -180.0}, {540.0, -180.0}, {181.0, -179.0}, {-181.0, 179.0}, {359.5, -0.5}, {1e-17, 1e-17}}) {
    EXPECT_EQ(WrapLongitudeDeg(given), expected) << given;
  }
}

RC_GTEST_PROP(Geodetic, WrappedLongitudeIsTheSameMeridian, ()) {
  const double longitude = *Between(-1e4, 1e4);
  const double wrapped = WrapLongitudeDeg(longitude);
  RC_ASSERT(wrapped >= -180.0 && wrapped < 180.0);
  RC_ASSERT(std::abs(std::remainder(wrapped - longitude, 360.0)) < 1e-11);
}

}  // namespace
}  // namespace skyquilt::geo
