#include "prepare/georeference/georeference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "core/linear/linear.h"
#include "tests/prepare/synthetic_flight.h"

namespace skyquilt::prepare::georeference {
namespace {

std::vector<input::PreparedPhoto> Photos(const test::Flight& flight) {
  std::vector<input::PreparedPhoto> photos;
  for (size_t i = 0; i < flight.photos.size(); ++i) {
    photos.push_back(input::PreparePhoto({.name = flight.photos[i].name, .tags = flight.photos[i].tags}, i, flight.model.images[i].cam_from_world));
  }
  return photos;
}

std::vector<Eigen::Vector3d> Points(const test::Flight& flight) {
  std::vector<Eigen::Vector3d> points;
  for (const survey::ColmapPoint& point : flight.model.points) points.push_back(point.x_in_world);
  return points;
}

Georeference Place(const test::Flight& flight, const PlaceOptions& options = {}) {
  return PlaceOnEarth(Photos(flight), Points(flight), options);
}

TEST(Georeference, ExactTagsAreRecoveredEverywhereOnEarth) {
  const geo::Geodetic places[] = {{46.8, -92.0, 150.0}, {-33.9, 151.2, 20.0}, {31.5, 35.5, -430.0}, {10.0, 180.0, 0.0},  {-16.8, -179.9999, 5.0},
                                  {90.0, 0.0, 10.0},    {-90.0, 0.0, 2800.0}, {89.9999, 45.0, 0.0}, {27.9, 86.9, 8900.0}};
  for (const geo::Geodetic& place : places) {
    const test::Flight flight = test::MakeFlight(place);
    const Georeference result = Place(flight);
    ASSERT_TRUE(result.ok) << "at " << place.latitude_deg;
    EXPECT_LT(result.fit.rmse_m, 1e-3) << place.latitude_deg << " " << place.longitude_deg;
    EXPECT_EQ(result.fit.n_inliers, 20);
    EXPECT_NEAR(result.fit.scale, 1.0 / 0.07, 1e-3);
    // The origin is near the flight, so coordinates stay small.
    const Eigen::Vector3d first = result.enu_from_model * flight.model.images[0].cam_from_world.OriginInSource();
    EXPECT_LT(first.norm(), 200.0);
    const geo::EnuFrame fitted(result.origin);
    const geo::EnuFrame tagged(place);
    const Eigen::Vector3d back = tagged.EnuFromGeodetic(fitted.GeodeticFromEnu(first));
    EXPECT_LT((back - flight.photos[0].centre_in_enu).norm(), 1e-2);
  }
}

TEST(Georeference, OutliersAreFoundAndDoNotPull) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  test::SetTags(flight, [](size_t i, const Eigen::Vector3d& centre) {
    return i % 5 == 2 ? Eigen::Vector3d(centre + Eigen::Vector3d(300.0, -150.0 * static_cast<double>(i), 60.0)) : centre;
  });
  const Georeference result = Place(flight);
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.fit.n_matches, 20);
  EXPECT_EQ(result.fit.n_inliers, 16);
  EXPECT_LT(result.fit.rmse_m, 1e-3);
  for (size_t i = 0; i < 20; ++i) EXPECT_EQ(result.photos[i].inlier, i % 5 != 2);
  EXPECT_GT(result.photos[2].residual_m.norm(), 300.0);
}

TEST(Georeference, ARefusedFitLeavesNoAccuracyBehind) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  for (test::FlightPhoto& photo : flight.photos) photo.tags.gps = geo::Geodetic{photo.tags.gps->longitude_deg, photo.tags.gps->latitude_deg, 400.0};
  const Georeference result = Place(flight);
  ASSERT_FALSE(result.ok);
  EXPECT_EQ(result.problems.front().code, "swapped_coordinates");
  EXPECT_TRUE(std::isnan(result.fit.accuracy.horizontal_m));
  EXPECT_TRUE(std::isnan(result.fit.accuracy.scale_percent));
  EXPECT_TRUE(std::isnan(result.fit.rmse_m));
  EXPECT_TRUE(result.fit.flight_vertical_drift_m.empty());
}

