#include "prepare/georeference/checks/flight_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "prepare/georeference/checks/flight_speed.h"
#include "tests/support/not_finite.h"

namespace skyquilt::prepare::georeference {
namespace {

// Nadir photos on lines of 120 m length, 20 m apart, flown to and fro at 5 m/s and 50 m above ground. Times are as exact as wanted.
struct Flight {
  survey::Survey survey;
  std::vector<input::PreparedPhoto> photos;

  survey::FlightChecks Check() const { return CheckFlight(survey, photos); }
  std::vector<std::string> Codes() const {
    std::vector<std::string> codes;
    for (const survey::Problem& problem : FlightProblems(Check(), survey)) codes.push_back(problem.code);
    return codes;
  }
};

constexpr double kSpeed_mps = 5.0;
constexpr double kInterval_s = 2.4;  // between photos

Flight MakeFlight(int n_lines = 8) {
  Flight flight;
  flight.survey.origin = {47.0, 8.0, 400.0};
  flight.survey.georeferenced = true;
  flight.survey.cameras = {{camera::CameraModel::kRadial, 1200, 900, {1000.0, 600.0, 450.0, -0.05, 0.01}}};
  const geo::EnuFrame frame(flight.survey.origin);
  // One path: lines of 120 m, joined by 20 m.
  for (double way_m = 0.0; way_m < 140.0 * n_lines - 20.0; way_m += kSpeed_mps * kInterval_s) {
    const int line = static_cast<int>(way_m / 140.0);
    const double along = std::min(way_m - 140.0 * line, 120.0);
    const double across = 20.0 * line + std::max(0.0, way_m - 140.0 * line - 120.0);
    survey::Photo photo;
    photo.name = "p" + std::to_string(flight.survey.photos.size());
    const Eigen::Vector3d centre(line % 2 == 0 ? along : 120.0 - along, across, 50.0);
    photo.cam_from_enu.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * centre);
    photo.gps = frame.GeodeticFromEnu(centre);
    photo.gps_inlier = true;
    photo.time_s = kInterval_s * static_cast<double>(flight.survey.photos.size());
    photo.agl_m = 50.0;
    flight.survey.photos.push_back(photo);
    survey::PhotoTags& tags = flight.photos.emplace_back().file.tags;
    tags.make = "DJI";
    tags.model = "FC300S";
  }
  return flight;
}

// Raises the tag of each photo.
void RaiseTags(Flight& flight, const std::function<double(const Eigen::Vector3d&)>& up_m) {
  for (survey::Photo& photo : flight.survey.photos) photo.gps->height_m += up_m(photo.cam_from_enu.OriginInSource());
}

TEST(FlightChecks, SpeedTagsComeFirst) {
  Flight flight = MakeFlight();
  for (size_t i = 0; i < 9; ++i) flight.photos[i].file.tags.speed_mps = static_cast<double>(i);
  flight.photos[9].file.tags.speed_mps = kNan;
  const survey::FlightChecks checks = flight.Check();
  EXPECT_EQ(checks.speed_mps, 4.0);
  EXPECT_EQ(checks.speed_source, "speed tags");
}

TEST(FlightChecks, SpeedFollowsFromPositionsAndTimes) {
  const survey::FlightChecks checks = MakeFlight().Check();
  EXPECT_NEAR(checks.speed_mps, kSpeed_mps, 0.1);
  EXPECT_EQ(checks.speed_source, "positions and times");
}

TEST(FlightSpeed, TimesRoundedToSecondsDoNotMatter) {
  for (const double phase : {0.0, 0.3, 0.7}) {
    Flight flight = MakeFlight();
    for (survey::Photo& photo : flight.survey.photos) photo.time_s = std::floor(*photo.time_s + phase);
    EXPECT_NEAR(SpeedFromPositions(flight.survey), kSpeed_mps, 0.2) << phase;
  }
}

TEST(FlightSpeed, PausesAndOtherFlightsDoNotCount) {
  Flight flight = MakeFlight();
  std::vector<survey::Photo>& photos = flight.survey.photos;
  const auto half = static_cast<std::ptrdiff_t>(photos.size() / 2);
  for (auto photo = photos.begin() + half; photo != photos.end(); ++photo) {
    *photo->time_s += 60.0;
    photo->cam_from_enu.translation.x() += 3000.0;
  }
  EXPECT_NEAR(SpeedFromPositions(flight.survey), kSpeed_mps, 0.2);
  // A flight at the same time at another place.
  for (auto photo = photos.begin() + half; photo != photos.end(); ++photo) {
    *photo->time_s -= 60.0 + kInterval_s * static_cast<double>(half);
    photo->flight = 1;
  }
  EXPECT_NEAR(SpeedFromPositions(flight.survey), kSpeed_mps, 0.2);
}

TEST(FlightSpeed, IsUnknownWithoutTimes) {
  Flight flight = MakeFlight();
  for (survey::Photo& photo : flight.survey.photos) photo.time_s = 7.0;
  EXPECT_TRUE(std::isnan(SpeedFromPositions(flight.survey)));
  for (survey::Photo& photo : flight.survey.photos) photo.time_s.reset();
  EXPECT_TRUE(std::isnan(SpeedFromPositions(flight.survey)));
  EXPECT_TRUE(std::isnan(SpeedFromPositions({})));
}

TEST(FlightChecks, SmearIsTheMotionDuringReadOut) {
  Flight flight = MakeFlight();
  for (input::PreparedPhoto& photo : flight.photos) photo.file.tags.speed_mps = 4.0;
  const survey::FlightChecks checks = flight.Check();
  EXPECT_EQ(checks.camera_name, "DJI FC300S");
  EXPECT_EQ(checks.readout_ms, 33.0);
  // 4 m/s * 0.033 s = 0.132 m, on pixels of 50 m / 1000 px = 0.05 m.
  EXPECT_NEAR(checks.smear_px, 2.64, 1e-9);
  const std::vector<survey::Problem> problems = FlightProblems(checks, flight.survey);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].code, "rolling_shutter");
  EXPECT_FALSE(problems[0].about_place);
  for (const char* part : {"DJI FC300S", "33 ms", "4.0 m/s", "2.6 pixels"}) {
    EXPECT_NE(problems[0].finding.find(part), std::string::npos) << problems[0].finding;
  }
}

