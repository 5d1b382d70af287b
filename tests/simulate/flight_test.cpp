#include "simulate/flight.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "core/base/random.h"

namespace skyquilt::simulate {
namespace {

PlaceSpec PlaceWithOverlaps(const std::string& name, double forward, double side) {
  SimulateOptions options;
  options.place = name;
  options.forward_overlap = forward;
  options.side_overlap = side;
  return ResolvePlace(options);
}

std::map<int, std::vector<Eigen::Vector3d>> NadirLines(const std::vector<PhotoPlan>& photos) {
  std::map<int, std::vector<Eigen::Vector3d>> lines;
  for (const PhotoPlan& photo : photos) {
    if (!photo.oblique) lines[photo.line].push_back(photo.cam_from_enu.OriginInSource());
  }
  return lines;
}

// Position errors of the drone (0.25 m per axis) average out over a line.
TEST(Flight, OverlapsAreAsRequested) {
  for (const double forward : {0.6, 0.8}) {
    for (const double side : {0.5, 0.7}) {
      const PlaceSpec place = PlaceWithOverlaps("town", forward, side);
      const auto lines = NadirLines(PlanFlight(place, 3.0));
      ASSERT_GE(lines.size(), 2U);
      const double altitude = place.altitudes_agl_m.front();
      double previous_east = 0.0;
      for (const auto& [line, positions] : lines) {
        ASSERT_GE(positions.size(), 2U);
        const double step = (positions.back() - positions.front()).head<2>().norm() / static_cast<double>(positions.size() - 1);
        EXPECT_NEAR(1.0 - step * place.camera.FocalY() / (altitude * place.camera.height), forward, 0.01);
        double east = 0.0;
        for (const Eigen::Vector3d& p : positions) {
          east += p.x() / static_cast<double>(positions.size());
          EXPECT_NEAR(p.z(), altitude + 3.0, 1.5);
        }
        if (line > 0) {
          EXPECT_NEAR(1.0 - (east - previous_east) * place.camera.FocalX() / (altitude * place.camera.width), side, 0.01);
        }
        previous_east = east;
      }
    }
  }
}

TEST(Flight, GimbalAnglesGiveThePose) {
  const Eigen::Vector3d position(10.0, 20.0, 100.0);
  const geo::Rigid3d nadir = PoseFromGimbal(position, 0.0, -90.0, 0.0);
  EXPECT_LT((nadir.OriginInSource() - position).norm(), 1e-9);
  // Straight below: depth is the height; east is right, north is up in the photo.
  EXPECT_LT((nadir * Eigen::Vector3d(10.0, 20.0, 0.0) - Eigen::Vector3d(0, 0, 100)).norm(), 1e-9);
  EXPECT_LT((nadir * Eigen::Vector3d(15.0, 27.0, 0.0) - Eigen::Vector3d(5, -7, 100)).norm(), 1e-9);
  // Looking east and 30 degrees down: the optical axis hits the ground 100 / tan(30) m ahead.
  const geo::Rigid3d oblique = PoseFromGimbal(position, 90.0, -30.0, 0.0);
  const Eigen::Vector3d ahead = oblique * Eigen::Vector3d(10.0 + 100.0 / std::tan(M_PI / 6.0), 20.0, 0.0);
  EXPECT_NEAR(ahead.x(), 0.0, 1e-9);
  EXPECT_NEAR(ahead.y(), 0.0, 1e-9);
  EXPECT_NEAR(ahead.z(), 200.0, 1e-9);
  // A level camera keeps the horizon level; roll turns it.
  EXPECT_NEAR((oblique.rotation * Eigen::Vector3d(0, 0, 1)).x(), 0.0, 1e-12);
  EXPECT_GT(std::abs((PoseFromGimbal(position, 90.0, -30.0, 5.0).rotation * Eigen::Vector3d(0, 0, 1)).x()), 0.01);
}

// Straight down and up too, where yaw and roll cannot be told apart, and next to it.
TEST(Flight, GimbalAnglesOfAPoseGiveItsRotationBack) {
  base::Random random(7);
  std::vector<GimbalAngles> cases;
  for (const double pitch : {-90.0, 90.0, 0.0, -60.0}) {
    for (const double off : {0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-3, 0.5}) {
      for (int i = 0; i < 20; ++i)
        cases.push_back({random.Uniform(-180.0, 180.0), pitch + (pitch > 0.0 ? -off : off), random.Uniform(-180.0, 180.0)});
    }
  }
  for (const GimbalAngles& angles : cases) {
    const geo::Rigid3d pose = PoseFromGimbal({1, 2, 3}, angles.yaw_deg, angles.pitch_deg, angles.roll_deg);
    const GimbalAngles found = GimbalFromPose(pose);
    EXPECT_LE(std::abs(found.yaw_deg), 180.0);
    EXPECT_LE(std::abs(found.pitch_deg), 90.0);
    EXPECT_LE(std::abs(found.roll_deg), 180.0);
    const geo::Rigid3d again = PoseFromGimbal({1, 2, 3}, found.yaw_deg, found.pitch_deg, found.roll_deg);
    EXPECT_LT((again.rotation.toRotationMatrix() - pose.rotation.toRotationMatrix()).cwiseAbs().maxCoeff(), 1e-13)
        << angles.yaw_deg << " " << angles.pitch_deg << " " << angles.roll_deg;
    // Away from the poles each angle is itself.
    if (std::abs(std::abs(angles.pitch_deg) - 90.0) < 0.1) continue;
    EXPECT_NEAR(std::remainder(found.yaw_deg - angles.yaw_deg, 360.0), 0.0, 1e-9);
    EXPECT_NEAR(found.pitch_deg, angles.pitch_deg, 1e-9);
    EXPECT_NEAR(std::remainder(found.roll_deg - angles.roll_deg, 360.0), 0.0, 1e-9);
  }
  // Rotations that were not made from angles.
  for (int i = 0; i < 500; ++i) {
    const Eigen::Quaterniond rotation = Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}.normalized();
    const GimbalAngles found = GimbalFromPose({rotation, Eigen::Vector3d::Zero()});
    const geo::Rigid3d again = PoseFromGimbal(Eigen::Vector3d::Zero(), found.yaw_deg, found.pitch_deg, found.roll_deg);
    EXPECT_LT((again.rotation.toRotationMatrix() - rotation.toRotationMatrix()).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(Flight, ASingleLineGoesNorthThroughTheMiddle) {
  for (const char* name : {"town", "smallcity"}) {
    SimulateOptions options;
    options.place = name;
    options.single_line = true;
    const PlaceSpec place = ResolvePlace(options);
    const std::vector<PhotoPlan> photos = PlanFlight(place, 0.0);
    ASSERT_GE(photos.size(), 5U);
    double mean = 0.0;
    for (const double altitude : place.altitudes_agl_m) mean += altitude / static_cast<double>(place.altitudes_agl_m.size());
    double north = -1e9;
    for (const PhotoPlan& photo : photos) {
      const Eigen::Vector3d at = photo.cam_from_enu.OriginInSource();
      EXPECT_NEAR(at.x(), 0.5 * (place.area_min.x() + place.area_max.x()), 1.5);
      EXPECT_NEAR(at.z(), mean, 1.5);
      EXPECT_GT(at.y(), north);
      north = at.y();
      EXPECT_FALSE(photo.oblique);
      EXPECT_EQ(photo.line, 0);
    }
    EXPECT_GT(north, 0.7 * place.area_max.y());
  }
}

TEST(Flight, GainsAreRelativeToTheMedianAndMatchTheTags) {
  const PlaceSpec place = PlaceWithOverlaps("tidalflat", -1.0, -1.0);
  const std::vector<PhotoPlan> photos = PlanFlight(place, 0.0);
  std::vector<double> gains;
  double largest_step = 0.0;
  for (const PhotoPlan& photo : photos) {
    gains.push_back(photo.gain);
    const double exposure = photo.exposure_time_s * photo.iso / (photo.f_number * photo.f_number);
    const double first = photos[0].exposure_time_s * photos[0].iso / (photos[0].f_number * photos[0].f_number);
    EXPECT_NEAR(photo.gain / photos[0].gain, exposure / first, 1e-9);
    if (gains.size() > 1) largest_step = std::max(largest_step, std::abs(std::log2(gains.back() / gains[gains.size() - 2])));
  }
  std::sort(gains.begin(), gains.end());
  EXPECT_NEAR(gains[gains.size() / 2], 1.0, 0.1);
  EXPECT_GT(std::log2(gains.back() / gains.front()), 1.5);  // drifts
  EXPECT_GT(largest_step, 0.4);                             // and jumps
}

std::vector<PhotoPlan> TownFlight(const std::function<void(SimulateOptions&)>& change) {
  SimulateOptions options;
  options.place = "town";
  change(options);
  return PlanFlight(ResolvePlace(options), 0.0);
}

double TaggedExposure(const PhotoPlan& photo) {
  return photo.exposure_time_s * photo.iso / (100.0 * photo.f_number * photo.f_number);
}

void ExpectSameTags(const std::vector<PhotoPlan>& a, const std::vector<PhotoPlan>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].exposure_time_s, b[i].exposure_time_s);
    EXPECT_EQ(a[i].iso, b[i].iso);
    EXPECT_EQ(a[i].f_number, b[i].f_number);
    EXPECT_EQ(a[i].gain, b[i].gain);
    EXPECT_TRUE(a[i].tagged_position == b[i].tagged_position);
  }
}

TEST(Flight, LightIsTheGainUnlessAskedFor) {
  for (const char* name : {"town", "tidalflat"}) {
    for (const PhotoPlan& photo : PlanFlight(PlaceWithOverlaps(name, -1.0, -1.0), 0.0)) {
      EXPECT_EQ(photo.development_gain, photo.gain);
      EXPECT_EQ(LightRgb(photo), (std::array<double, 3>{photo.gain, photo.gain, photo.gain}));
      EXPECT_TRUE(photo.exposure_tagged);
    }
  }
}

// Exposure times are 1/n with n above 400: rounded by up to 0.13 %, and so is the median.
TEST(Flight, OffsetChangesLightAndTagsAlike) {
  const std::vector<PhotoPlan> normal = TownFlight([](SimulateOptions&) {});
  for (const double stops : {-2.0, 1.5}) {
    const std::vector<PhotoPlan> photos = TownFlight([&](SimulateOptions& o) { o.exposure_offset_stops = stops; });
    ASSERT_EQ(photos.size(), normal.size());
    const double factor = std::exp2(stops);
    for (size_t i = 0; i < photos.size(); ++i) {
      EXPECT_NEAR(TaggedExposure(photos[i]) / TaggedExposure(normal[i]), factor, 0.003 * factor);
      EXPECT_NEAR(photos[i].development_gain / normal[i].development_gain, factor, 0.006 * factor);
      EXPECT_NEAR(photos[i].development_gain, factor * photos[i].gain, 1e-12 * factor);
    }
  }
}

TEST(Flight, LongExposuresAreTaggedToo) {
  const std::vector<PhotoPlan> normal = TownFlight([](SimulateOptions&) {});
  const std::vector<PhotoPlan> photos = TownFlight([](SimulateOptions& o) { o.exposure_offset_stops = 10.0; });
  for (size_t i = 0; i < photos.size(); ++i) {
    // About 0.64 s, in hundredths.
    EXPECT_NEAR(photos[i].exposure_time_s * 100.0, std::round(photos[i].exposure_time_s * 100.0), 1e-9);
    EXPECT_NEAR(TaggedExposure(photos[i]) / TaggedExposure(normal[i]), 1024.0, 15.0);
  }
}

TEST(Flight, BrightnessErrorsAreNotInTheTags) {
  const std::vector<PhotoPlan> exact = TownFlight([](SimulateOptions&) {});
  const auto erring = [](SimulateOptions& o) { o.exposure_error_stops = 0.5; };
  const std::vector<PhotoPlan> photos = TownFlight(erring);
  ExpectSameTags(photos, exact);
  const std::vector<PhotoPlan> again = TownFlight(erring);
  const auto n = static_cast<double>(photos.size());
  double sum = 0.0;
  double squares = 0.0;
  for (size_t i = 0; i < photos.size(); ++i) {
    EXPECT_EQ(photos[i].development_gain, again[i].development_gain);
    const double stops = std::log2(photos[i].development_gain / photos[i].gain);
    sum += stops;
    squares += stops * stops;
  }
  // With 110 samples the mean is accurate to 0.05 stops, the standard deviation to 7 %.
  EXPECT_NEAR(sum / n, 0.0, 0.2);
  EXPECT_NEAR(std::sqrt(squares / n), 0.5, 0.14);
}

TEST(Flight, ColorDriftsSlowlyAndTurnsRedAgainstBlue) {
  const double most = 0.8;
  const std::vector<PhotoPlan> photos = TownFlight([&](SimulateOptions& o) { o.color_drift_stops = most; });
  ExpectSameTags(photos, TownFlight([](SimulateOptions&) {}));
  double reddest = 0.0;
  double bluest = 0.0;
  double previous = photos[0].color_drift_stops;
  for (const PhotoPlan& photo : photos) {
    const std::array<double, 3> light = LightRgb(photo);
    EXPECT_EQ(light[1], photo.gain);
    EXPECT_NEAR(light[0] * light[2], light[1] * light[1], 1e-12);
    const double drift = std::log2(light[0] / light[1]);
    EXPECT_LE(std::abs(drift), most + 1e-12);
    // The largest possible slope of the noise, see ValueNoise.
    EXPECT_LE(std::abs(drift - previous), 0.5 * most + 1e-6);
    previous = drift;
    reddest = std::max(reddest, drift);
    bluest = std::min(bluest, drift);
  }
  EXPECT_GT(reddest, 0.25 * most);
  EXPECT_LT(bluest, -0.25 * most);
}

TEST(Flight, ExposureTagsAreLeftOutAsAsked) {
  const std::vector<PhotoPlan> none = TownFlight([](SimulateOptions& o) { o.exposure_tags = "none"; });
  const std::vector<PhotoPlan> half = TownFlight([](SimulateOptions& o) { o.exposure_tags = "half"; });
  ExpectSameTags(none, half);
  for (size_t i = 0; i < none.size(); ++i) {
    EXPECT_FALSE(none[i].exposure_tagged);
    EXPECT_EQ(half[i].exposure_tagged, i % 2 == 0) << i;
  }
}

TEST(Flight, GpsNoiseHasTheStatedSize) {
  SimulateOptions options;
  options.place = "town";
  options.gps_noise_m = 2.0;
  const std::vector<PhotoPlan> photos = PlanFlight(ResolvePlace(options), 0.0);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const PhotoPlan& photo : photos) squares += (photo.tagged_position - photo.cam_from_enu.OriginInSource()).cwiseAbs2();
  const Eigen::Vector3d sigma = (squares / static_cast<double>(photos.size())).cwiseSqrt();
  // With 110 samples the estimate is accurate to 7 %.
  EXPECT_NEAR(sigma.x(), 2.0, 0.5);
  EXPECT_NEAR(sigma.y(), 2.0, 0.5);
  EXPECT_NEAR(sigma.z(), 3.0, 0.75);
}

