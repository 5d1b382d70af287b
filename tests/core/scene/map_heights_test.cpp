#include "core/scene/map_heights.h"

#include <gtest/gtest.h>

#include "core/geo/geoid.h"

namespace skyquilt::scene {
namespace {

using geo::HeightReference;
using geo::Vertical;

SceneInfo Info(HeightReference reference, bool georeferenced = true) {
  SceneInfo info;
  info.origin = {52.0, -1.5, 100.0};
  info.georeferenced = georeferenced;
  info.height_reference = reference;
  info.min_enu = Eigen::Vector3d(-200.0, -200.0, 0.0);
  info.max_enu = Eigen::Vector3d(200.0, 200.0, 50.0);
  return info;
}

TEST(MapHeights, AreConvertedBetweenKnownSystems) {
  const geo::Geodetic place{52.0, -1.5, 100.0};
  const double up = geo::Egm96Undulation(52.0, -1.5);
  const struct {
    HeightReference given;
    Vertical wanted;
    double height_m;
    HeightReference written;
  } cases[] = {{HeightReference::kEllipsoid, Vertical::kAsTagged, 100.0, HeightReference::kEllipsoid},
               {HeightReference::kEllipsoid, Vertical::kEllipsoid, 100.0, HeightReference::kEllipsoid},
               {HeightReference::kEllipsoid, Vertical::kEgm96, 51.589, HeightReference::kEgm96},
               {HeightReference::kEgm96, Vertical::kAsTagged, 100.0, HeightReference::kEgm96},
               {HeightReference::kEgm96, Vertical::kEgm96, 100.0, HeightReference::kEgm96},
               {HeightReference::kEgm96, Vertical::kEllipsoid, 100.0 + up, HeightReference::kEllipsoid},
               {HeightReference::kUnknown, Vertical::kAsTagged, 100.0, HeightReference::kUnknown}};
  for (const auto& one : cases) {
    const MapHeights heights(Info(one.given), one.wanted);
    EXPECT_NEAR(heights.FromSurvey(place), one.height_m, 1e-3) << heights.Name();
    EXPECT_NEAR(heights.ToSurvey({52.0, -1.5, heights.FromSurvey(place)}), 100.0, 1e-9);
    EXPECT_EQ(heights.reference(), one.written);
    EXPECT_EQ(heights.Caution(), "");
    EXPECT_EQ(heights.Metadata().contains("VERTICAL"), one.written == HeightReference::kUnknown);
    EXPECT_EQ(heights.Metadata().contains(geo::kUndulationsItem), one.height_m != 100.0);
  }
}

TEST(MapHeights, OfUnknownReferenceAreTakenForEllipsoidalAndSaySo) {
  const geo::Geodetic place{52.0, -1.5, 100.0};
  const MapHeights egm96(Info(HeightReference::kUnknown), Vertical::kEgm96), ellipsoid = egm96.In(Vertical::kEllipsoid);
  EXPECT_NEAR(egm96.FromSurvey(place), 51.589, 1e-3);
  EXPECT_EQ(ellipsoid.FromSurvey(place), 100.0);
  for (const MapHeights* heights : {&egm96, &ellipsoid}) {
    EXPECT_NE(heights->Caution().find("taken for heights above the WGS84 ellipsoid"), std::string::npos) << heights->Caution();
    EXPECT_NE(heights->Name().find("if tagged heights are above the ellipsoid"), std::string::npos) << heights->Name();
  }
}

TEST(MapHeights, OfALocalFrameStay) {
  for (const Vertical wanted : {Vertical::kAsTagged, Vertical::kEllipsoid, Vertical::kEgm96}) {
    const MapHeights heights(Info(HeightReference::kUnknown, false), wanted);
    EXPECT_EQ(heights.FromSurvey({52.0, -1.5, 7.0}), 7.0);
    EXPECT_EQ(heights.reference(), HeightReference::kUnknown);
    EXPECT_EQ(heights.Name(), "local frame");
    EXPECT_EQ(heights.Caution().empty(), wanted == Vertical::kAsTagged);
  }
}

TEST(MapHeights, NameWhatIsKnown) {
  SceneInfo info = Info(HeightReference::kUnknown);
  EXPECT_EQ(MapHeights(info, Vertical::kAsTagged).Name(), "as tagged (unknown)");
  EXPECT_EQ(MapHeights(info, Vertical::kAsTagged).Metadata().at("VERTICAL"), "as tagged (unknown)");
  info.accuracy.horizontal_m = 1.0;
  EXPECT_EQ(MapHeights(info, Vertical::kAsTagged).Name(), "unknown: the GPS tags have no usable heights");
  EXPECT_EQ(MapHeights(Info(HeightReference::kEgm96), Vertical::kAsTagged).Name(), "EGM96 geoid (EPSG:5773)");
}

}  // namespace
}  // namespace skyquilt::scene
