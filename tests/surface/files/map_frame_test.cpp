#include "surface/map_frame.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geo/geoid.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

std::vector<Eigen::Vector3d> Places() {
  return {{0.0, 0.0, 0.0}, {120.0, -70.0, 15.0}, {-4000.0, 2500.0, 100.0}, {900.0, 9000.0, -30.0}};
}

TEST(MapFrame, AgreesWithTheProjection) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const MapFrame frame(SampleInfo(origin));
    const geo::EnuFrame enu(origin);
    for (const Eigen::Vector3d& x : Places()) {
      const geo::Geodetic position = enu.GeodeticFromEnu(x);
      const Eigen::Vector2d plane = geo::UtmFromGeodetic(position, geo::UtmZoneOf(origin));
      const Eigen::Vector3d in_map = frame.MapFromEnu(x);
      EXPECT_LT((in_map - Eigen::Vector3d(plane.x(), plane.y(), position.height_m)).norm(), 1e-6) << origin.latitude_deg;
    }
  }
}

TEST(MapFrame, PlacesComeBack) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const MapFrame frame(SampleInfo(origin));
    for (const Eigen::Vector3d& x : Places()) EXPECT_LT((frame.EnuFromMap(frame.MapFromEnu(x)) - x).norm(), 1e-3) << origin.latitude_deg;
  }
}

TEST(MapFrame, OffsetIsAMultipleOf100MetresJustBelowTheMiddle) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const scene::SceneInfo info = SampleInfo(origin);
    const MapFrame frame(info);
    const Eigen::Vector3d rest = frame.MapFromEnu(0.5 * (info.min_enu + info.max_enu)) - frame.offset();
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_EQ(std::remainder(frame.offset()[axis], 100.0), 0.0);
      EXPECT_GE(rest[axis], 0.0);
      EXPECT_LT(rest[axis], 100.0);
    }
  }
  EXPECT_EQ(MapFrame(SampleInfo({31.5, 35.5, -425.0})).offset().z(), 0.0);
}

TEST(MapFrame, DirectionsTurnAsPlacesDo) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const scene::SceneInfo info = SampleInfo(origin);
    const MapFrame frame(info);
    const Eigen::Vector3d middle = 0.5 * (info.min_enu + info.max_enu);
    for (const Eigen::Vector3d& direction : {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.48, -0.6, 0.64)}) {
      const Eigen::Vector3d moved = (frame.MapFromEnu(middle + direction) - frame.MapFromEnu(middle)).normalized();
      const Eigen::Vector3f turned = frame.MapDirection(direction.cast<float>());
      EXPECT_NEAR(turned.norm(), 1.0F, 1e-6F);
      // The map is up to 0.6 % smaller than the ground (UPS), but not its heights.
      EXPECT_LT((turned.cast<double>() - moved).norm(), 5e-3) << origin.latitude_deg;
    }
    const Eigen::Vector3f east = frame.MapDirection(Eigen::Vector3f::UnitX());
    const Eigen::Vector3f north = frame.MapDirection(Eigen::Vector3f::UnitY());
    const Eigen::Vector3f up = frame.MapDirection(Eigen::Vector3f::UnitZ());
    EXPECT_LT((east.cross(north) - up).norm(), 1e-6F) << "not a rotation";
    EXPECT_GT(up.z(), 0.9999F);
  }
}

TEST(MapFrame, DirectionsTurnByTheConvergenceOfTheMeridians) {
  // At 60 N, 2.1 degrees east of the central meridian: atan(tan(2.1 deg) sin(60 deg)) (sphere; ellipsoidal terms are below 0.01 degrees).
  scene::SceneInfo info = SampleInfo({60.0, 29.1, 0.0});
  info.min_enu = -Eigen::Vector3d::Ones();
  info.max_enu = Eigen::Vector3d::Ones();
  const Eigen::Vector3f north = MapFrame(info).MapDirection(Eigen::Vector3f::UnitY());
  constexpr double kRadian = std::numbers::pi / 180.0;
  const double expected = std::atan(std::tan(2.1 * kRadian) * std::sin(60.0 * kRadian));
  EXPECT_NEAR(std::atan2(-static_cast<double>(north.x()), static_cast<double>(north.y())), expected, 0.01 * kRadian);
}

