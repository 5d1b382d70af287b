#include "prepare/georeference/checks/flight_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "prepare/bundle/intrinsics_sigma.h"
#include "prepare/georeference/checks/flight_speed.h"
#include "prepare/georeference/checks/shutter_table.h"
#include "prepare/georeference/dome_fit.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kDomeSigmas = 3.0;
constexpr double kMinDome_m = 1.0;
constexpr double kMinDomeShareOfAgl = 0.01;
constexpr const char* kTagged = "speed tags";

double MedianTaggedSpeed(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<double> speeds;
  for (const input::PreparedPhoto& photo : photos) {
    const std::optional<double>& speed_mps = photo.file.tags.speed_mps;
    if (speed_mps && std::isfinite(*speed_mps) && *speed_mps >= 0.0) speeds.push_back(*speed_mps);
  }
  return base::Median(speeds);
}

// The name that most photos of a camera have.
std::string NameOfCamera(const survey::Survey& survey, const std::vector<input::PreparedPhoto>& photos, int camera) {
  std::map<std::string, int> count;
  for (size_t i = 0; i < photos.size(); ++i) {
    const survey::PhotoTags& tags = photos[i].file.tags;
    if (survey.photos[i].camera == camera) ++count[CameraName(tags.make, tags.model)];
  }
  const auto most = std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == count.end() ? "" : most->first;
}

std::optional<double> MedianExposure(const survey::Survey& survey, int camera) {
  std::vector<double> exposures;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.camera == camera && photo.exposure.time_s) exposures.push_back(*photo.exposure.time_s);
  }
  if (exposures.empty()) return std::nullopt;
  return base::Median(exposures);
}

// Differences of heights at the tags that agree with the fit, in the order of time; photos without time last, in name order.
std::vector<HeightDifference> HeightDifferences(const survey::Survey& survey) {
  std::vector<const survey::Photo*> photos;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.gps && photo.gps_inlier) photos.push_back(&photo);
  }
  const auto time = [](const survey::Photo* photo) { return photo->time_s.value_or(std::numeric_limits<double>::infinity()); };
  std::stable_sort(photos.begin(), photos.end(), [&](const auto* a, const auto* b) { return time(a) < time(b); });
  const geo::EnuFrame frame(survey.origin);
  std::vector<HeightDifference> differences;
  differences.reserve(photos.size());
  for (const survey::Photo* photo : photos) {
    if (!std::isfinite(photo->gps->height_m)) continue;
    const Eigen::Vector3d centre = photo->cam_from_enu.OriginInSource();
    const Eigen::Vector3d tagged = frame.EnuFromGeodetic(*photo->gps) + photo->gps_correction_m;
    differences.push_back({centre.head<2>(), centre.z() - tagged.z()});
  }
  return differences;
}

void CheckSmear(const survey::Survey& survey, const std::vector<input::PreparedPhoto>& photos, int camera_index, survey::FlightChecks& checks) {
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(camera_index)];
  checks.speed_mps = MedianTaggedSpeed(photos);
  if (std::isfinite(checks.speed_mps)) {
    checks.speed_source = kTagged;
  } else if (survey.georeferenced) {
    checks.speed_mps = SpeedFromPositions(survey);
    if (std::isfinite(checks.speed_mps)) checks.speed_source = "positions and times";
  }
  checks.camera_name = NameOfCamera(survey, photos, camera_index);
  checks.readout_ms = SensorReadout({checks.camera_name, camera.width, camera.height, MedianExposure(survey, camera_index)});
  const double agl_m = survey.MedianAgl();
  if (!survey.georeferenced || !(agl_m > 0.0)) return;
  const double smear_px = checks.speed_mps * 1e-3 * checks.readout_ms / camera::GroundSamplingDistance(camera, agl_m);
  if (std::isfinite(smear_px)) checks.smear_px = smear_px;
}

survey::Problem RollingShutterProblem(const survey::FlightChecks& checks) {
  const bool tagged = checks.speed_source == kTagged;
  return {
      "rolling_shutter",
      fmt::format("The camera ({}) reads its sensor in {:.3g} ms; at {:.1f} m/s ({}) the ground moves {:.1f} pixels meanwhile, and the poses do not "
                  "model this",
                  checks.camera_name, checks.readout_ms, checks.speed_mps, tagged ? "from the speed tags" : "mean between photos", checks.smear_px),
      fmt::format("{} errors of about this size in positions and details; next time fly slower or higher, stop for each photo, or use a camera "
                  "with a mechanical or global shutter",
                  tagged ? "Expect" : "If the drone stopped for each photo, ignore this. Otherwise expect")};
}

survey::Problem DomingProblem(const survey::FlightChecks& checks) {
  return {"doming",
          fmt::format("The reconstruction is bent against the GPS heights: its middle is {:.1f} m too {} compared with its edge (sigma {:.1f} m)",
                      std::abs(checks.dome_m), checks.dome_m > 0.0 ? "high" : "low", checks.dome_sigma_m),
          "Unless the GPS heights drifted, do not trust heights to better than this. The tags did not straighten it; control points may (--gcp), "
          "or a lens calibrated beforehand and held fixed; next time add photos that look 10 degrees or more off nadir, or lines "
          "across at another flying height"};
}

