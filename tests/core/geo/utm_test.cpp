#include "core/geo/utm.h"

#include <limits>
#include <stdexcept>

#include "tests/core/geo/generators.h"

namespace skyquilt::geo {
namespace {

RC_GTEST_PROP(Utm, PositionsComeBack, ()) {
  const Geodetic position = *AnyPosition();
  const UtmZone zone = UtmZoneOf(position);
  const Eigen::Vector2d plane = UtmFromGeodetic(position, zone);
  const Geodetic back = GeodeticFromUtm(plane, position.height_m, zone);
  RC_ASSERT(GroundDistanceMetres(position, back) < 1e-6);
  RC_ASSERT(back.height_m == position.height_m);
  RC_ASSERT((UtmFromGeodetic(back, zone) - plane).norm() < 1e-6);
}

// A survey across a zone's edge is mapped in the zone of its origin.
RC_GTEST_PROP(Utm, NeighbouringZonesAndTheOtherHemisphereComeBack, ()) {
  const UtmZone zone{*rc::gen::inRange(1, 61), *rc::gen::element(true, false)};
  const double latitude = *Between(-80.0, 80.0);
  const Geodetic position{latitude, WrapLongitudeDeg(6.0 * zone.zone - 183.0 + *Between(-6.0, 6.0)), 0.0};
  RC_ASSERT(GroundDistanceMetres(position, GeodeticFromUtm(UtmFromGeodetic(position, zone), 0.0, zone)) < 1e-6);
}

TEST(Utm, MatchesPublishedCoordinates) {
  // CN Tower, 17N 630084 4833438 (Wikipedia, "Universal Transverse Mercator coordinate system"), given to the metre.
  const Geodetic tower{43.0 + 38.0 / 60.0 + 33.24 / 3600.0, -(79.0 + 23.0 / 60.0 + 13.7 / 3600.0), 0.0};
  const UtmZone zone = UtmZoneOf(tower);
  EXPECT_EQ(zone.Name(), "UTM 17N");
  EXPECT_LT((UtmFromGeodetic(tower, zone) - Eigen::Vector2d(630084.0, 4833438.0)).cwiseAbs().maxCoeff(), 1.0);
  // On a central meridian the northing is 0.9996 of the WGS84 meridian arc, 4984944.378 m at 45 degrees.
  const Eigen::Vector2d arc = UtmFromGeodetic({45.0, 9.0, 0.0}, {32, true});
  EXPECT_NEAR(arc.x(), 500000.0, 1e-6);
  EXPECT_NEAR(arc.y(), 0.9996 * 4984944.378, 1e-3);
  EXPECT_LT((UtmFromGeodetic({90.0, 77.0, 0.0}, {0, true}) - Eigen::Vector2d(2e6, 2e6)).norm(), 1e-6);
}

TEST(Utm, ZonesFollowTheMap) {
  const auto name = [](double latitude_deg, double longitude_deg) { return UtmZoneOf({latitude_deg, longitude_deg, 0.0}).Name(); };
  EXPECT_EQ(name(-33.9, 151.2), "UTM 56S");
  EXPECT_EQ(name(10.0, -180.0), "UTM 1N");
  EXPECT_EQ(name(10.0, 180.0), "UTM 1N");
  EXPECT_EQ(name(10.0, 179.9), "UTM 60N");
  EXPECT_EQ(name(0.0, 0.0), "UTM 31N");
  EXPECT_EQ(name(60.4, 5.3), "UTM 32N") << "the Norwegian exception";
  EXPECT_EQ(name(78.0, 8.0), "UTM 31N") << "the Svalbard exception";
  EXPECT_EQ(name(84.0, 30.0), "UPS N");
  EXPECT_EQ(name(-80.1, 30.0), "UPS S");
  EXPECT_EQ(name(-90.0, 0.0), "UPS S");
}

TEST(Utm, EpsgCodes) {
  EXPECT_EQ((UtmZone{15, true}.Epsg()), 32615);
  EXPECT_EQ((UtmZone{56, false}.Epsg()), 32756);
  EXPECT_EQ((UtmZone{0, true}.Epsg()), 32661);
  EXPECT_EQ((UtmZone{0, false}.Epsg()), 32761);
}

TEST(Utm, EquatorIsCrossedWithoutAJump) {
  const UtmZone north{33, true};
  const double above = UtmFromGeodetic({1e-6, 15.0, 0.0}, north).y();
  const double below = UtmFromGeodetic({-1e-6, 15.0, 0.0}, north).y();
  EXPECT_NEAR(above - below, 2e-6 * 110574.0 * 0.9996, 1e-4);
  EXPECT_NEAR(UtmFromGeodetic({-1e-6, 15.0, 0.0}, {33, false}).y() - below, 1e7, 1e-6);
}

TEST(Utm, InvalidPositionsAreRefused) {
  EXPECT_THROW(UtmZoneOf({91.0, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(UtmZoneOf({0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace skyquilt::geo
