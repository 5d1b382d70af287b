#include "prepare/georeference/camera_up.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/random.h"
#include "prepare/georeference/gravity.h"
#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::test {
namespace {

using namespace prepare::georeference;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;

// Photos and points of a place in a model's frame, without gimbal angles.
struct Place {
  geo::Similarity3d model_from_enu;
  std::vector<prepare::input::PreparedPhoto> photos = {};
  std::vector<Vector3d> points = {};

  void Add(const Vector3d& centre, const Attitude& attitude) { photos.push_back(PreparedAt(centre, attitude, model_from_enu)); }
  void AddPoint(const Vector3d& x_in_enu) { points.push_back(model_from_enu * x_in_enu); }
  Vector3d Up() const { return model_from_enu.rotation * Vector3d::UnitZ(); }
  double ErrorDeg(const GravityHints& hints = {}) const { return AngleDeg(FindGravity(photos, points, hints).up, Up()); }
};

Place In(base::Random& random) {
  return {.model_from_enu = RandomFrame(random)};
}

void AddGround(Place& place, base::Random& random) {
  for (int i = 0; i < 300; ++i) place.AddPoint({random.Uniform(-80.0, 80.0), random.Uniform(-80.0, 80.0), 0.5 * random.Normal()});
}

// A wall 10 m to the north, seen by `n` cameras 2 m apart.
Place Facade(base::Random& random, int n, double pitch_deg, double turn_deg) {
  Place place = In(random);
  for (int i = 0; i < n; ++i) place.Add({2.0 * i, 0.0, 1.6}, {.yaw_deg = turn_deg * std::sin(2.1 * i), .pitch_deg = pitch_deg});
  for (int i = 0; i < 400; ++i) place.AddPoint({random.Uniform(-5.0, 2.0 * n + 5.0), 10.0 + 0.15 * random.Normal(), random.Uniform(0.0, 12.0)});
  return place;
}

// Cameras all around a thing, which look `pitch_deg` above the horizon.
Place Orbit(base::Random& random, int n, double pitch_deg) {
  Place place = In(random);
  for (int i = 0; i < n; ++i) {
    const double angle = kTurn * i / n;
    place.Add({10.0 * std::sin(angle), 10.0 * std::cos(angle), 1.6},
              {.yaw_deg = 180.0 + 360.0 * i / n, .pitch_deg = pitch_deg, .roll_deg = random.Uniform(-1.0, 1.0)});
  }
  for (int i = 0; i < 300; ++i) place.AddPoint({random.Normal(), random.Normal(), 1.6 + random.Normal()});
  return place;
}

Place Room(base::Random& random, int n) {
  Place place = In(random);
  for (int i = 0; i < n; ++i) {
    place.Add({random.Uniform(-2.0, 2.0), random.Uniform(-1.5, 1.5), random.Uniform(1.2, 1.8)},
              {.yaw_deg = random.Uniform(0.0, 360.0), .pitch_deg = random.Uniform(-20.0, 30.0), .roll_deg = random.Normal()});
  }
  for (int i = 0; i < 600; ++i) {
    Vector3d x(random.Uniform(-3.0, 3.0), random.Uniform(-2.0, 2.0), random.Uniform(0.0, 2.5));
    const auto axis = static_cast<Eigen::Index>(random.Below(3));
    const Vector3d low(-3.0, -2.0, 0.0), high(3.0, 2.0, 2.5);
    x[axis] = random.Below(2) == 0 ? low[axis] : high[axis];
    place.AddPoint(x);
  }
  return place;
}

// The stored photo of a camera that was turned about its view. -90: as phones store portraits, orientation 6.
void TurnCamera(prepare::input::PreparedPhoto& photo, double angle_deg) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_deg * kTurn / 360.0, Vector3d::UnitZ()));
  photo.cam_from_model.rotation = turn * photo.cam_from_model.rotation;
  photo.cam_from_model.translation = turn * photo.cam_from_model.translation;
}

// Of EXIF.
int OrientationOf(int angle_deg) {
  return angle_deg == -90 ? 6 : angle_deg == 90 ? 8 : angle_deg == 180 ? 3 : 1;
}

