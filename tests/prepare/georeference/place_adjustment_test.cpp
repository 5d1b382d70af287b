#include "prepare/georeference/place_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kPhotos = 60;
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kGravitySigma_deg = 0.2;  // per axis
constexpr double kHorizontalNoise_m = 2.0, kVerticalNoise_m = 3.0;

// A lawnmower flight in a model frame with exact tags and gravity.
struct Problem {
  geo::Similarity3d model_from_enu{0.08, Eigen::Quaterniond(0.6, -0.3, 0.5, 0.2).normalized(), Vector3d(3.0, -2.0, 1.0)};
  std::vector<input::PreparedPhoto> photos = test::LawnmowerPhotos(kPhotos, model_from_enu);
  Track track{photos, std::vector<int>(kPhotos, 0)};
  Gravity gravity;
  std::vector<Tag> tags;
  HeightBias bias;
  BiasSigmas bias_sigmas;
  double lag_sigma_s = 0.0;

  explicit Problem(double lag_s = 0.0) {
    gravity.up = model_from_enu.rotation * Vector3d::UnitZ();
    gravity.information = (Matrix3d::Identity() - gravity.up * gravity.up.transpose()) / std::pow(kGravitySigma_deg * kRadiansPerDegree, 2);
    for (size_t i = 0; i < photos.size(); ++i) tags.push_back({.photo = i, .x_in_enu = EnuFromModel() * track.Before(i, lag_s).position});
  }
  geo::Similarity3d EnuFromModel() const {
    const Eigen::Quaterniond rotation = model_from_enu.rotation.conjugate();
    return {1.0 / model_from_enu.scale, rotation, -(rotation * model_from_enu.translation) / model_from_enu.scale};
  }
  Vector3d Middle() const {
    Vector3d middle = Vector3d::Zero();
    for (const input::PreparedPhoto& photo : photos) middle += photo.cam_from_model.OriginInSource() / static_cast<double>(photos.size());
    return middle;
  }
  void AddNoise(base::Random& random) {
    for (Tag& tag : tags) {
      const double horizontal_m = kHorizontalNoise_m / 3.0 * tag.horizontal_sigma_m, vertical_m = kVerticalNoise_m / 4.5 * tag.vertical_sigma_m;
      const double up = vertical_m * random.Normal(), north = horizontal_m * random.Normal(), east = horizontal_m * random.Normal();
      tag.x_in_enu += Vector3d(east, north, up);
    }
    const double turn_z = random.Normal(), turn_y = random.Normal(), turn_x = random.Normal();
    const Vector3d turn(turn_x, turn_y, turn_z);
    gravity.up = (gravity.up + kGravitySigma_deg * kRadiansPerDegree * turn.cross(gravity.up)).normalized();
  }
  // From a start that is off by a degree, 2 % and a few metres.
  Adjustment Solve() const {
    geo::Similarity3d start = EnuFromModel();
    start.scale *= 1.02;
    start.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(1.0 * kRadiansPerDegree, Vector3d(0.5, -0.5, 0.7).normalized())) * start.rotation;
    start.translation = EnuFromModel() * Middle() + Vector3d(2.0, -1.0, 3.0) - start.scale * (start.rotation * Middle());
    return Adjust({.track = track,
                   .gravity = gravity,
                   .tags = tags,
                   .bias = bias,
                   .bias_sigmas = bias_sigmas,
                   .middle_in_model = Middle(),
                   .threshold_m = 100.0,
                   .lag_sigma_s = lag_sigma_s},
                  {start, 0.0, Eigen::VectorXd::Zero(bias.size())});
  }
  // Rotation vector about east, north and up from the result to the truth, log of the scale, position of the middle.
  Eigen::Matrix<double, 7, 1> ErrorOf(const Adjustment& result) const {
    const Eigen::AngleAxisd turn(EnuFromModel().rotation * result.enu_from_model.rotation.conjugate());
    Eigen::Matrix<double, 7, 1> error;
    const double angle = std::remainder(turn.angle(), 2.0 * std::numbers::pi);
    error << angle * turn.axis(), std::log(EnuFromModel().scale / result.enu_from_model.scale),
        EnuFromModel() * Middle() - result.enu_from_model * Middle();
    return error;
  }
};

TEST(Adjust, ExactTagsGiveTheExactPlaceAndLag) {
  for (const double lag_s : {0.0, 1.7, -0.6}) {
    Problem problem(lag_s);
    problem.lag_sigma_s = lag_s == 0.0 ? 0.0 : 1e4;
    const Adjustment result = problem.Solve();
    EXPECT_LT(problem.ErrorOf(result).norm(), 1e-6) << lag_s;
    EXPECT_NEAR(result.lag_s, lag_s, 1e-6);
    EXPECT_EQ(std::count(result.inlier.begin(), result.inlier.end(), 1), kPhotos);
  }
}

TEST(Adjust, ThePriorHoldsALagThatTagsDoNotTell) {
  Problem problem(1.0);
  problem.lag_sigma_s = 1e-4;
  EXPECT_NEAR(problem.Solve().lag_s, 0.0, 0.02);
}

