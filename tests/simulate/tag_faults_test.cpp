#include "simulate/tag_faults.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "simulate/flight.h"
#include "simulate/survey_writer.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kDegrees = 180.0 / std::numbers::pi;

using Change = std::function<void(SimulateOptions&)>;

PlaceSpec Town(const Change& change) {
  SimulateOptions options;
  options.place = "town";
  options.gps_noise_m = 0.0;
  change(options);
  return ResolvePlace(options);
}

std::vector<PhotoPlan> Flight(const Change& change) {
  const PlaceSpec place = Town(change);
  std::vector<PhotoPlan> photos = PlanFlight(place, 2.0);
  ApplyTagFaults(place.tag_faults, place.seed, photos);
  return photos;
}

// Tagged minus true positions.
std::vector<Vector3d> Errors(const std::vector<PhotoPlan>& photos) {
  std::vector<Vector3d> errors;
  errors.reserve(photos.size());
  for (const PhotoPlan& photo : photos) errors.push_back(photo.tagged_position - photo.cam_from_enu.OriginInSource());
  return errors;
}

survey::PhotoTags TagsOf(const PhotoPlan& photo, const geo::Geodetic& origin) {
  return MakeTags(photo, Town([](SimulateOptions&) {}).camera, geo::EnuFrame(origin));
}

const geo::Geodetic kOrigin = {47.3769, 8.5417, 408.0};

TEST(TagFaults, NoneChangeNothing) {
  const PlaceSpec place = Town([](SimulateOptions& o) { o.gps_noise_m = 1.0; });
  const std::vector<PhotoPlan> planned = PlanFlight(place, 2.0);
  std::vector<PhotoPlan> photos = planned;
  ApplyTagFaults(place.tag_faults, place.seed, photos);
  for (size_t i = 0; i < photos.size(); ++i) {
    EXPECT_TRUE(photos[i].tagged_position == planned[i].tagged_position);
    ASSERT_TRUE(photos[i].tagged_gimbal.has_value());
    EXPECT_EQ(photos[i].tagged_gimbal->yaw_deg, photos[i].yaw_deg);
    EXPECT_EQ(photos[i].tagged_gimbal->pitch_deg, photos[i].pitch_deg);
    EXPECT_EQ(photos[i].tagged_gimbal->roll_deg, photos[i].roll_deg);
    EXPECT_EQ(photos[i].tagged_heights, HeightTags::kTrue);
    EXPECT_FALSE(photos[i].coordinates_swapped);
    EXPECT_FALSE(photos[i].tagged_speed_mps.has_value());
  }
}

TEST(TagFaults, ComeOnTopOfTheNoiseAndLeaveTheTruthAlone) {
  const auto noise = [](SimulateOptions& o) { o.gps_noise_m = 1.0; };
  const std::vector<PhotoPlan> noisy = Flight(noise);
  const std::vector<PhotoPlan> photos = Flight([&](SimulateOptions& o) {
    noise(o);
    o.tag_height_offset_m = 47.0;
  });
  for (size_t i = 0; i < photos.size(); ++i) {
    EXPECT_LT((photos[i].tagged_position - noisy[i].tagged_position - Vector3d(0, 0, 47)).norm(), 1e-9);
    EXPECT_TRUE(photos[i].cam_from_enu.translation == noisy[i].cam_from_enu.translation);
    EXPECT_EQ(photos[i].relative_altitude_m, noisy[i].relative_altitude_m);
  }
}

TEST(TagFaults, LagShowsWhereTheDroneWas) {
  const std::vector<PhotoPlan> truth = Flight([](SimulateOptions&) {});
  std::vector<Vector3d> p;
  p.reserve(truth.size());
  for (const PhotoPlan& photo : truth) p.push_back(photo.cam_from_enu.OriginInSource());
  const double interval = truth[1].time_s - truth[0].time_s;
  const size_t last = truth.size() - 1;
  const auto tagged = [](double lag_s, size_t i) { return Flight([&](SimulateOptions& o) { o.tag_lag_s = lag_s; })[i].tagged_position; };
  EXPECT_LT((tagged(interval, 7) - p[6]).norm(), 1e-9);
  EXPECT_LT((tagged(0.25 * interval, 7) - (0.75 * p[7] + 0.25 * p[6])).norm(), 1e-9);
  EXPECT_LT((tagged(2.5 * interval, 7) - 0.5 * (p[4] + p[5])).norm(), 1e-9);
  EXPECT_LT((tagged(-interval, 7) - p[8]).norm(), 1e-9);
  // Before the first and after the last photo the drone flies straight.
  EXPECT_LT((tagged(2.0 * interval, 0) - (p[0] - 2.0 * (p[1] - p[0]))).norm(), 1e-9);
  EXPECT_LT((tagged(2.0 * interval, 1) - (p[0] - (p[1] - p[0]))).norm(), 1e-9);
  EXPECT_LT((tagged(-interval, last) - (2.0 * p[last] - p[last - 1])).norm(), 1e-9);
}

