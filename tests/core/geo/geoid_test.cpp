#include "core/geo/geoid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/geo/crs.h"

namespace skyquilt::geo {
namespace {

TEST(Egm96, HasThePublishedHeights) {
  // 100 m above the ellipsoid is 51.589 m above the geoid there, by GDAL's transformation from EPSG:4979 to EPSG:4326+5773.
  EXPECT_NEAR(100.0 - Egm96Undulation(52.0, -1.5), 51.589, 1e-3);
  // Test values of NGA's F477, to the grid's interpolation.
  EXPECT_NEAR(Egm96Undulation(38.6281550, 269.7791550), -31.628, 0.1);
  EXPECT_NEAR(Egm96Undulation(-14.6212170, 305.0211140), -2.969, 0.1);
  EXPECT_NEAR(Egm96Undulation(46.8743190, 102.4487290), -43.575, 0.1);
}

TEST(Egm96, HoldsAtPolesAndAcrossTheDateLine) {
  EXPECT_NEAR(Egm96Undulation(90.0, 0.0), 13.606, 0.01);
  EXPECT_NEAR(Egm96Undulation(-90.0, 0.0), -29.535, 0.01);
  EXPECT_NEAR(Egm96Undulation(10.0, 179.9999999), Egm96Undulation(10.0, -179.9999999), 1e-4);
  EXPECT_THROW(Egm96Undulation(91.0, 0.0), std::invalid_argument);
  EXPECT_THROW(Egm96Undulation(0.0, std::nan("")), std::invalid_argument);
}

TEST(Egm96, AgreesWithItsSystem) {
  EXPECT_NEAR(Crs("EPSG:4326+5773").ToGeodetic({-1.5, 52.0, 51.589}).height_m, 51.589 + Egm96Undulation(52.0, -1.5), 1e-6);
}

}  // namespace
}  // namespace skyquilt::geo
