#include "simulate/flight.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "simulate/flights/flight_settings.h"
#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPhotoInterval_s = 2.0;
constexpr double kObliquePitch_deg = -60.0;

double Radians(double deg) {
  return deg * std::numbers::pi / 180.0;
}

double Degrees(double rad) {
  return rad * 180.0 / std::numbers::pi;
}

struct Station {
  Vector2d position;
  double altitude_m;
  double yaw_deg;
  double pitch_deg;
  int line;
};

// Positions with this spacing, centred on [low, high]; they may extend a little beyond it.
std::vector<double> Spread(double low, double high, double spacing) {
  const int n = std::max(1, static_cast<int>(std::lround((high - low) / spacing)) + 1);
  std::vector<double> at;
  at.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) at.push_back(0.5 * (low + high) + (i - 0.5 * (n - 1)) * spacing);
  return at;
}

// Northings of the photos of a nadir line, from the south.
std::vector<double> AlongLine(const PlaceSpec& place, double south, double north, double altitude_m) {
  const double along = altitude_m * place.camera.height / place.camera.FocalY() * (1.0 - place.forward_overlap);
  return Spread(south + place.flight_inset_m, north - place.flight_inset_m, along);
}

void AddNadirLines(const PlaceSpec& place, const Vector2d& min, const Vector2d& max, double altitude_m, int* line, std::vector<Station>* stations) {
  const double across = altitude_m * place.camera.width / place.camera.FocalX() * (1.0 - place.side_overlap);
  const double inset = place.flight_inset_m;
  bool north = true;
  for (const double x : Spread(min.x() + inset, max.x() - inset, across)) {
    std::vector<double> ys = AlongLine(place, min.y(), max.y(), altitude_m);
    if (!north) std::reverse(ys.begin(), ys.end());
    for (const double y : ys) stations->push_back({{x, y}, altitude_m, north ? 0.0 : 180.0, -90.0, *line});
    ++*line;
    north = !north;
  }
}

// Along the edges, looking inwards; the optical axis hits the ground a quarter of the way into the area.
void AddObliqueLines(const PlaceSpec& place, double altitude_m, int* line, std::vector<Station>* stations) {
  const double slant = altitude_m / std::sin(Radians(-kObliquePitch_deg));
  const double spacing = slant * place.camera.width / place.camera.FocalX() * (1.0 - place.oblique_overlap);
  const double back = altitude_m / std::tan(Radians(-kObliquePitch_deg));
  const Vector2d centre = 0.5 * (place.area_min + place.area_max);
  const Vector2d half = 0.5 * (place.area_max - place.area_min);
  constexpr std::array<double, 4> kYaw = {0.0, 180.0, 90.0, 270.0};
  for (int i = 0; i < std::min(place.oblique_lines, 4); ++i) {
    const double yaw = kYaw[static_cast<size_t>(i)];
    const Vector2d forward(std::sin(Radians(yaw)), std::cos(Radians(yaw)));
    const Vector2d right(forward.y(), -forward.x());
    const double half_depth = std::abs(forward.dot(half));
    const double half_breadth = std::abs(right.x() * half.x()) + std::abs(right.y() * half.y());
    for (const double s : Spread(-half_breadth, half_breadth, spacing)) {
      const Vector2d at = centre - forward * (0.5 * half_depth + back) + right * s;
      stations->push_back({at, altitude_m, yaw, kObliquePitch_deg, *line});
    }
    ++*line;
  }
}

std::vector<Station> PlanStations(const PlaceSpec& place) {
  std::vector<Station> stations;
  int line = 0;
  const std::vector<double>& altitudes = place.altitudes_agl_m;
  double mean = 0.0;
  for (const double altitude : altitudes) mean += altitude / static_cast<double>(altitudes.size());
  if (place.single_line) {
    const double middle = 0.5 * (place.area_min.x() + place.area_max.x());
    for (const double y : AlongLine(place, place.area_min.y(), place.area_max.y(), mean)) stations.push_back({{middle, y}, mean, 0.0, -90.0, line});
    return stations;
  }
  if (std::all_of(altitudes.begin(), altitudes.end(), [&](double a) { return a == altitudes.front(); })) {
    AddNadirLines(place, place.area_min, place.area_max, altitudes.front(), &line, &stations);
  } else {
    const Vector2d block = (place.area_max - place.area_min).cwiseQuotient(Vector2d(place.columns, place.rows));
    for (int row = 0; row < place.rows; ++row) {
      for (int column = 0; column < place.columns; ++column) {
        const Vector2d min = place.area_min + block.cwiseProduct(Vector2d(column, row));
        AddNadirLines(place, min, min + block, altitudes[static_cast<size_t>(row) * static_cast<size_t>(place.columns) + static_cast<size_t>(column)],
                      &line, &stations);
      }
    }
  }
  AddObliqueLines(place, mean, &line, &stations);
  return stations;
}

