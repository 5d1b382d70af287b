#include "simulate/flights/level_flight.h"

#include <cmath>
#include <numbers>

#include "core/base/errors.h"

namespace skyquilt::simulate {
namespace {

constexpr double kBetweenPhotos_s = 2.0;
constexpr uint64_t kHandStream = 300000;  // and the index of the photo

std::vector<LevelStation> StationsOf(const PlaceSpec& place, const World& world) {
  switch (place.flight) {
    case FlightKind::kFacade:
      return FacadeStations(place, world);
    case FlightKind::kOrbit:
      return OrbitStations(place, world);
    case FlightKind::kStreet:
      return StreetStations(place, world);
    case FlightKind::kRoom:
      return RoomStations(place);
    case FlightKind::kSurvey:
      break;
  }
  SKYQUILT_CHECK(false, "a survey is no level flight");
  return {};
}

}  // namespace

double YawOf(const Eigen::Vector2d& direction) {
  return std::atan2(direction.x(), direction.y()) * 180.0 / std::numbers::pi;
}

double GroundZ(const World& world, const Eigen::Vector2d& at) {
  return static_cast<double>(world.terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
}

std::vector<LevelStation> RoomStations(const PlaceSpec& place) {
  // An ellipse in the middle, nearer to a wall than to the furniture at it; the height of the hand and the view sway.
  constexpr double kHalfPathX_m = 0.9, kHalfPathY_m = 0.7, kHandHeight_m = 1.5;
  constexpr double kHandSway_m = 0.15, kViewSway_deg = 7.0;
  std::vector<LevelStation> stations;
  for (int i = 0; i < place.level_photos; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / place.level_photos;
    const Eigen::Vector3d at(kHalfPathX_m * std::cos(angle), kHalfPathY_m * std::sin(angle), kHandHeight_m + kHandSway_m * std::sin(3.0 * angle));
    stations.push_back({at, YawOf({std::cos(angle), std::sin(angle)}), kViewSway_deg * std::sin(2.0 * angle), 0});
  }
  return stations;
}

std::vector<PhotoPlan> PlanLevelFlight(const PlaceSpec& place, const World& world) {
  const std::vector<LevelStation> stations = StationsOf(place, world);
  const double start_z_m = GroundZ(world, stations.front().position.head<2>());
  // Hands are steadier in place than a drone in the wind.
  const double drift_m = place.flight == FlightKind::kOrbit ? 0.15 : 0.03;
  std::vector<PhotoPlan> photos;
  for (size_t i = 0; i < stations.size(); ++i) {
    const LevelStation& station = stations[i];
    base::Random random(place.seed, kHandStream + i);
    PhotoPlan photo;
    photo.name = PhotoName(i);
    photo.line = station.line;
    photo.oblique = true;
    photo.time_s = kBetweenPhotos_s * static_cast<double>(i);
    photo.yaw_deg = station.yaw_deg + 1.2 * random.Normal();
    photo.pitch_deg = station.pitch_deg + 0.8 * random.Normal();
    photo.roll_deg = 0.8 * random.Normal();
    const double drift_z = drift_m * random.Normal(), drift_y = drift_m * random.Normal(), drift_x = drift_m * random.Normal();
    PlacePhoto(place, start_z_m, station.position + Eigen::Vector3d(drift_x, drift_y, drift_z), random, photo);
    photos.push_back(photo);
  }
  ExposePhotos(place, photos);
  return photos;
}

}  // namespace skyquilt::simulate