TEST(Flight, BlocksAreFlownAtTheirOwnAltitudes) {
  const PlaceSpec place = PlaceWithOverlaps("smallcity", -1.0, -1.0);
  const std::vector<PhotoPlan> photos = PlanFlight(place, 0.0);
  const Eigen::Vector2d block = (place.area_max - place.area_min).cwiseQuotient(Eigen::Vector2d(place.columns, place.rows));
  std::vector<int> seen(place.altitudes_agl_m.size(), 0);
  for (const PhotoPlan& photo : photos) {
    const Eigen::Vector3d p = photo.cam_from_enu.OriginInSource();
    const Eigen::Vector2d cell = (p.head<2>() - place.area_min).cwiseQuotient(block);
    // Lines may be just outside their block; use only photos well inside.
    const Eigen::Vector2d inside = cell - Eigen::Vector2d(std::floor(cell.x()), std::floor(cell.y()));
    if (inside.minCoeff() < 0.14 || inside.maxCoeff() > 0.86) continue;
    const auto index = static_cast<size_t>(std::floor(cell.y()) * place.columns + std::floor(cell.x()));
    ASSERT_LT(index, seen.size());
    EXPECT_NEAR(p.z(), place.altitudes_agl_m[index], 2.0);
    ++seen[index];
  }
  for (const int n : seen) EXPECT_GT(n, 0);
}

}  // namespace
}  // namespace skyquilt::simulate