TEST(TagFaults, DriftRisesEvenly) {
  const std::vector<PhotoPlan> photos = Flight([](SimulateOptions& o) { o.tag_drift_m = -100.0; });
  const std::vector<Vector3d> errors = Errors(photos);
  for (size_t i = 0; i < photos.size(); ++i) {
    EXPECT_LT((errors[i] - Vector3d(0, 0, -100.0 * static_cast<double>(i) / static_cast<double>(photos.size() - 1))).norm(), 1e-9);
  }
}

TEST(TagFaults, JumpComesAfterSixtyPercent) {
  const std::vector<PhotoPlan> photos = Flight([](SimulateOptions& o) { o.tag_jump_m = 20.0; });
  const std::vector<Vector3d> errors = Errors(photos);
  for (size_t i = 0; i < photos.size(); ++i) {
    if (photos[i].time_s < 0.6 * photos.back().time_s) {
      EXPECT_LT(errors[i].norm(), 1e-9);
    } else {
      EXPECT_NEAR(errors[i].head<2>().norm(), 20.0, 1e-9);
      EXPECT_NEAR(errors[i].z(), 10.0, 1e-9);
      EXPECT_LT((errors[i] - errors.back()).norm(), 1e-9);
    }
  }
}

TEST(TagFaults, OutliersAreAsManyAndAsFarAsStated) {
  for (const double share : {0.1, 0.33, 0.9}) {
    const std::vector<Vector3d> errors = Errors(Flight([&](SimulateOptions& o) {
      o.tag_outliers = share;
      o.tag_outlier_m = 70.0;
    }));
    long n = 0;
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& error : errors) {
      if (error.norm() < 1e-9) continue;
      EXPECT_NEAR(error.norm(), 70.0, 1e-9);
      sum += error;
      ++n;
    }
    EXPECT_EQ(n, std::lround(share * static_cast<double>(errors.size())));
    // Directions cancel: per axis the mean of n is about 70 / sqrt(3 n).
    EXPECT_LT((sum / static_cast<double>(n)).norm(), 3.5 * 70.0 / std::sqrt(static_cast<double>(n)));
  }
}

TEST(TagFaults, BiasIsCommonAndOfTheStatedSize) {
  Vector3d squares = Vector3d::Zero();
  constexpr int kSeeds = 400;
  std::vector<PhotoPlan> photos = PlanFlight(Town([](SimulateOptions& o) { o.single_line = true; }), 0.0);
  TagFaults faults;
  faults.bias_m = 3.0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    std::vector<PhotoPlan> biased = photos;
    ApplyTagFaults(faults, seed, biased);
    const std::vector<Vector3d> errors = Errors(biased);
    for (const Vector3d& error : errors) EXPECT_LT((error - errors.front()).norm(), 1e-9);
    squares += errors.front().cwiseAbs2() / kSeeds;
  }
  // 400 draws give a standard deviation to 3.5 %.
  EXPECT_NEAR(std::sqrt(squares.x()), 3.0, 0.4);
  EXPECT_NEAR(std::sqrt(squares.y()), 3.0, 0.4);
  EXPECT_NEAR(std::sqrt(squares.z()), 4.5, 0.6);
}

