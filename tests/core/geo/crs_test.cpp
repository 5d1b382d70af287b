#include "core/geo/crs.h"

#include <cmath>
#include <stdexcept>

#include "core/geo/ecef.h"
#include "core/geo/utm.h"
#include "tests/core/geo/generators.h"

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

TEST(Crs, RefusesWhatIsNotASystemOrNotInIt) {
  EXPECT_THROW(Crs("EPSG:1"), std::invalid_argument);
  EXPECT_THROW(Crs("DJI_0001.JPG 8.4 47.1 420"), std::invalid_argument);
  EXPECT_THROW(Crs("WGS84 UTM 61N"), std::invalid_argument);
  EXPECT_THROW(Crs("EPSG:4326").ToGeodetic({8.4, 147.1, 0.0}), std::invalid_argument);
  EXPECT_THROW(Crs("EPSG:32632").ToGeodetic({std::nan(""), 0.0, 0.0}), std::invalid_argument);
}

RC_GTEST_PROP(Ecef, GeodeticComesBackFromEarthCentredCoordinates, ()) {
  const Geodetic position = *AnyPosition();
  const Eigen::Vector3d x = EcefFromGeodetic(position);
  RC_ASSERT((EcefFromGeodetic(GeodeticFromEcef(x)) - x).norm() < 1e-6);
}

}  // namespace
}  // namespace skyquilt::geo