TEST(FlightChecks, SlowFlightsAndMechanicalShuttersAreNotWarnedOf) {
  Flight flight = MakeFlight();
  for (input::PreparedPhoto& photo : flight.photos) photo.file.tags.speed_mps = 1.5;
  EXPECT_NEAR(flight.Check().smear_px, 0.99, 1e-9);
  EXPECT_TRUE(flight.Codes().empty());
  for (input::PreparedPhoto& photo : flight.photos) {
    photo.file.tags.speed_mps = 15.0;
    photo.file.tags.model = "FC6310R";
  }
  EXPECT_EQ(flight.Check().smear_px, 0.0);
  EXPECT_TRUE(flight.Codes().empty());
}

TEST(FlightChecks, AnUnknownCameraIsNotWarnedOf) {
  Flight flight = MakeFlight();
  for (input::PreparedPhoto& photo : flight.photos) photo.file.tags.model = "X-1";
  EXPECT_TRUE(std::isnan(flight.Check().readout_ms));
  EXPECT_TRUE(std::isnan(flight.Check().smear_px));
  EXPECT_TRUE(flight.Codes().empty());
}

TEST(FlightChecks, WithoutGeoreferenceLengthsAreUnknown) {
  Flight flight = MakeFlight();
  flight.survey.georeferenced = false;
  const survey::FlightChecks checks = flight.Check();
  EXPECT_TRUE(std::isnan(checks.speed_mps));
  EXPECT_TRUE(std::isnan(checks.smear_px));
  EXPECT_TRUE(std::isnan(checks.dome_m));
  EXPECT_EQ(checks.k1, -0.05);
  for (input::PreparedPhoto& photo : flight.photos) photo.file.tags.speed_mps = 9.0;
  EXPECT_EQ(flight.Check().speed_mps, 9.0);
  EXPECT_TRUE(std::isnan(flight.Check().smear_px));
}

TEST(FlightChecks, ADomeOfTheReconstructionIsWarnedOf) {
  base::Random random(3);
  Flight flight = MakeFlight();
  for (input::PreparedPhoto& photo : flight.photos) photo.file.tags.speed_mps = 0.0;
  // Tags as a reconstruction with a dome of 6 m sees them: the middle too low.
  RaiseTags(flight, [&](const Eigen::Vector3d& c) {
    const double r2 = (c.head<2>() - Eigen::Vector2d(60.0, 70.0)).squaredNorm();
    return -6.0 * (1.0 - r2 / (85.0 * 85.0)) + 0.5 * random.Normal();
  });
  const survey::FlightChecks checks = flight.Check();
  EXPECT_NEAR(checks.dome_m, 6.0, 1.5);
  EXPECT_LT(checks.dome_sigma_m, 1.0);
  const std::vector<survey::Problem> problems = FlightProblems(checks, flight.survey);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].code, "doming");
  EXPECT_NE(problems[0].finding.find("too high"), std::string::npos) << problems[0].finding;
  // The corrections of the tags' heights are part of the tag.
  for (survey::Photo& photo : flight.survey.photos) {
    photo.gps_correction_m.z() = 400.0 + photo.cam_from_enu.OriginInSource().z() - photo.gps->height_m;
  }
  EXPECT_NEAR(flight.Check().dome_m, 0.0, 0.01);
}

