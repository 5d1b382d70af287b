#include <stdexcept>

#include "core/geo/geoid.h"
#include "core/geo/height_reference.h"
#include "tests/core/geo/generators.h"

namespace skyquilt::geo {
namespace {

TEST(GeoidPatch, RefusesANegativeSize) {
  EXPECT_THROW(GeoidPatch({0.0, 0.0, 0.0}, -1.0), std::invalid_argument);
}

RC_GTEST_PROP(GeoidPatch, IsTheGeoidItself, ()) {
  const Geodetic centre = *AnyPosition();
  const GeoidPatch patch(centre, *Between(0.0, 30e3));
  for (int i = 0; i < 20; ++i) {
    // Some of these places are beyond the nodes.
    const double latitude_deg = std::clamp(centre.latitude_deg + *Between(-0.6, 0.6), -90.0, 90.0);
    const double longitude_deg = WrapLongitudeDeg(centre.longitude_deg + *Between(-1.0, 1.0));
    RC_ASSERT(std::abs(patch.At(latitude_deg, longitude_deg) - Egm96Undulation(latitude_deg, longitude_deg)) < 1e-6);
  }
}

TEST(HeightReference, NamesComeBack) {
  for (const HeightReference reference : {HeightReference::kEllipsoid, HeightReference::kEgm96, HeightReference::kUnknown}) {
    EXPECT_EQ(HeightReferenceNamed(NameOf(reference)), reference);
  }
  EXPECT_FALSE(HeightReferenceNamed("sea level"));
  EXPECT_EQ(VerticalNamed("as-tagged"), Vertical::kAsTagged);
  EXPECT_EQ(VerticalNamed("ellipsoid"), Vertical::kEllipsoid);
  EXPECT_EQ(VerticalNamed("egm96"), Vertical::kEgm96);
  EXPECT_THROW(VerticalNamed("EGM96"), std::invalid_argument);
}

}  // namespace
}  // namespace skyquilt::geo