TEST(TagFaults, HeightsMayBeZeroOrAbsent) {
  const PhotoPlan zero = Flight([](SimulateOptions& o) { o.tag_heights = "zero"; })[5];
  const PhotoPlan none = Flight([](SimulateOptions& o) { o.tag_heights = "none"; })[5];
  const survey::PhotoTags all = TagsOf(Flight([](SimulateOptions&) {})[5], kOrigin);
  EXPECT_NEAR(all.gps->height_m, 408.0 + 87.0, 3.0);
  EXPECT_NEAR(*all.absolute_altitude_m, all.gps->height_m, 0.0051);
  EXPECT_NEAR(*all.relative_altitude_m, 85.0, 3.0);
  const survey::PhotoTags zeros = TagsOf(zero, kOrigin);
  EXPECT_EQ(zeros.gps->height_m, 0.0);
  EXPECT_EQ(zeros.absolute_altitude_m, 0.0);
  EXPECT_EQ(zeros.relative_altitude_m, 0.0);
  const survey::PhotoTags nothing = TagsOf(none, kOrigin);
  EXPECT_TRUE(std::isnan(nothing.gps->height_m));
  EXPECT_FALSE(nothing.absolute_altitude_m);
  EXPECT_FALSE(nothing.relative_altitude_m);
  for (const survey::PhotoTags& tags : {zeros, nothing}) {
    EXPECT_EQ(tags.gps->latitude_deg, all.gps->latitude_deg);
    EXPECT_EQ(tags.gps->longitude_deg, all.gps->longitude_deg);
  }
}

TEST(TagFaults, SwappedCoordinatesAreInEachOthersPlace) {
  const survey::PhotoTags right = TagsOf(Flight([](SimulateOptions&) {})[5], kOrigin);
  const survey::PhotoTags swapped = TagsOf(Flight([](SimulateOptions& o) { o.tags_swapped = true; })[5], kOrigin);
  EXPECT_EQ(swapped.gps->latitude_deg, right.gps->longitude_deg);
  EXPECT_EQ(swapped.gps->longitude_deg, right.gps->latitude_deg);
  EXPECT_EQ(swapped.gps->height_m, right.gps->height_m);
}

TEST(TagFaults, EqualTagsAreAtTheFirstPlace) {
  const std::vector<PhotoPlan> photos = Flight([](SimulateOptions& o) { o.tags_equal = true; });
  for (const PhotoPlan& photo : photos) EXPECT_LT((photo.tagged_position - photos.front().cam_from_enu.OriginInSource()).norm(), 1e-9);
}

TEST(TagFaults, GimbalTagsMayBeAbsent) {
  for (const PhotoPlan& photo : Flight([](SimulateOptions& o) {
         o.gimbal_tags = false;
         o.gimbal_random_error_deg = 1.0;
       })) {
    EXPECT_FALSE(photo.tagged_gimbal);
    const survey::PhotoTags tags = TagsOf(photo, kOrigin);
    EXPECT_FALSE(tags.gimbal_yaw_deg || tags.gimbal_pitch_deg || tags.gimbal_roll_deg);
  }
}

// The rotation from the true to the tagged camera, as a vector in the true camera's frame, degrees.
Vector3d GimbalError(const PhotoPlan& photo) {
  const GimbalAngles& tagged = *photo.tagged_gimbal;
  const geo::Rigid3d pose = PoseFromGimbal(Vector3d::Zero(), tagged.yaw_deg, tagged.pitch_deg, tagged.roll_deg);
  const Eigen::AngleAxisd turn(pose.rotation * photo.cam_from_enu.rotation.conjugate());
  return kDegrees * turn.angle() * turn.axis();
}

TEST(TagFaults, GimbalErrorsHaveACommonAndARandomPart) {
  Vector3d common_squares = Vector3d::Zero();
  Vector3d random_squares = Vector3d::Zero();
  double n_random = 0.0;
  constexpr int kSeeds = 60;
  const std::vector<PhotoPlan> planned = PlanFlight(Town([](SimulateOptions&) {}), 0.0);
  TagFaults faults;
  faults.gimbal_common_error_deg = 2.0;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    std::vector<PhotoPlan> photos = planned;
    faults.gimbal_random_error_deg = 0.0;
    ApplyTagFaults(faults, seed, photos);
    const Vector3d common = GimbalError(photos.front());
    for (const PhotoPlan& photo : photos) EXPECT_LT((GimbalError(photo) - common).norm(), 1e-6);
    common_squares += common.cwiseAbs2() / kSeeds;
    faults.gimbal_random_error_deg = 0.5;
    ApplyTagFaults(faults, seed, photos);
    for (const PhotoPlan& photo : photos) random_squares += (GimbalError(photo) - common).cwiseAbs2();
    n_random += static_cast<double>(photos.size());
  }
  // The camera does not turn about its axis.
  EXPECT_LT(std::sqrt(common_squares.z()), 1e-6);
  EXPECT_LT(std::sqrt(random_squares.z() / n_random), 1e-6);
  // Accurate to 9 % and 1 %.
  EXPECT_NEAR(std::sqrt(common_squares.x()), 2.0, 0.6);
  EXPECT_NEAR(std::sqrt(common_squares.y()), 2.0, 0.6);
  EXPECT_NEAR(std::sqrt(random_squares.x() / n_random), 0.5, 0.03);
  EXPECT_NEAR(std::sqrt(random_squares.y() / n_random), 0.5, 0.03);
}