RC_GTEST_PROP(CameraUp, NadirFlightsLookDown, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  Place place = In(random);
  const double heading_deg = random.Uniform(0.0, 360.0);
  const bool back_and_forth = *rc::gen::arbitrary<bool>();
  for (int i = 0; i < 40; ++i) {
    const double yaw_deg = heading_deg + (back_and_forth && (i / kLine) % 2 == 1 ? 180.0 : 0.0);
    place.Add(OnLawnmower(i, 40), {yaw_deg, -90.0 + random.Normal(), random.Normal()});
  }
  AddGround(place, random);
  // With one heading the mounting cannot be told.
  RC_ASSERT(place.ErrorDeg() < 1.0);
  const HeldCameras held = FindHeldCameras(place.photos, {});
  for (size_t i = 0; i < place.photos.size(); ++i) RC_ASSERT(held.cam_from_model[i].coeffs() == place.photos[i].cam_from_model.rotation.coeffs());
}

RC_GTEST_PROP(CameraUp, ObliqueFlightsLookDown, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  Place place = In(random);
  const double pitch_deg = random.Uniform(-75.0, -25.0);
  for (int i = 0; i < 40; ++i) place.Add(OnLawnmower(i, 40), {27.0 * i, pitch_deg, random.Normal()});
  AddGround(place, random);
  RC_ASSERT(place.ErrorDeg() < 1.5);
}

// Photos that look up at a facade turned the world over: the sign of up came from the views as soon as these were not level.
RC_GTEST_PROP(CameraUp, AFacadeFromBelowStaysUpright, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  const double pitch_deg = random.Uniform(-10.0, 28.0), turn_deg = random.Uniform(0.0, 45.0);
  const Place place = Facade(random, 12, pitch_deg, turn_deg);
  RC_ASSERT(place.ErrorDeg() < 2.0);
}

TEST(CameraUp, AFacadeFromBelowIsNotTurnedOverWithoutPoints) {
  base::Random random(3);
  Place place = Facade(random, 12, 20.0, 30.0);
  place.points.clear();
  EXPECT_LT(place.ErrorDeg(), 0.1);
  // Cameras that do not turn leave their pitch open, and up is that of the photos.
  Place one_way = Facade(random, 12, 20.0, 0.0);
  one_way.points.clear();
  EXPECT_NEAR(one_way.ErrorDeg(), 20.0, 0.1);
  EXPECT_GT(FindGravity(one_way.photos, {}).Sigma(), 1.0);
}

// The plane of a wall had nine tenths of the weight, at a right angle to what the cameras say.
TEST(CameraUp, AWallIsNotTheGround) {
  base::Random random(4);
  const Place place = Facade(random, 12, 0.0, 8.0);
  const Gravity gravity = FindGravity(place.photos, place.points);
  EXPECT_LT(AngleDeg(gravity.up, place.Up()), 1.0);
  ASSERT_EQ(gravity.evidence.size(), 2U);
  EXPECT_EQ(gravity.evidence[1].kind, "wall");
  EXPECT_TRUE(std::isinf(gravity.evidence[1].Sigma()));
}

TEST(CameraUp, ALeaningWallDoesNotTilt) {
  base::Random random(4);
  Place place = Facade(random, 12, 20.0, 20.0);
  place.points.clear();
  for (int i = 0; i < 400; ++i) {
    const double up_m = random.Uniform(0.0, 12.0);
    place.AddPoint({random.Uniform(-5.0, 29.0), 10.0 + 0.5 * up_m + 0.15 * random.Normal(), up_m});
  }
  EXPECT_LT(place.ErrorDeg(), 0.1);
}

TEST(CameraUp, APlaneThatContradictsTheCamerasDoesNotCount) {
  base::Random random(5);
  Place place = Orbit(random, 24, -15.0);
  const double without = [&] {
    const Place bare{.model_from_enu = place.model_from_enu, .photos = place.photos};
    return bare.ErrorDeg();
  }();
  place.points.clear();
  for (int i = 0; i < 300; ++i) {
    const double east_m = random.Uniform(-5.0, 5.0);
    place.AddPoint({east_m, random.Uniform(-5.0, 5.0), east_m + 0.05 * random.Normal()});  // 45 degrees
  }
  EXPECT_EQ(FindGravity(place.photos, place.points).evidence.size(), 1U);
  EXPECT_EQ(place.ErrorDeg(), without);
}

// Also around a thing that is above the cameras.
RC_GTEST_PROP(CameraUp, OrbitsAreUpright, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  RC_ASSERT(Orbit(random, 24, random.Uniform(-40.0, 40.0)).ErrorDeg() < 2.0);
}

RC_GTEST_PROP(CameraUp, RoomsAreUpright, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  RC_ASSERT(Room(random, 30).ErrorDeg() < 3.0);
}

