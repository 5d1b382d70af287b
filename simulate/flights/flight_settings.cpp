#include "simulate/flights/flight_settings.h"

#include <algorithm>
#include <array>

#include "core/base/errors.h"
#include "simulate/flights/level_flight.h"
#include "simulate/flights/room.h"

namespace skyquilt::simulate {
namespace {

struct FlightSettings {
  const char* name;
  int photos;         // when simulate.photos is 0
  double altitude_m;  // above ground, for the suggested blocks
};
constexpr std::array<FlightSettings, 5> kFlights = {
    {{"survey", 0, 0.0}, {"facade", 12, kEyeHeight_m}, {"orbit", 40, kOrbitHeights_m[0]}, {"street", 60, kEyeHeight_m}, {"room", 50, kEyeHeight_m}}};

const FlightSettings& SettingsOf(FlightKind flight) {
  return kFlights[static_cast<size_t>(flight)];
}

[[noreturn]] void RefuseWithFlight(const std::string& option, const std::string& given, const std::string& why) {
  throw base::UsageError("simulate." + option + " = " + given + " is not allowed: " + why);
}

// As a phone's main camera held level: 67 degrees wide.
camera::Camera PhoneCamera() {
  camera::Camera camera;
  camera.model = camera::CameraModel::kSimpleRadial;
  camera.width = 640;
  camera.height = 480;
  camera.params = {480.0, 320.0, 240.0, -0.02};
  return camera;
}

}  // namespace

std::vector<std::string> FlightNames() {
  std::vector<std::string> names;
  for (const FlightSettings& flight : kFlights) names.emplace_back(flight.name);
  return names;
}

std::string FlightName(FlightKind flight) {
  return SettingsOf(flight).name;
}

PlaceSpec RoomPlace() {
  PlaceSpec place;
  place.name = "room";
  place.landscape = Landscape::kRoom;
  place.area_max = {kRoomReach_m, kRoomReach_m};
  place.area_min = -place.area_max;
  place.surround_m = 8.0;
  place.terrain_step_m = 1.0;
  place.terrain_amplitude_m = 0.0;
  place.ambient_voxel_m = 0.3;
  return place;
}

void ApplyFlight(const SimulateOptions& options, PlaceSpec& place) {
  const auto found = std::find_if(kFlights.begin(), kFlights.end(), [&](const FlightSettings& flight) { return options.flight == flight.name; });
  place.flight = static_cast<FlightKind>(found - kFlights.begin());
  if (place.flight == FlightKind::kSurvey) {
    if (options.photos != 0) {
      RefuseWithFlight("photos", std::to_string(options.photos), "the overlaps say how many photos flight 'survey' has; set it to 0");
    }
    return;
  }
  const std::string flight = "flight '" + options.flight + "'";
  if (!options.altitudes.empty())
    RefuseWithFlight("altitudes", std::to_string(options.altitudes.size()) + " numbers", flight + " has its own heights; leave it empty");
  if (options.single_line) RefuseWithFlight("single_line", "true", "it is for flight 'survey'; set it to false");
  const bool in_city = place.flight != FlightKind::kRoom;
  if (in_city && place.landscape != Landscape::kCity) {
    const std::string without = place.flight == FlightKind::kStreet ? "streets" : "houses";
    RefuseWithFlight("flight", options.flight, "place '" + place.name + "' has no " + without + "; choose hamlet, town or smallcity");
  }
  if (in_city && place.flight != FlightKind::kStreet && options.building_share == 0.0) {
    RefuseWithFlight("flight", options.flight, "there are no houses with building_share = 0");
  }
  place.level_photos = options.photos > 0 ? options.photos : SettingsOf(place.flight).photos;
  place.camera = PhoneCamera();
  place.rows = place.columns = 1;
  place.altitudes_agl_m = {SettingsOf(place.flight).altitude_m};
  place.forward_overlap = 0.7;
  place.gps_noise_m = 4.0;
  place.exposure_drift_stops = 0.5;
  place.exposure_jumps_stops = 0.4;
  place.moving_cars = 0;
}

}  // namespace skyquilt::simulate