TEST(TagFaults, SpeedIsThatOfTheDroneAlongItsLine) {
  const std::vector<PhotoPlan> photos = Flight([](SimulateOptions& o) { o.speed_tags = true; });
  const PlaceSpec place = Town([](SimulateOptions&) {});
  const double spacing = place.altitudes_agl_m.front() * place.camera.height / place.camera.FocalY() * (1.0 - place.forward_overlap);
  const double speed = spacing / (photos[1].time_s - photos[0].time_s);
  for (const PhotoPlan& photo : photos) {
    if (photo.oblique) continue;
    ASSERT_TRUE(photo.tagged_speed_mps);
    // Positions scatter by 0.25 m.
    EXPECT_NEAR(*photo.tagged_speed_mps, speed, 1.0);
    EXPECT_EQ(TagsOf(photo, kOrigin).speed_mps, photo.tagged_speed_mps);
  }
}

TEST(TagFaults, SeedsReproduceAndKindsAreIndependent) {
  const auto everything = [](SimulateOptions& o) {
    o.tag_jump_m = 30.0;
    o.tag_bias_m = 2.0;
    o.tag_outliers = 0.3;
    o.gimbal_common_error_deg = 0.2;
    o.gimbal_random_error_deg = 0.5;
  };
  const std::vector<PhotoPlan> once = Flight(everything);
  const std::vector<PhotoPlan> again = Flight(everything);
  const std::vector<Vector3d> other = Errors(Flight([&](SimulateOptions& o) {
    everything(o);
    o.seed = 2;
  }));
  // Each kind alone gives the same errors as together with others.
  const std::vector<Vector3d> jump = Errors(Flight([](SimulateOptions& o) { o.tag_jump_m = 30.0; }));
  const std::vector<Vector3d> bias = Errors(Flight([](SimulateOptions& o) { o.tag_bias_m = 2.0; }));
  const std::vector<Vector3d> outliers = Errors(Flight([](SimulateOptions& o) { o.tag_outliers = 0.3; }));
  const std::vector<Vector3d> errors = Errors(once);
  for (size_t i = 0; i < once.size(); ++i) {
    EXPECT_TRUE(once[i].tagged_position == again[i].tagged_position);
    EXPECT_EQ(once[i].tagged_gimbal->roll_deg, again[i].tagged_gimbal->roll_deg);
    EXPECT_LT((errors[i] - jump[i] - bias[i] - outliers[i]).norm(), 1e-9);
    EXPECT_GT((errors[i] - other[i]).norm(), 1e-3);
  }
}

TEST(TagFaults, FlightsOfOnePhotoAndNoneAreTaken) {
  TagFaults faults;
  faults.lag_s = 2.0;
  faults.drift_m = 100.0;
  faults.jump_m = 5.0;
  faults.outlier_share = 0.5;
  faults.gimbal_random_error_deg = 1.0;
  faults.speed_tags = true;
  std::vector<PhotoPlan> photos;
  ApplyTagFaults(faults, 1, photos);
  EXPECT_TRUE(photos.empty());
  photos = PlanFlight(Town([](SimulateOptions&) {}), 0.0);
  photos.resize(1);
  ApplyTagFaults(faults, 1, photos);
  EXPECT_TRUE(photos[0].tagged_position.allFinite());
  EXPECT_FALSE(photos[0].tagged_speed_mps);
}

}  // namespace
}  // namespace skyquilt::simulate