TEST(MapFrame, DateLineHasNoJump) {
  const MapFrame frame(SampleInfo({-16.5, 180.0, 7.0}));
  const double step_m = (frame.MapFromEnu({50.0, 0.0, 0.0}) - frame.MapFromEnu({-50.0, 0.0, 0.0})).norm();
  EXPECT_NEAR(step_m, 100.0, 0.1);
}

TEST(MapFrame, NamesItsSystems) {
  scene::SceneInfo info = SampleInfo({43.64, -79.39, 100.0});
  EXPECT_EQ(MapFrame(info).CrsName(), "EPSG:32617");
  EXPECT_EQ(MapFrame(info).VerticalName(), "WGS84 ellipsoid (EPSG:4979)");
  info.height_reference = geo::HeightReference::kUnknown;
  EXPECT_EQ(MapFrame(info).VerticalName(), "as tagged (unknown)");
  info.accuracy.horizontal_m = 1.0;
  EXPECT_EQ(MapFrame(info).VerticalName(), "unknown: the GPS tags have no usable heights");
  info.accuracy.vertical_m = 3.0;
  EXPECT_EQ(MapFrame(info).VerticalName(), "as tagged (unknown)");
  EXPECT_EQ(MapFrame(SampleInfo({-90.0, 0.0, 0.0})).CrsName(), "EPSG:32761");
}

TEST(MapFrame, ConvertsHeightsAndBack) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const scene::SceneInfo info = SampleInfo(origin);
    const MapFrame given(info), egm96(info, geo::Vertical::kEgm96);
    const geo::EnuFrame enu(origin);
    for (const Eigen::Vector3d& x : Places()) {
      const geo::Geodetic place = enu.GeodeticFromEnu(x);
      const Eigen::Vector3d moved = egm96.MapFromEnu(x) - given.MapFromEnu(x);
      EXPECT_LT((moved - Eigen::Vector3d(0.0, 0.0, -geo::Egm96Undulation(place.latitude_deg, place.longitude_deg))).norm(), 1e-5);
      EXPECT_LT((egm96.EnuFromMap(egm96.MapFromEnu(x)) - x).norm(), 1e-3) << origin.latitude_deg;
    }
  }
  EXPECT_EQ(MapFrame(SampleInfo({43.64, -79.39, 100.0}), geo::Vertical::kEgm96).VerticalName(), "EGM96 geoid (EPSG:5773)");
}

TEST(MapFrame, LocalCoordinatesStayAsTheyAre) {
  const MapFrame frame(SampleInfo({0.0, 0.0, 0.0}, false));
  EXPECT_FALSE(frame.georeferenced());
  EXPECT_EQ(frame.offset(), Eigen::Vector3d::Zero());
  EXPECT_EQ(frame.MapFromEnu({1.0, 2.0, 3.0}), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(frame.EnuFromMap({1.0, 2.0, 3.0}), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(frame.MapDirection({0.0F, 0.0F, 2.0F}), Eigen::Vector3f(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(frame.CrsName(), "local frame, metres");
  EXPECT_EQ(frame.VerticalName(), "local frame");
}

TEST(MapFrame, ASceneWithoutBoundsHasAnOffset) {
  scene::SceneInfo info = SampleInfo({43.64, -79.39, 100.0});
  info.min_enu.setConstant(std::numeric_limits<double>::infinity());
  info.max_enu.setConstant(-std::numeric_limits<double>::infinity());
  EXPECT_TRUE(MapFrame(info).offset().allFinite());
}

}  // namespace
}  // namespace skyquilt::surface
