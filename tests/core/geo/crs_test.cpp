#include "core/geo/crs.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "core/geo/ecef.h"
#include "core/geo/utm.h"
#include "tests/core/geo/generators.h"
#include "tests/support/error_of.h"

namespace skyquilt::geo {
namespace {

double Distance_m(const Geodetic& a, const Geodetic& b) {
  return (EcefFromGeodetic(a) - EcefFromGeodetic(b)).norm();
}

TEST(Crs, UtmAgreesWithOurOwn) {
  const UtmZone zone{32, true};
  const Geodetic position{47.1, 8.4, 420.0};
  const Eigen::Vector2d utm = UtmFromGeodetic(position, zone);
  for (const char* definition : {"EPSG:32632", "WGS84 UTM 32N", "wgs84 utm 32n", "+proj=utm +zone=32 +ellps=WGS84 +datum=WGS84 +units=m +no_defs"}) {
    EXPECT_LT(Distance_m(Crs(definition).ToGeodetic({utm.x(), utm.y(), 420.0}), position), 1e-4) << definition;
  }
}

TEST(Crs, LongitudeComesFirstUnlessTheDefinitionIsFollowed) {
  const Geodetic position{47.1, 8.4, 420.0};
  EXPECT_LT(Distance_m(Crs("EPSG:4326").ToGeodetic({8.4, 47.1, 420.0}), position), 1e-6);
  EXPECT_LT(Distance_m(Crs("EPSG:4326", AxisOrder::kAsDefined).ToGeodetic({47.1, 8.4, 420.0}), position), 1e-6);
}

// Switzerland's own datum; figures of swisstopo's approximate formulas, good to a metre.
TEST(Crs, OtherDatumsAreTransformed) {
  EXPECT_LT(Distance_m(Crs("EPSG:2056").ToGeodetic({2600000.0, 1200000.0, 0.0}), {46.951083, 7.438632, 0.0}), 5.0);
}

TEST(Crs, ThereAndBack) {
  const Geodetic position{47.1, 8.4, 420.0};
  for (const char* definition : {"EPSG:32632", "EPSG:4326", "EPSG:2056", "EPSG:4979"}) {
    for (const AxisOrder order : {AxisOrder::kEastNorth, AxisOrder::kAsDefined}) {
      const Crs crs(definition, order);
      EXPECT_LT(Distance_m(crs.ToGeodetic(crs.FromGeodetic(position)), position), 1e-4) << definition;
    }
  }
  EXPECT_THROW(Crs("EPSG:4326").FromGeodetic({91.0, 0.0, 0.0}), std::invalid_argument);
}

TEST(Crs, RefusesWhatIsNotASystemOrNotInIt) {
  EXPECT_THROW(Crs("EPSG:1"), std::invalid_argument);
  EXPECT_THROW(Crs("DJI_0001.JPG 8.4 47.1 420"), std::invalid_argument);
  EXPECT_THROW(Crs("WGS84 UTM 61N"), std::invalid_argument);
  EXPECT_THROW(Crs("EPSG:4326").ToGeodetic({8.4, 147.1, 0.0}), std::invalid_argument);
  EXPECT_THROW(Crs("EPSG:32632").ToGeodetic({std::nan(""), 0.0, 0.0}), std::invalid_argument);
}

TEST(Crs, TellsItsPartsApart) {
  const Crs plane("EPSG:2263");
  EXPECT_EQ(plane.heights(), CrsHeights::kNone);
  EXPECT_EQ(plane.horizontal().unit, "US survey foot");
  EXPECT_NEAR(plane.horizontal().unit_m, 1200.0 / 3937.0, 1e-12);
  EXPECT_TRUE(plane.vertical().name.empty());
  EXPECT_FALSE(plane.IsGeographic());
  const Crs compound("EPSG:32630+6360");
  EXPECT_EQ(compound.heights(), CrsHeights::kGravity);
  EXPECT_EQ(compound.name(), "WGS 84 / UTM zone 30N + NAVD88 height (ftUS)");
  EXPECT_EQ(compound.horizontal().unit_m, 1.0);
  EXPECT_EQ(compound.vertical().name, "NAVD88 height (ftUS)");
  EXPECT_NEAR(compound.vertical().unit_m, 1200.0 / 3937.0, 1e-12);
  const Crs solid("EPSG:4979");
  EXPECT_EQ(solid.heights(), CrsHeights::kEllipsoidal);
  EXPECT_EQ(solid.vertical().name, "ellipsoid");
  EXPECT_EQ(solid.horizontal().unit_m, 0.0);
  EXPECT_TRUE(solid.IsGeographic());
  const Crs grid("+proj=utm +zone=30 +datum=WGS84 +units=m +geoidgrids=egm96_15.gtx");
  EXPECT_EQ(grid.heights(), CrsHeights::kGravity);
  const Crs feet("+proj=utm +zone=30 +datum=WGS84 +vunits=us-ft");
  EXPECT_EQ(feet.heights(), CrsHeights::kEllipsoidal);
  EXPECT_NEAR(feet.ToGeodetic({500000.0, 5760000.0, 3937.0}).height_m, 1200.0, 1e-6);
}

TEST(Crs, HeightsCanBeLeftOut) {
  for (const char* definition : {"EPSG:32630+3855", "EPSG:32630", "+proj=utm +zone=30 +datum=WGS84 +vunits=us-ft", "EPSG:4979"}) {
    const Crs plane = Crs(definition).WithoutHeights();
    EXPECT_EQ(plane.heights(), CrsHeights::kNone) << definition;
    const Eigen::Vector3d x = plane.IsGeographic() ? Eigen::Vector3d(-3.0, 52.0, 7.0) : Eigen::Vector3d(500000.0, 5761038.21, 7.0);
    EXPECT_LT(Distance_m(plane.ToGeodetic(x), {52.0, -3.0, 7.0}), 0.01) << definition;
  }
  EXPECT_THROW(Crs("EPSG:4978").WithoutHeights(), std::invalid_argument);
}

// Without a grid PROJ returns the heights that it was given, and no error.
TEST(Crs, HeightsThatCannotBeMadeEllipsoidalAreRefused) {
  for (const char* definition : {"EPSG:9518", "EPSG:4326+5701", "EPSG:4326+5703"}) {
    EXPECT_THROW(Crs(definition).ToGeodetic({-1.5, 52.0, 100.0}), std::invalid_argument) << definition;
    EXPECT_THROW(Crs(definition).FromGeodetic({52.0, -1.5, 100.0}), std::invalid_argument) << definition;
  }
  const std::string error = ErrorOf<std::invalid_argument>([&] {
    Crs("+proj=utm +zone=30 +datum=WGS84 +geoidgrids=not_there.gtx").ToGeodetic({500000.0, 5760000.0, 100.0});
  });
  EXPECT_NE(error.find("no grid"), std::string::npos) << error;
  EXPECT_NEAR(Crs("EPSG:4326+5773").ToGeodetic({-1.5, 52.0, 51.589}).height_m, 100.0, 1e-3);
}

TEST(Crs, GuessedDatumsAreNoticed) {
  EXPECT_TRUE(Crs("+proj=utm +zone=30 +ellps=GRS80 +units=m").IsDatumGuessed({500000.0, 5760000.0, 0.0}));
  EXPECT_FALSE(Crs("EPSG:32630").IsDatumGuessed({500000.0, 5760000.0, 0.0}));
  EXPECT_FALSE(Crs("EPSG:27700").IsDatumGuessed({400000.0, 300000.0, 0.0}));
}

TEST(Crs, FromGeodeticIsTheInverse) {
  const Geodetic position{40.7, -73.97, 30.0};
  for (const char* definition : {"EPSG:2263", "EPSG:32618", "EPSG:4326", "EPSG:32618+5773", "EPSG:4978"}) {
    for (const AxisOrder order : {AxisOrder::kEastNorth, AxisOrder::kAsDefined}) {
      const Crs crs(definition, order);
      EXPECT_LT(Distance_m(crs.ToGeodetic(crs.FromGeodetic(position)), position), 1e-4) << definition;
    }
  }
}

RC_GTEST_PROP(Ecef, GeodeticComesBackFromEarthCentredCoordinates, ()) {
  const Geodetic position = *AnyPosition();
  const Eigen::Vector3d x = EcefFromGeodetic(position);
  RC_ASSERT((EcefFromGeodetic(GeodeticFromEcef(x)) - x).norm() < 1e-6);
}

}  // namespace
}  // namespace skyquilt::geo