TEST(Adjust, StatedAccuracyIsThatOfRepeatedFits) {
  constexpr int kDraws = 120;
  Eigen::Matrix<double, 7, 1> errors = Eigen::Matrix<double, 7, 1>::Zero(), stated = errors;
  double lag_errors = 0.0, lag_stated = 0.0;
  for (int draw = 1; draw <= kDraws; ++draw) {
    base::Random random(static_cast<uint64_t>(draw));
    const double lag_s = 0.5 * random.Normal();
    Problem problem(lag_s);
    problem.lag_sigma_s = 1.5;
    problem.AddNoise(random);
    const Adjustment result = problem.Solve();
    errors += problem.ErrorOf(result).cwiseAbs2();
    stated += result.covariance.diagonal().head<7>();
    lag_errors += std::pow(result.lag_s - lag_s, 2);
    lag_stated += result.covariance(7, 7);
  }
  const auto ratio = [](double error, double accuracy) { return std::sqrt(error / accuracy); };
  const std::array<std::pair<const char*, double>, 6> ratios = {{{"tilt", ratio(errors.head<2>().sum(), stated.head<2>().sum())},
                                                                 {"yaw", ratio(errors[2], stated[2])},
                                                                 {"scale", ratio(errors[3], stated[3])},
                                                                 {"position", ratio(errors.segment<2>(4).sum(), stated.segment<2>(4).sum())},
                                                                 {"height", ratio(errors[6], stated[6])},
                                                                 {"lag", ratio(lag_errors, lag_stated)}}};
  for (const auto& [name, value] : ratios) {
    EXPECT_GT(value, 0.8) << name;
    EXPECT_LT(value, 1.25) << name;
  }
}

TEST(Adjust, TagsOfStatedPoorAccuracyDoNotSpoilTheOthers) {
  double mixed = 0.0, good_alone = 0.0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    base::Random random(seed);
    Problem problem;
    for (size_t k = 0; k < problem.tags.size(); k += 2) {
      problem.tags[k].horizontal_sigma_m *= 10.0;
      problem.tags[k].vertical_sigma_m *= 10.0;
    }
    problem.AddNoise(random);
    mixed += problem.ErrorOf(problem.Solve()).tail<3>().squaredNorm();
    std::erase_if(problem.tags, [](const Tag& tag) { return tag.horizontal_sigma_m > 5.0; });
    good_alone += problem.ErrorOf(problem.Solve()).tail<3>().squaredNorm();
  }
  EXPECT_LT(std::sqrt(mixed / good_alone), 1.15);
}

TEST(Adjust, TagsFarOffAreNamedAndLoseTheirWeight) {
  Problem problem;
  base::Random random(3);
  problem.AddNoise(random);
  for (size_t k = 0; k < problem.tags.size(); k += 4) problem.tags[k].x_in_enu += Vector3d(k % 8 == 0 ? 150.0 : 0.0, 0.0, k % 8 == 0 ? 0.0 : 150.0);
  const Adjustment result = problem.Solve();
  for (size_t k = 0; k < problem.tags.size(); ++k) EXPECT_EQ(result.inlier[k] == 0, k % 4 == 0) << k;
  EXPECT_LT(problem.ErrorOf(result).tail<3>().norm(), 2.0);
  EXPECT_NEAR(3.0 * result.horizontal_noise, kHorizontalNoise_m, 0.5);
  EXPECT_NEAR(4.5 * result.vertical_noise, kVerticalNoise_m, 1.0);
}

TEST(Adjust, ADriftOfHeightsGoesIntoTheBias) {
  Problem problem;
  std::vector<double> phase;
  for (size_t i = 0; i < kPhotos; ++i) {
    phase.push_back(problem.track.Phase(i));
    problem.tags[i].x_in_enu.z() += 40.0 * phase.back();
  }
  problem.bias = HeightBias(std::vector<int>(kPhotos, 0), phase, 0);
  problem.bias_sigmas = {.offset_m = 1.0, .drift_m = 100.0, .wander_m = 0.0};
  const Adjustment result = problem.Solve();
  EXPECT_LT(problem.ErrorOf(result).head<2>().norm(), 0.05 * kRadiansPerDegree);
  for (size_t k = 0; k < kPhotos; ++k) EXPECT_NEAR(result.bias_m[k], 40.0 * phase[k], 0.3);
}

TEST(Adjust, TellsWhatTheTagsAloneSayOfTheTilt) {
  Problem problem;
  base::Random random(4);
  for (Tag& tag : problem.tags) {
    const double up = random.Normal(), north = random.Normal(), east = random.Normal();
    tag.x_in_enu += 0.5 * Vector3d(east, north, up);
  }
  // Gravity is off by a degree: the result stays with it in part, the tags alone do not.
  const Vector3d off_in_enu = Eigen::AngleAxisd(1.0 * kRadiansPerDegree, Vector3d::UnitY()) * Vector3d::UnitZ();
  problem.gravity.up = problem.model_from_enu.rotation * off_in_enu;
  problem.gravity.information *= 4.0;
  const Adjustment result = problem.Solve();
  const Eigen::Vector2d missing = problem.ErrorOf(result).head<2>();
  EXPECT_GT(missing.norm(), 0.2 * kRadiansPerDegree);
  const Eigen::Vector2d rest = result.tags_rotation - missing;
  EXPECT_LT(rest.dot(result.tags_covariance.inverse() * rest), 9.0);
  EXPECT_LT(rest.norm(), 0.25 * missing.norm());

  for (Tag& tag : problem.tags) tag.x_in_enu.z() = std::numeric_limits<double>::quiet_NaN();
  const Adjustment without = problem.Solve();
  EXPECT_FALSE(without.tags_covariance.trace() < 1e3 * result.tags_covariance.trace());  // horizontally a tilt only shortens
  EXPECT_TRUE(without.covariance.allFinite());
  EXPECT_TRUE(without.enu_from_model.translation.allFinite());
  EXPECT_EQ(std::count(without.inlier.begin(), without.inlier.end(), 1), kPhotos);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
