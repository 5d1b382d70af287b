#include "bench/numerics/fault_survey.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "simulate/flight.h"
#include "simulate/model_frame.h"
#include "simulate/place_spec.h"
#include "simulate/survey_writer.h"
#include "simulate/tag_faults.h"
#include "simulate/terrain.h"

namespace skyquilt::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr int kPoints = 2000;

// Rolling or sloping ground, a third of the points on houses and trees.
std::vector<Vector3d> MakePoints(const simulate::PlaceSpec& place, base::Random& random) {
  const Vector2d rise = simulate::HillsideRise(place.hillside_deg);
  const Vector2d middle = 0.5 * (place.area_min + place.area_max);
  std::vector<Vector3d> points;
  points.reserve(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double at_y = random.Uniform(place.area_min.y(), place.area_max.y()), at_x = random.Uniform(place.area_min.x(), place.area_max.x());
    const Vector2d at(at_x, at_y);
    const double ground_m = simulate::RollingHeight(at.x(), at.y(), place.terrain_amplitude_m, place.seed + 1U) + rise.dot(at - middle);
    const double above_m = random.UniformDouble() < 1.0 / 3.0 ? random.Uniform(0.0, 12.0) : 0.0;
    points.emplace_back(at.x(), at.y(), ground_m + above_m + 0.1 * random.Normal());
  }
  return points;
}

// Poses and tags as PlanFlight makes them, with all cameras turned alike.
std::vector<simulate::PhotoPlan> Fly(const simulate::PlaceSpec& place, double camera_tilt_deg, base::Random& random) {
  std::vector<simulate::PhotoPlan> photos = simulate::PlanFlight(place, 0.0);
  const double sigma = camera_tilt_deg / kDegreesPerRadian;
  const double about_x = sigma * random.Normal(), about_y = sigma * random.Normal();
  const Eigen::Quaterniond mounting(Eigen::AngleAxisd(about_x, Vector3d::UnitX()) * Eigen::AngleAxisd(about_y, Vector3d::UnitY()));
  for (simulate::PhotoPlan& photo : photos) {
    const Vector3d centre = photo.cam_from_enu.OriginInSource();
    photo.cam_from_enu.rotation = (mounting * photo.cam_from_enu.rotation).normalized();
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * centre);
    const simulate::GimbalAngles angles = simulate::GimbalFromPose(photo.cam_from_enu);
    photo.yaw_deg = angles.yaw_deg;
    photo.pitch_deg = angles.pitch_deg;
    photo.roll_deg = angles.roll_deg;
    if (photo.tagged_gimbal) photo.tagged_gimbal = angles;
  }
  simulate::ApplyTagFaults(place.tag_faults, place.seed, photos);
  return photos;
}

}  // namespace

FaultSurvey MakeFaultSurvey(const simulate::SimulateOptions& options, double camera_tilt_deg) {
  const simulate::PlaceSpec place = simulate::ResolvePlace(options);
  base::Random random(place.seed, 77);
  FaultSurvey survey;
  survey.origin = {options.latitude_deg, geo::WrapLongitudeDeg(options.longitude_deg), options.height_m};
  const geo::EnuFrame frame(survey.origin);
  const geo::Similarity3d model_from_enu = simulate::RandomModelFrame(place.seed);
  survey.enu_from_model = simulate::Inverse(model_from_enu);
  for (const simulate::PhotoPlan& photo : Fly(place, camera_tilt_deg, random)) {
    const geo::Rigid3d cam_from_model = geo::TransformCameraWorld(photo.cam_from_enu, model_from_enu);
    survey.photos.push_back(prepare::input::PreparePhoto({.name = photo.name, .tags = simulate::MakeTags(photo, place.camera, frame)},
                                                         survey.photos.size(), cam_from_model));
  }
  for (const Vector3d& x : MakePoints(place, random)) survey.points.push_back(model_from_enu * x);
  return survey;
}