// Pitch of +90 at nadir: gimbal angles outweigh everything else, and a survey that hangs upside down looks mirrored to its GPS tags.
TEST(Georeference, GimbalAnglesThatStandAloneAreDropped) {
  const test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  std::vector<input::PreparedPhoto> photos = Photos(flight);
  const Georeference without = PlaceOnEarth(photos, Points(flight), {});
  for (input::PreparedPhoto& photo : photos) photo.up_in_cam = input::UpInCamera(90.0, 0.0);
  const Georeference result = PlaceOnEarth(photos, Points(flight), {});
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.gimbal.use, GimbalUse::kDropped);
  EXPECT_EQ(result.fit.n_inliers, 20);
  EXPECT_EQ(result.enu_from_model.scale, without.enu_from_model.scale);
  EXPECT_EQ(result.enu_from_model.rotation.coeffs(), without.enu_from_model.rotation.coeffs());
  EXPECT_EQ(result.enu_from_model.translation, without.enu_from_model.translation);
  // Right angles are used.
  for (input::PreparedPhoto& photo : photos) photo.up_in_cam = input::UpInCamera(-90.0, 0.0);
  const Georeference right = PlaceOnEarth(photos, Points(flight), {});
  EXPECT_EQ(right.gimbal.use, GimbalUse::kUsed);
  EXPECT_EQ(right.fit.gravity.front().kind, "gimbal");
}

TEST(Georeference, AJumpLeavesTwoGroups) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  test::SetTags(
      flight, [](size_t i, const Eigen::Vector3d& centre) { return i < 12 ? centre : Eigen::Vector3d(centre + Eigen::Vector3d(25.0, -15.0, 10.0)); });
  const Georeference result = Place(flight);
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.fit.n_inliers, 12);
  const auto group = std::find_if(result.problems.begin(), result.problems.end(), [](const auto& problem) { return problem.code == "two_groups"; });
  ASSERT_NE(group, result.problems.end());
  // 0.4 of the tags are 29 m away: two standard deviations reach the mean of both groups.
  EXPECT_GT(result.fit.accuracy.horizontal_m, 0.5 * 0.4 * 29.0);
}

TEST(Georeference, FlightsThatDisagreeGetOneOffsetEach) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  // Lines flown alternately on two days; heights of the second day are 15 m too high.
  for (size_t i = 0; i < 20; ++i) flight.photos[i].tags.capture_time_s = *flight.photos[i].tags.capture_time_s + (i % 3 == 1 ? 86400.0 : 0.0);
  test::SetTags(flight,
                [](size_t i, const Eigen::Vector3d& centre) { return Eigen::Vector3d(centre + Eigen::Vector3d(0.0, 0.0, i % 3 == 1 ? 15.0 : 0.0)); });
  const Georeference result = Place(flight);
  ASSERT_TRUE(result.ok);
  ASSERT_EQ(result.fit.flight_vertical_offset_m.size(), 2U);
  EXPECT_EQ(result.fit.flight_vertical_offset_m[0], 0.0);  // the larger flight is the reference
  EXPECT_NEAR(result.fit.flight_vertical_offset_m[1], -15.0, 0.05);
  EXPECT_EQ(result.fit.n_inliers, 20);
  EXPECT_LT(result.fit.rmse_m, 0.05);

  PlaceOptions off;
  off.flight_offsets = "off";
  const Georeference without = Place(flight, off);
  EXPECT_TRUE(without.fit.flight_vertical_offset_m.empty());
  EXPECT_LT(without.fit.n_inliers, 20);
}

TEST(Georeference, FlightsThatAgreeAreNotMovedApart) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  for (size_t i = 10; i < 20; ++i) flight.photos[i].tags.capture_time_s = *flight.photos[i].tags.capture_time_s + 86400.0;
  base::Random random(5);
  test::SetTags(flight, [&](size_t, const Eigen::Vector3d& centre) {
    return Eigen::Vector3d(centre + Eigen::Vector3d{random.Normal(), random.Normal(), 2.0 * random.Normal()});
  });
  const Georeference result = Place(flight);
  EXPECT_EQ(result.photos[9].flight, 0);
  EXPECT_EQ(result.photos[10].flight, 1);
  for (const double offset_m : result.fit.flight_vertical_offset_m) EXPECT_LT(std::abs(offset_m), 2.0);
  for (const double drift_m : result.fit.flight_vertical_drift_m) EXPECT_LT(std::abs(drift_m), 2.0);
}

TEST(Georeference, TheRtkFlightIsTheReference) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  for (size_t i = 0; i < 20; ++i) {
    flight.photos[i].tags.rtk = i % 3 == 1;
    flight.photos[i].tags.capture_time_s = *flight.photos[i].tags.capture_time_s + (i % 3 == 1 ? 86400.0 : 0.0);
  }
  test::SetTags(flight,
                [](size_t i, const Eigen::Vector3d& centre) { return Eigen::Vector3d(centre + Eigen::Vector3d(0.0, 0.0, i % 3 == 1 ? 0.0 : 15.0)); });
  const Georeference result = Place(flight);
  ASSERT_EQ(result.fit.flight_vertical_offset_m.size(), 2U);
  EXPECT_NEAR(result.fit.flight_vertical_offset_m[0], -15.0, 0.05);
  EXPECT_EQ(result.fit.flight_vertical_offset_m[1], 0.0);
}