TEST(FlightChecks, ADomeIsWarnedOfOnlyWhenLargeAndCertain) {
  const Flight flight = MakeFlight();
  survey::FlightChecks checks;
  const auto n_problems = [&](double dome_m, double sigma_m) {
    checks.dome_m = dome_m;
    checks.dome_sigma_m = sigma_m;
    return FlightProblems(checks, flight.survey).size();
  };
  EXPECT_EQ(n_problems(3.0, 0.9), 1U);
  EXPECT_EQ(n_problems(-3.0, 0.9), 1U);
  EXPECT_EQ(n_problems(3.0, 1.1), 0U);
  EXPECT_EQ(n_problems(0.9, 0.1), 0U);
  EXPECT_EQ(n_problems(kNan, kNan), 0U);
  Flight high = MakeFlight();
  for (survey::Photo& photo : high.survey.photos) photo.agl_m = 400.0;
  checks.dome_m = 3.0;
  checks.dome_sigma_m = 0.1;
  EXPECT_EQ(FlightProblems(checks, high.survey).size(), 0U);
}

TEST(FlightChecks, OnlyTagsThatAgreeWithTheFitShowADome) {
  Flight flight = MakeFlight();
  RaiseTags(flight, [](const Eigen::Vector3d& c) { return 1e-3 * c.head<2>().squaredNorm(); });
  EXPECT_GT(std::abs(flight.Check().dome_m), 1.0);
  for (size_t i = 9; i < flight.survey.photos.size(); ++i) flight.survey.photos[i].gps_inlier = false;
  EXPECT_TRUE(std::isnan(flight.Check().dome_m));
}

TEST(FlightChecks, AnIllDeterminedLensIsWarnedOf) {
  const Flight flight = MakeFlight();
  survey::FlightChecks checks = flight.Check();
  EXPECT_EQ(checks.k1, -0.05);
  EXPECT_TRUE(std::isnan(checks.k1_sigma));
  // The corner is at 0.75 focal lengths as seen, a little more without distortion: 1000 px * sigma * r^3.
  EXPECT_NEAR(CornerShift(flight.survey.cameras[0], 0.001), 0.455, 0.01);
  checks.smear_px = 0.0;
  checks.k1_sigma = 0.0015;
  EXPECT_TRUE(FlightProblems(checks, flight.survey).empty());
  checks.k1_sigma = 0.003;
  ASSERT_EQ(FlightProblems(checks, flight.survey).size(), 1U);
  EXPECT_EQ(FlightProblems(checks, flight.survey)[0].code, "lens_uncertain");
}

TEST(FlightChecks, TheCameraWithMostPhotosCounts) {
  Flight flight = MakeFlight();
  flight.survey.cameras.push_back({camera::CameraModel::kPinhole, 640, 480, {500.0, 500.0, 320.0, 240.0}});
  for (size_t i = 0; 3 * i < flight.survey.photos.size(); ++i) flight.survey.photos[i].camera = 1;
  EXPECT_EQ(MainCamera(flight.survey), 0);
  for (survey::Photo& photo : flight.survey.photos) photo.camera = 1 - photo.camera;
  EXPECT_EQ(MainCamera(flight.survey), 1);
  EXPECT_EQ(MainCamera({}), -1);
}

TEST(FlightChecks, NothingBreaksThem) {
  base::Random random(9);
  const double strange[] = {kNan, std::numeric_limits<double>::infinity(), -1e300, 1e300, 0.0, -1.0, 1e-300};
  const auto any = [&] { return strange[random.Below(std::size(strange))]; };
  for (int round = 0; round < 300; ++round) {
    Flight flight = MakeFlight(1 + static_cast<int>(random.Below(8)));
    for (size_t i = 0; i < flight.survey.photos.size(); ++i) {
      survey::Photo& photo = flight.survey.photos[i];
      switch (random.Below(10)) {
        case 0:
          photo.time_s = any();
          break;
        case 1:
          photo.gps->height_m = any();
          break;
        case 2:
          photo.gps.reset();
          break;
        case 3:
          photo.agl_m = any();
          break;
        case 4:
          photo.cam_from_enu.translation[random.Below(3)] = any();
          break;
        case 5:
          flight.photos[i].file.tags.speed_mps = any();
          break;
        case 6:
          photo.exposure.time_s = any();
          break;
        case 7:
          photo.gps_correction_m.z() = any();
          break;
        default:
          break;
      }
    }
    survey::FlightChecks checks = flight.Check();
    checks.k1_sigma = any();
    EXPECT_FALSE(DescribeChecks(checks).empty());
    for (const survey::Problem& problem : FlightProblems(checks, flight.survey)) {
      EXPECT_EQ(problem.finding.find("nan"), std::string::npos) << problem.finding;
    }
  }
  EXPECT_TRUE(std::isnan(CheckFlight({}, {}).speed_mps));
  EXPECT_EQ(DescribeChecks({}), "flight checks: speed unknown, read-out unknown, smear unknown, dome unknown, lens k1 none");
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