simulate::SimulateOptions RandomFaults(uint64_t seed) {
  base::Random random(seed, 78);
  const auto happens = [&](double share) { return random.UniformDouble() < share; };
  simulate::SimulateOptions options;
  options.seed = static_cast<int>(seed);
  options.place = happens(0.7) ? "town" : "tidalflat";
  options.latitude_deg = random.Uniform(-75.0, 75.0);
  options.longitude_deg = random.Uniform(-180.0, 180.0);
  options.height_m = random.Uniform(-400.0, 4000.0);
  options.altitudes = {random.Uniform(60.0, 140.0)};
  options.oblique = happens(0.5);
  options.gps_noise_m = random.Uniform(0.5, 3.0);
  options.exact_frame = false;
  // What the geo-reference assumes of receivers without a stated accuracy.
  options.tag_bias_m = 1.5;
  if (happens(0.5)) options.tag_lag_s = random.Uniform(-0.5, 3.0);
  if (happens(0.4)) options.tag_drift_m = random.Uniform(-100.0, 100.0);
  if (happens(0.15)) options.tag_jump_m = random.Uniform(5.0, 60.0);
  if (happens(0.25)) options.tag_outliers = random.Uniform(0.05, 1.0 / 3.0);
  if (happens(0.12)) options.tag_heights = happens(0.6) ? "zero" : "none";
  options.gimbal_tags = happens(0.5);
  options.gimbal_common_error_deg = 0.2;
  options.gimbal_random_error_deg = 0.5;
  if (happens(0.1)) options.single_line = true;
  if (options.place == "town" && happens(0.4)) options.hillside_deg = random.Uniform(2.0, 10.0);
  return options;
}

PlaceErrors FindPlace(const FaultSurvey& survey, const prepare::georeference::PlaceOptions& options) {
  const prepare::georeference::Georeference found = prepare::georeference::PlaceOnEarth(survey.photos, survey.points, options);
  PlaceErrors errors{.georeferenced = found.ok, .sigma = found.fit.accuracy, .lag_s = found.fit.tag_lag_s};
  for (const survey::Problem& problem : found.problems) errors.problems.push_back(problem.code);
  if (!found.ok) return errors;
  // Both frames are Cartesian, so one turns into the other by a rotation and a shift.
  const geo::EnuFrame truth(survey.origin), fitted(found.origin);
  const auto convert = [&](const Vector3d& x) { return fitted.EnuFromGeodetic(truth.GeodeticFromEnu(x)); };
  constexpr double kArm_m = 1000.0;
  const Vector3d shift = convert(Vector3d::Zero());
  Eigen::Matrix3d turn;
  for (int axis = 0; axis < 3; ++axis) turn.col(axis) = (convert(kArm_m * Vector3d::Unit(axis)) - shift) / kArm_m;
  const Eigen::Matrix3d wanted = turn * survey.enu_from_model.rotation.toRotationMatrix();
  const Eigen::Matrix3d error = found.enu_from_model.rotation.toRotationMatrix() * wanted.transpose();
  errors.tilt_deg = kDegreesPerRadian * std::atan2(error.col(2).head<2>().norm(), error(2, 2));
  errors.yaw_deg = kDegreesPerRadian * std::abs(std::atan2(error(1, 0) - error(0, 1), error(0, 0) + error(1, 1)));
  errors.scale_percent = 100.0 * std::abs(std::log(found.enu_from_model.scale / survey.enu_from_model.scale));
  Vector3d middle = Vector3d::Zero();
  for (const prepare::input::PreparedPhoto& photo : survey.photos)
    middle += photo.cam_from_model.OriginInSource() / static_cast<double>(survey.photos.size());
  const Vector3d offset = found.enu_from_model * middle - convert(survey.enu_from_model * middle);
  errors.horizontal_m = offset.head<2>().norm();
  errors.vertical_m = std::abs(offset.z());
  return errors;
}

}  // namespace skyquilt::bench