// Slow noise in [-1, 1], independent after about ten photos.
double SlowNoise(size_t photo, uint32_t noise_seed) {
  const auto noise = static_cast<double>(ValueNoise(static_cast<float>(photo) / 9.0F, 0.5F, noise_seed));
  return std::clamp(1.5 * noise, -1.0, 1.0);
}

// Stops relative to the survey's exposure for every photo: a slow drift plus a jump every few photos.
std::vector<double> ExposureStops(const PlaceSpec& place, size_t n_photos) {
  base::Random random(place.seed, 51);
  const auto noise_seed = random.NextU32();
  std::vector<double> stops;
  double jump = 0.0;
  int until_jump = 5 + static_cast<int>(random.Below(6));
  for (size_t i = 0; i < n_photos; ++i) {
    if (until_jump-- == 0) {
      jump = random.Uniform(-1.0, 1.0);
      until_jump = 6 + static_cast<int>(random.Below(10));
    }
    stops.push_back(place.exposure_drift_stops * SlowNoise(i, noise_seed) + place.exposure_jumps_stops * jump);
  }
  return stops;
}

void SetExposure(double stops, PhotoPlan& photo) {
  constexpr double kNormalTime_s = 1.0 / 800.0;
  photo.iso = stops > 1.0 ? 200.0 : 100.0;
  const double wanted = kNormalTime_s * std::exp2(stops) * 100.0 / photo.iso;
  // Cameras tag short exposure times as 1/n and long ones in hundredths of a second. Rounding to these makes the tag exact.
  const double n = std::round(1.0 / wanted);
  photo.exposure_time_s = n >= 10.0 ? 1.0 / n : std::round(100.0 * wanted) / 100.0;
}

double Exposure(const PhotoPlan& photo) {
  return photo.exposure_time_s * photo.iso / (100.0 * photo.f_number * photo.f_number);
}

// Sets the gains by the camera's settings and the true gains, which include errors that no tag records.
void SetLight(const PlaceSpec& place, std::vector<PhotoPlan>& photos) {
  std::vector<double> exposure;
  exposure.reserve(photos.size());
  for (const PhotoPlan& photo : photos) exposure.push_back(Exposure(photo));
  const double median = base::Median(exposure);
  base::Random random(place.seed, 52);
  const uint32_t color_seed = base::Random(place.seed, 53).NextU32();
  for (size_t i = 0; i < photos.size(); ++i) {
    PhotoPlan& photo = photos[i];
    photo.gain = exposure[i] / median;
    // Normal exposure is that of the median photo without the offset.
    photo.development_gain = photo.gain * std::exp2(place.exposure_offset_stops + place.exposure_error_stops * random.Normal());
    photo.color_drift_stops = place.color_drift_stops * SlowNoise(i, color_seed);
  }
}

}  // namespace

std::array<double, 3> LightRgb(const PhotoPlan& photo) {
  return {photo.development_gain * std::exp2(photo.color_drift_stops), photo.development_gain,
          photo.development_gain * std::exp2(-photo.color_drift_stops)};
}

geo::Rigid3d PoseFromGimbal(const Vector3d& position, double yaw_deg, double pitch_deg, double roll_deg) {
  const double yaw = Radians(yaw_deg);
  const double pitch = Radians(pitch_deg);
  const Vector3d forward(std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch));
  const Vector3d level(std::cos(yaw), -std::sin(yaw), 0.0);
  const Eigen::AngleAxisd roll(Radians(roll_deg), forward);
  const Vector3d right = roll * level;
  Eigen::Matrix3d enu_from_cam;
  enu_from_cam.col(0) = right;
  enu_from_cam.col(1) = forward.cross(right);
  enu_from_cam.col(2) = forward;
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(Eigen::Matrix3d(enu_from_cam.transpose())).normalized();
  pose.translation = -(pose.rotation * position);
  return pose;
}