TEST(Georeference, TooFewOrOnePlaceIsNotOk) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  std::vector<input::PreparedPhoto> photos = Photos(flight);
  for (size_t i = 2; i < photos.size(); ++i) photos[i].gps.reset();
  EXPECT_FALSE(PlaceOnEarth(photos, {}, {}).ok);
  for (input::PreparedPhoto& photo : photos) photo.gps.reset();
  EXPECT_FALSE(PlaceOnEarth(photos, {}, {}).ok);
  EXPECT_FALSE(PlaceOnEarth({}, {}, {}).ok);
  test::SetTags(flight, [](size_t, const Eigen::Vector3d&) { return Eigen::Vector3d(1.0, 2.0, 3.0); });
  const Georeference one_place = Place(flight);
  EXPECT_FALSE(one_place.ok);
  EXPECT_EQ(one_place.problems.front().code, "equal_tags");
}

TEST(Georeference, AnExactFrameStaysAndStillReportsResiduals) {
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  test::SetTags(flight, [](size_t, const Eigen::Vector3d& centre) { return Eigen::Vector3d(centre + Eigen::Vector3d(3.0, 0.0, 4.0)); });
  std::vector<input::PreparedPhoto> photos = Photos(flight);
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].cam_from_model.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    photos[i].cam_from_model.translation = -(photos[i].cam_from_model.rotation * flight.photos[i].centre_in_enu);
  }
  const Georeference result = KeepExactFrame(photos, flight.origin, {});
  EXPECT_EQ(result.enu_from_model.scale, 1.0);
  EXPECT_EQ(result.enu_from_model.translation, Eigen::Vector3d::Zero());
  EXPECT_NEAR(result.fit.rmse_m, 5.0, 1e-3);
  EXPECT_NEAR(result.fit.rmse_horizontal_m, 3.0, 1e-3);
  EXPECT_NEAR(result.fit.rmse_vertical_m, 4.0, 1e-3);
}

TEST(SplitFlights, GoesByTimeNotByName) {
  std::vector<input::PreparedPhoto> photos(6);
  const double times[] = {1000.0, 0.0, 5000.0, 500.0, -1.0, 5100.0};
  for (size_t i = 0; i < 6; ++i) {
    if (times[i] >= 0.0) photos[i].file.tags.capture_time_s = times[i];
  }
  EXPECT_EQ(input::SplitFlights(photos, 900.0), (std::vector<int>{0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(input::SplitFlights(photos, 400.0), (std::vector<int>{2, 0, 3, 1, 1, 3}));
  EXPECT_TRUE(input::SplitFlights({}, 900.0).empty());
}

TEST(LocalFrame, PutsTheGroundBelowAtAFixedDepth) {
  const test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  const std::vector<input::PreparedPhoto> photos = Photos(flight);
  const geo::Similarity3d local = LocalFrame(photos, Points(flight), FindGravity(photos, Points(flight)).up);
  EXPECT_NEAR((local.rotation * (flight.model_from_enu.rotation * Eigen::Vector3d::UnitZ())).z(), 1.0, 1e-5);
  EXPECT_NEAR((local * photos[7].cam_from_model.OriginInSource()).z(), kLocalDepth, 5.0);
}

TEST(LocalFrame, ObliqueCirclesAreLevelledByTheirHorizons) {
  std::vector<input::PreparedPhoto> photos;
  const Eigen::Vector3d up = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  const Eigen::Quaterniond tilt = linear::RotationBetween(Eigen::Vector3d::UnitZ(), up);
  for (int i = 0; i < 12; ++i) {
    const double angle = i * M_PI / 6.0;
    const Eigen::Vector3d centre(10.0 * std::cos(angle), 10.0 * std::sin(angle), 4.0);
    const Eigen::Vector3d forward = (-centre).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d world_from_cam;
    world_from_cam << right, forward.cross(right), forward;
    input::PreparedPhoto photo;
    photo.cam_from_model.rotation = Eigen::Quaterniond(world_from_cam).conjugate() * tilt.conjugate();
    photo.cam_from_model.translation = -(photo.cam_from_model.rotation * (tilt * centre));
    photos.push_back(photo);
  }
  const std::vector<Eigen::Vector3d> points = {Eigen::Vector3d::Zero(), tilt * Eigen::Vector3d(1.0, 1.0, 0.0),
                                               tilt * Eigen::Vector3d(-1.0, 0.5, 0.0)};
  const geo::Similarity3d local = LocalFrame(photos, points, FindGravity(photos, points).up);
  EXPECT_NEAR((local.rotation * up).z(), 1.0, 1e-9);
  EXPECT_GT((local * photos[0].cam_from_model.OriginInSource()).z(), 0.0);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