RC_GTEST_PROP(CameraUp, TaggedTurnsDoNotMatter, ()) {
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  std::vector<Place> places;
  places.push_back(Orbit(random, 24, 10.0));
  places.push_back(Room(random, 30));
  places.push_back(Facade(random, 12, 20.0, 30.0));
  places.push_back(Facade(random, 12, 10.0, 0.0));
  for (Place& place : places) {
    const bool all = *rc::gen::arbitrary<bool>();
    const int all_deg = *rc::gen::element(-90, 90, 180);
    for (prepare::input::PreparedPhoto& photo : place.photos) {
      const int angle_deg = all ? all_deg : *rc::gen::element(0, -90, 90, 180);
      TurnCamera(photo, angle_deg);
      photo.file.tags.orientation = OrientationOf(angle_deg);
    }
    RC_ASSERT(place.ErrorDeg() < 3.0);
  }
}

TEST(CameraUp, UntaggedTurnsAreFoundByTheAxes) {
  base::Random random(6);
  for (const int every : {2, 3, 5}) {
    std::vector<Place> places;
    places.push_back(Orbit(random, 24, 10.0));
    places.push_back(Room(random, 40));
    places.push_back(Facade(random, 16, 10.0, 30.0));
    for (Place& place : places) {
      for (size_t i = 0; i < place.photos.size(); i += static_cast<size_t>(every)) TurnCamera(place.photos[i], i % 4 == 0 ? -90.0 : 90.0);
      EXPECT_LT(place.ErrorDeg(), 3.0) << every;
    }
  }
  // All of them, as phones store portraits.
  Place orbit = Orbit(random, 24, 5.0);
  for (prepare::input::PreparedPhoto& photo : orbit.photos) TurnCamera(photo, -90.0);
  EXPECT_LT(orbit.ErrorDeg(), 2.0);
  // Few portraits among photos that all look at one wall.
  Place facade = Facade(random, 12, 10.0, 0.0);
  for (size_t i = 0; i < facade.photos.size(); i += 4) TurnCamera(facade.photos[i], -90.0);
  EXPECT_LT(facade.ErrorDeg(), 2.0);
}

TEST(CameraUp, AWrongTagOfATurnIsSeenByTheAxes) {
  base::Random random(7);
  Place place = Orbit(random, 24, 10.0);
  for (size_t i = 0; i < place.photos.size(); i += 2) place.photos[i].file.tags.orientation = 6;
  EXPECT_LT(place.ErrorDeg(), 2.0);
}

// A grid of photos straight at a wall has the poses of a flight straight down.
TEST(CameraUp, TaggedPositionsTellAWallFromTheGround) {
  base::Random random(8);
  Place place = In(random);
  for (int i = 0; i < 40; ++i) {
    const Vector3d x = OnLawnmower(i, 40);
    place.Add({x.x(), -60.0, 60.0 + x.y()}, {.yaw_deg = 0.0, .pitch_deg = 0.0});
  }
  EXPECT_GT(place.ErrorDeg(), 80.0);
  const Vector3d up = place.Up();
  EXPECT_LT(place.ErrorDeg({.tags_up = [&] { return std::optional(up); }}), 0.1);
}

TEST(CameraUp, AStatedUpCountsAlone) {
  base::Random random(9);
  Place place = Orbit(random, 24, 0.0);
  const Vector3d stated = place.model_from_enu.rotation * Vector3d(0.3, 0.0, 0.7);
  const Gravity gravity = FindGravity(place.photos, place.points, {.stated_up = stated});
  EXPECT_LT(AngleDeg(gravity.up, stated), 1e-6);
  EXPECT_NEAR(gravity.Sigma() * 360.0 / kTurn, kStatedUp_deg, 1e-6);
  for (const UpEvidence& evidence : gravity.evidence) EXPECT_EQ(evidence.used, evidence.kind == "stated") << evidence.kind;
}

TEST(MeanCameraUp, IsThatOfUprightPhotos) {
  base::Random random(10);
  Place place = Orbit(random, 24, 0.0);
  EXPECT_LT(AngleDeg(MeanCameraUp(place.photos), place.Up()), 1.0);
  for (prepare::input::PreparedPhoto& photo : place.photos) {
    TurnCamera(photo, 90.0);
    photo.file.tags.orientation = 8;
  }
  EXPECT_LT(AngleDeg(MeanCameraUp(place.photos), place.Up()), 1.0);
  EXPECT_EQ(MeanCameraUp({}), Vector3d::Zero());
}

}  // namespace
}  // namespace skyquilt::test