GimbalAngles GimbalFromPose(const geo::Rigid3d& cam_from_enu) {
  const Eigen::Matrix3d enu_from_cam = cam_from_enu.rotation.normalized().toRotationMatrix().transpose();
  const Vector3d right = enu_from_cam.col(0);
  const Vector3d forward = enu_from_cam.col(2);
  // Unlike an arcsine, this is accurate near -90 degrees too. Roll is measured from the horizontal that belongs to this yaw, so an uncertain yaw is
  // made up for.
  const double pitch = std::atan2(forward.z(), forward.head<2>().norm());
  const double yaw = std::atan2(forward.x(), forward.y());
  const Vector3d level(std::cos(yaw), -std::sin(yaw), 0.0);
  const double roll = std::atan2(forward.cross(level).dot(right), level.dot(right));
  return {Degrees(yaw), Degrees(pitch), Degrees(roll)};
}

std::string PhotoName(size_t index) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "IMG_%04zu.jpg", index + 1);
  return name.data();
}

void PlacePhoto(const PlaceSpec& place, double takeoff_z_m, const Vector3d& position, base::Random& random, PhotoPlan& photo) {
  photo.cam_from_enu = PoseFromGimbal(position, photo.yaw_deg, photo.pitch_deg, photo.roll_deg);
  const double noise = place.gps_noise_m;
  const double gps_error_z = 1.5 * noise * random.Normal(), gps_error_y = noise * random.Normal(), gps_error_x = noise * random.Normal();
  const Vector3d gps_error(gps_error_x, gps_error_y, gps_error_z);
  photo.tagged_position = position + gps_error;
  photo.tagged_gimbal = GimbalAngles{photo.yaw_deg, photo.pitch_deg, photo.roll_deg};
  photo.relative_altitude_m = position.z() - takeoff_z_m + 0.15 * random.Normal();
}

void ExposePhotos(const PlaceSpec& place, std::vector<PhotoPlan>& photos) {
  const std::vector<double> stops = ExposureStops(place, photos.size());
  for (size_t i = 0; i < photos.size(); ++i) {
    SetExposure(place.exposure_offset_stops + stops[i], photos[i]);
    photos[i].exposure_tagged = place.exposure_tags == ExposureTags::kAll || (place.exposure_tags == ExposureTags::kHalf && i % 2 == 0);
  }
  SetLight(place, photos);
}

std::vector<PhotoPlan> PlanFlight(const PlaceSpec& place, double takeoff_z_m) {
  if (place.flight != FlightKind::kSurvey) {
    throw base::UsageError("simulate.flight = " + FlightName(place.flight) +
                           " is not allowed: this command plans a survey's flight; set it to survey");
  }
  const std::vector<Station> stations = PlanStations(place);
  std::vector<PhotoPlan> photos;
  for (size_t i = 0; i < stations.size(); ++i) {
    const Station& station = stations[i];
    base::Random random(place.seed, 1000 + i);
    PhotoPlan photo;
    photo.name = PhotoName(i);
    photo.line = station.line;
    photo.oblique = station.pitch_deg > -89.0;
    photo.time_s = kPhotoInterval_s * static_cast<double>(i);
    photo.yaw_deg = station.yaw_deg + 1.2 * random.Normal();
    photo.pitch_deg = std::max(station.pitch_deg + 0.7 * random.Normal(), -90.0);
    photo.roll_deg = 0.7 * random.Normal();
    const double drift_z = 0.3 * random.Normal(), drift_y = 0.25 * random.Normal(), drift_x = 0.25 * random.Normal();
    const Vector3d drift(drift_x, drift_y, drift_z);
    const Vector3d position = Vector3d(station.position.x(), station.position.y(), takeoff_z_m + station.altitude_m) + drift;
    PlacePhoto(place, takeoff_z_m, position, random, photo);
    photos.push_back(photo);
  }
  ExposePhotos(place, photos);
  return photos;
}

}  // namespace skyquilt::simulate