survey::Problem LensProblem(const survey::FlightChecks& checks, double shift_px) {
  return {
      "lens_uncertain",
      fmt::format("The photos hardly determine the lens distortion: k1 is {:.4f} with a sigma of {:.2g}, which moves the image corner by {}; the "
                  "reconstruction may be bent",
                  checks.k1, checks.k1_sigma, shift_px > 100.0 ? "more than 100 pixels" : fmt::format("{:.1f} pixels", shift_px)),
      "Compare heights with control points before you trust them. Use a lens calibrated beforehand and held fixed; next time add photos that look "
      "10 degrees or more off nadir, or lines across at another flying height"};
}

std::string Number(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "unknown";
}

}  // namespace

int MainCamera(const survey::Survey& survey) {
  std::vector<int> n_photos(survey.cameras.size(), 0);
  for (const survey::Photo& photo : survey.photos) ++n_photos[static_cast<size_t>(photo.camera)];
  const auto most = std::max_element(n_photos.begin(), n_photos.end());
  return most == n_photos.end() || *most == 0 ? -1 : static_cast<int>(most - n_photos.begin());
}

survey::FlightChecks CheckFlight(const survey::Survey& survey, const std::vector<input::PreparedPhoto>& photos) {
  SKYQUILT_CHECK(photos.size() == survey.photos.size(), fmt::format("{} prepared of {} photos", photos.size(), survey.photos.size()));
  survey::FlightChecks checks;
  const int camera_index = MainCamera(survey);
  if (camera_index < 0) return checks;
  CheckSmear(survey, photos, camera_index, checks);
  if (survey.georeferenced) {
    const Dome dome = FitDome(HeightDifferences(survey));
    checks.dome_m = dome.height_m;
    checks.dome_sigma_m = dome.sigma_m;
  }
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(camera_index)];
  const int k1_index = bundle::RadialParameterIndex(camera.model);
  if (k1_index >= 0) checks.k1 = camera.params[static_cast<size_t>(k1_index)];
  return checks;
}

std::vector<survey::Problem> FlightProblems(const survey::FlightChecks& checks, const survey::Survey& survey) {
  std::vector<survey::Problem> problems;
  const double dome_m = std::abs(checks.dome_m);
  const double agl_m = survey.MedianAgl();
  const double least_m = std::max(kMinDome_m, std::isfinite(agl_m) ? kMinDomeShareOfAgl * agl_m : 0.0);
  if (dome_m > kDomeSigmas * checks.dome_sigma_m && dome_m > least_m) problems.push_back(DomingProblem(checks));
  if (checks.smear_px > kMaxSmear_px) problems.push_back(RollingShutterProblem(checks));
  const int camera_index = MainCamera(survey);
  if (camera_index >= 0) {
    const double shift_px = CornerShift(survey.cameras[static_cast<size_t>(camera_index)], checks.k1_sigma);
    if (shift_px > kMaxCornerShift_px) problems.push_back(LensProblem(checks, shift_px));
  }
  return problems;
}

double CornerShift(const camera::Camera& camera, double change) {
  if (bundle::RadialParameterIndex(camera.model) < 0) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d middle = camera.PrincipalPoint();
  const Eigen::Vector2d corner(middle.x() > 0.5 * camera.width ? 0.0 : camera.width, middle.y() > 0.5 * camera.height ? 0.0 : camera.height);
  const Eigen::Vector3d ray = camera.RayFromImg(corner);
  // k1 multiplies the cube of the ideal radius (perspective) or of the angle from the axis (fisheye).
  const bool fisheye = camera::IsFisheye(camera.model);
  const double radius = fisheye ? std::atan2(ray.head<2>().norm(), ray.z()) : ray.head<2>().norm() / ray.z();
  return std::sqrt(camera.FocalX() * camera.FocalY()) * std::abs(change) * radius * radius * radius;
}

std::string DescribeChecks(const survey::FlightChecks& checks) {
  const std::string dome = std::isfinite(checks.dome_m) ? fmt::format("{:+.2f} +- {:.2f} m", checks.dome_m, checks.dome_sigma_m) : "unknown";
  const std::string k1 = std::isfinite(checks.k1) ? fmt::format("{:.5f} +- {}", checks.k1, Number(checks.k1_sigma, "{:.2g}")) : "none";
  return fmt::format("flight checks: speed {}{}, read-out {}{}, smear {}, dome {}, lens k1 {}", Number(checks.speed_mps, "{:.1f} m/s"),
                     checks.speed_source.empty() ? "" : " (" + checks.speed_source + ")", Number(checks.readout_ms, "{:.3g} ms"),
                     checks.camera_name.empty() ? "" : " (" + checks.camera_name + ")", Number(checks.smear_px, "{:.1f} px"), dome, k1);
}

}  // namespace skyquilt::prepare::georeference
