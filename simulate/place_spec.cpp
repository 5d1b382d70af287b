#include "simulate/place_spec.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/geo/crs.h"
#include "simulate/flights/flight_settings.h"
#include "simulate/noise.h"
#include "simulate/simulate.h"
#include "simulate/terrain.h"

namespace skyquilt::simulate {
namespace {

// Tags have shutter times in units of 1e-8 s. At 13 stops below normal exposure this is 15 units; less would be too coarse.
constexpr double kMaxStops = 13.0;
constexpr double kSteepestUnderBridge_deg = 2.0;

camera::Camera MakeCamera(camera::CameraModel model, int width, int height, double horizontal_fov_deg, const std::vector<double>& distortion) {
  camera::Camera camera;
  camera.model = model;
  camera.width = width;
  camera.height = height;
  const double focal = 0.5 * width / std::tan(0.5 * horizontal_fov_deg * std::numbers::pi / 180.0);
  camera.params = {focal};
  if (camera::ModelParamCount(model) == 4 + static_cast<int>(distortion.size())) camera.params.push_back(focal);
  camera.params.push_back(0.5 * width);
  camera.params.push_back(0.5 * height);
  camera.params.insert(camera.params.end(), distortion.begin(), distortion.end());
  return camera;
}

void CenterArea(PlaceSpec& place, double width_m, double height_m) {
  place.area_max = {0.5 * width_m, 0.5 * height_m};
  place.area_min = -place.area_max;
}

PlaceSpec Hamlet() {
  PlaceSpec place;
  place.name = "hamlet";
  CenterArea(place, 70.0, 70.0);
  place.surround_m = 60.0;
  place.terrain_amplitude_m = 0.8;
  place.city.min = {-42.0, -42.0};
  place.city.max = {42.0, 42.0};
  place.city.pitch_m = 62.0;
  place.city.phase = {-9.0, -8.0};
  place.city.tower_share = 0.0;
  place.city.flats_share = 0.0;
  place.city.park_share = 0.0;
  place.city.lot_use = 0.6;
  place.city.tree_detail = 1;
  place.altitudes_agl_m.assign(4, 45.0);
  place.flight_inset_m = 6.0;
  place.camera = MakeCamera(camera::CameraModel::kSimpleRadial, 160, 120, 70.0, {-0.02});
  place.gps_noise_m = 0.3;
  place.moving_cars = 1;
  return place;
}

PlaceSpec Town() {
  PlaceSpec place;
  place.name = "town";
  CenterArea(place, 200.0, 200.0);
  place.surround_m = 130.0;
  place.city.min = {-168.0, -168.0};
  place.city.max = {168.0, 168.0};
  place.city.pitch_m = 66.0;
  place.city.phase = {-33.0, -33.0};
  place.altitudes_agl_m.assign(4, 85.0);
  place.flight_inset_m = 8.0;
  place.oblique_lines = 4;
  place.camera = MakeCamera(camera::CameraModel::kSimpleRadial, 640, 360, 70.0, {-0.02});
  return place;
}

PlaceSpec SmallCity() {
  PlaceSpec place;
  place.name = "smallcity";
  CenterArea(place, 1500.0, 600.0);
  place.surround_m = 420.0;
  place.terrain_step_m = 4.0;
  place.terrain_amplitude_m = 3.0;
  place.city.min = {-950.0, -500.0};
  place.city.max = {950.0, 500.0};
  place.city.pitch_m = 76.0;
  place.city.phase = {-30.0, -38.0};
  place.city.tower_share = 0.22;
  place.city.flats_share = 0.28;
  place.city.trees = 0.6;
  place.city.tree_detail = 1;
  place.rows = 2;
  place.columns = 5;
  place.altitudes_agl_m = {150, 150, 300, 500, 450, 450, 350, 350, 250, 200};
  place.speed_mps = 14.0;
  place.camera = MakeCamera(camera::CameraModel::kPinhole, 640, 360, 70.0, {});
  place.gps_noise_m = 1.0;
  place.moving_cars = 12;
  place.ambient_voxel_m = 6.0;
  return place;
}

PlaceSpec TidalFlat() {
  PlaceSpec place;
  place.name = "tidalflat";
  place.landscape = Landscape::kTidalFlat;
  CenterArea(place, 200.0, 200.0);
  place.surround_m = 90.0;
  place.terrain_step_m = 1.0;
  place.terrain_amplitude_m = 0.5;
  place.altitudes_agl_m.assign(4, 80.0);
  place.flight_inset_m = 10.0;
  place.oblique_lines = 2;
  place.camera = MakeCamera(camera::CameraModel::kOpencv, 640, 480, 68.0, {-0.03, 0.008, 0.0004, -0.0003});
  place.gps_noise_m = 0.8;
  place.exposure_drift_stops = 1.5;
  place.exposure_jumps_stops = 0.8;
  place.moving_cars = 0;
  place.sun_azimuth_deg = 200.0;
  place.sun_elevation_deg = 56.0;
  place.ambient_voxel_m = 6.0;
  place.sky_clouds = 0.8;
  return place;
}

PlaceSpec SolarFarm() {
  PlaceSpec place;
  place.name = "solar_farm";
  place.landscape = Landscape::kSolarFarm;
  CenterArea(place, 90.0, 130.0);
  place.surround_m = 70.0;
  place.terrain_amplitude_m = 0.15;
  place.altitudes_agl_m.assign(4, 60.0);
  place.flight_inset_m = 8.0;
  place.camera = MakeCamera(camera::CameraModel::kSimpleRadial, 800, 600, 70.0, {-0.02});
  place.moving_cars = 0;
  return place;
}

[[noreturn]] void Refuse(const std::string& option, const std::string& given, const std::string& allowed) {
  throw base::UsageError("simulate." + option + " = " + given + " is not allowed: " + allowed);
}

std::string Text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

// A negative option keeps the place's value.
void Overlay(double value, double& target) {
  if (value >= 0.0) target = value;
}

void ApplyAltitudes(const std::vector<double>& altitudes, PlaceSpec& place) {
  if (altitudes.empty()) return;
  const auto n_blocks = static_cast<size_t>(place.rows) * static_cast<size_t>(place.columns);
  if (altitudes.size() != 1 && altitudes.size() != n_blocks) {
    Refuse("altitudes", std::to_string(altitudes.size()) + " numbers",
           "place '" + place.name + "' has " + std::to_string(n_blocks) + " blocks; give 1 altitude or " + std::to_string(n_blocks));
  }
  place.altitudes_agl_m = altitudes;
  place.altitudes_agl_m.resize(n_blocks, altitudes.front());
}

void ApplyExposure(const SimulateOptions& options, PlaceSpec& place) {
  Overlay(options.exposure_drift_stops, place.exposure_drift_stops);
  Overlay(options.exposure_jumps_stops, place.exposure_jumps_stops);
  place.exposure_offset_stops = options.exposure_offset_stops;
  if (std::abs(place.exposure_offset_stops) + place.exposure_drift_stops + place.exposure_jumps_stops > kMaxStops) {
    Refuse("exposure_offset_stops", Text(place.exposure_offset_stops),
           "with exposure_drift_stops = " + Text(place.exposure_drift_stops) + " and exposure_jumps_stops = " + Text(place.exposure_jumps_stops) +
               " photos would be more than " + Text(kMaxStops) + " stops from normal exposure; lower one of the three");
  }
  place.exposure_error_stops = options.exposure_error_stops;
  place.color_drift_stops = options.color_drift_stops;
  place.vignetting = options.vignetting;
  if (options.exposure_tags == "all") {
    place.exposure_tags = ExposureTags::kAll;
  } else if (options.exposure_tags == "none") {
    place.exposure_tags = ExposureTags::kNone;
  } else {
    place.exposure_tags = ExposureTags::kHalf;
  }
}

void ApplyTagOptions(const SimulateOptions& options, PlaceSpec& place) {
  TagFaults& faults = place.tag_faults;
  faults.lag_s = options.tag_lag_s;
  faults.drift_m = options.tag_drift_m;
  faults.jump_m = options.tag_jump_m;
  faults.outlier_share = options.tag_outliers;
  faults.outlier_m = options.tag_outlier_m;
  faults.bias_m = options.tag_bias_m;
  faults.height_offset_m = options.tag_height_offset_m;
  faults.swapped = options.tags_swapped;
  faults.equal = options.tags_equal;
  faults.gimbal_tags = options.gimbal_tags;
  faults.gimbal_common_error_deg = options.gimbal_common_error_deg;
  faults.gimbal_random_error_deg = options.gimbal_random_error_deg;
  faults.speed_tags = options.speed_tags;
  if (options.tags == "none" || (options.tags == "auto" && place.flight != FlightKind::kSurvey)) {
    faults.position_tags = faults.gimbal_tags = faults.speed_tags = false;
  }
  if (options.tag_heights == "zero") {
    faults.heights = HeightTags::kZero;
  } else if (options.tag_heights == "none") {
    faults.heights = HeightTags::kNone;
  }
  // Photos, and outliers above all, may be a degree away from the origin.
  constexpr double kMaxLongitude_deg = 89.0;
  constexpr double kMaxLatitude_deg = 80.0;
  if (faults.swapped && (std::abs(options.longitude_deg) > kMaxLongitude_deg || std::abs(options.latitude_deg) > kMaxLatitude_deg)) {
    Refuse("tags_swapped", "true",
           "a longitude beyond 90 degrees would become an impossible latitude; choose longitude_deg within +-" + Text(kMaxLongitude_deg) +
               " and latitude_deg within +-" + Text(kMaxLatitude_deg));
  }
}

void ApplyHillside(const SimulateOptions& options, PlaceSpec& place) {
  place.hillside_deg = options.hillside_deg;
  if (place.hillside_deg == 0.0) return;
  if (place.landscape == Landscape::kTidalFlat)
    Refuse("hillside_deg", Text(place.hillside_deg), "the water of place 'tidalflat' is level; set it to 0");
  if (place.landscape == Landscape::kRoom) Refuse("hillside_deg", Text(place.hillside_deg), "the room of flight 'room' is level; set it to 0");
  if (place.flight != FlightKind::kSurvey) return;
  constexpr double kClearance_m = 10.0;
  const Eigen::Vector2d half = 0.5 * (place.area_max - place.area_min);
  const Eigen::Vector2d block = 2.0 * half.cwiseQuotient(Eigen::Vector2d(place.columns, place.rows));
  // Take-off may be in a hollow and the top on a hill.
  const double rolling = 2.0 * 1.7 * place.terrain_amplitude_m;
  const auto columns = static_cast<size_t>(place.columns);
  for (size_t i = 0; i < place.altitudes_agl_m.size(); ++i) {
    const size_t row = i / columns;
    const Eigen::Vector2d corner = -half + block.cwiseProduct(Eigen::Vector2d(static_cast<double>(i % columns + 1), static_cast<double>(row + 1)));
    const double top = HillsideRise(place.hillside_deg).dot(corner) + rolling;
    if (top + kClearance_m <= place.altitudes_agl_m[i]) continue;
    Refuse("hillside_deg", Text(place.hillside_deg),
           "the hill may rise to " + Text(std::ceil(top)) + " m above take-off below a flight at " + Text(place.altitudes_agl_m[i]) + " m; " +
               Text(kClearance_m) + " m must be left: choose a gentler slope or higher altitudes");
  }
}

// What a search for buildings must not take for one, and places without any.
void ApplySpecialCases(const SimulateOptions& options, PlaceSpec& place) {
  if (place.landscape != Landscape::kCity) {
    const std::string without = "place '" + place.name + "' has no ";
    if (options.building_share != 1.0) Refuse("building_share", Text(options.building_share), without + "buildings; set it to 1");
    if (options.tree_density != 1.0) Refuse("tree_density", Text(options.tree_density), without + "trees; set it to 1");
    if (options.bridge) Refuse("bridge", "true", without + "streets; set it to false");
    if (options.trucks > 0) Refuse("trucks", std::to_string(options.trucks), without + "streets; set it to 0");
  }
  if (options.building_share == 0.0 && options.tower_m > 0.0) {
    Refuse("building_share", Text(options.building_share),
           "tower_m = " + Text(options.tower_m) + " asks for a building; set one of both to another value");
  }
  // The uphill foot of a ramp could be higher than the deck.
  if (options.bridge && options.hillside_deg > kSteepestUnderBridge_deg) {
    Refuse("bridge", "true", "it needs ground that is nearly level; set hillside_deg to " + Text(kSteepestUnderBridge_deg) + " or less");
  }
  place.city.building_share = options.building_share;
  place.city.tree_density = options.tree_density;
  place.city.bridge = options.bridge;
  place.city.trucks = options.trucks;
  place.city.trucks_min = place.area_min;
  place.city.trucks_max = place.area_max;
}

void ApplyBuildings(const SimulateOptions& options, PlaceSpec& place) {
  place.city.varied = options.building_shapes == "varied";
  place.city.tower_m = options.tower_m;
  if (place.landscape != Landscape::kCity) {
    const std::string without = "place '" + place.name + "' has no buildings; ";
    if (place.city.varied) Refuse("building_shapes", options.building_shapes, without + "set it to plain");
    if (options.tower_m > 0.0) Refuse("tower_m", Text(options.tower_m), without + "set it to 0");
  }
  ApplySpecialCases(options, place);
  if (options.tower_m == 0.0 || place.flight != FlightKind::kSurvey) return;
  constexpr double kClearance_m = 10.0;
  // The tower may stand on a hill or uphill from take-off, within a cell of the middle of the place.
  const double ground = 2.0 * 1.7 * place.terrain_amplitude_m + HillsideRise(place.hillside_deg).norm() * place.city.pitch_m;
  const double needed = std::ceil(options.tower_m + ground + kClearance_m);
  const double lowest = *std::min_element(place.altitudes_agl_m.begin(), place.altitudes_agl_m.end());
  if (needed <= lowest) return;
  Refuse("tower_m", Text(options.tower_m),
         "a flight at " + Text(lowest) + " m must clear the tower by " + Text(kClearance_m) + " m; choose a lower tower, or set altitudes to " +
             Text(needed) + " or more");
}

// The buildings of a place must not stand along north and east, which would flatter whatever prefers these directions.
void ApplyCityYaw(const SimulateOptions& options, PlaceSpec& place) {
  if (place.landscape != Landscape::kCity) return;
  base::Random random(HashCell(static_cast<int>(place.seed), 1, 4711U), 5);
  place.city.yaw_deg = random.Uniform(0.0, 360.0);
  const double side = random.UniformDouble() < 0.5 ? -1.0 : 1.0;
  place.city.district_turn_deg = side * random.Uniform(8.0, 12.0);
  Overlay(options.city_yaw_deg, place.city.yaw_deg);
  Overlay(options.district_turn_deg, place.city.district_turn_deg);
}

// Found out before the photos are rendered.
void CheckControlCrs(const SimulateOptions& options) {
  if (options.control_crs.empty()) return;
  if (options.control_crs.find_first_of("\r\n") != std::string::npos) Refuse("control_crs", options.control_crs, "it must be one line");
  try {
    geo::Crs(options.control_crs).FromGeodetic({options.latitude_deg, geo::WrapLongitudeDeg(options.longitude_deg), options.height_m});
  } catch (const std::invalid_argument& error) {
    Refuse("control_crs", options.control_crs, error.what());
  }
}

}  // namespace

std::vector<std::string> PlaceNames() {
  return {"hamlet", "town", "smallcity", "tidalflat", "solar_farm"};
}

PlaceSpec ResolvePlace(const SimulateOptions& options) {
  config::CheckRanges("simulate", options);
  PlaceSpec place;
  if (options.flight == "room") {
    place = RoomPlace();
  } else if (options.place == "hamlet") {
    place = Hamlet();
  } else if (options.place == "town") {
    place = Town();
  } else if (options.place == "smallcity") {
    place = SmallCity();
  } else if (options.place == "tidalflat") {
    place = TidalFlat();
  } else {
    place = SolarFarm();
  }
  place.seed = static_cast<uint32_t>(options.seed);
  ApplyFlight(options, place);
  ApplyCityYaw(options, place);
  if (options.image_width != 0) {
    const double scale = static_cast<double>(options.image_width) / place.camera.width;
    place.camera = place.camera.Resized(options.image_width, static_cast<int>(std::lround(scale * place.camera.height)));
  }
  Overlay(options.forward_overlap, place.forward_overlap);
  Overlay(options.side_overlap, place.side_overlap);
  ApplyAltitudes(options.altitudes, place);
  place.single_line = options.single_line;
  if (!options.oblique || options.single_line) place.oblique_lines = 0;
  ApplyHillside(options, place);
  ApplyBuildings(options, place);
  Overlay(options.gps_noise_m, place.gps_noise_m);
  ApplyTagOptions(options, place);
  ApplyExposure(options, place);
  if (options.moving_cars >= 0) {
    if (place.landscape != Landscape::kCity && options.moving_cars > 0) {
      Refuse("moving_cars", std::to_string(options.moving_cars), "place '" + place.name + "' has no roads; set it to 0");
    }
    place.moving_cars = options.moving_cars;
  }
  for (const auto& [name, count] : {std::pair{"people", options.people}, std::pair{"lamps", options.lamps}}) {
    if (place.landscape != Landscape::kCity && count > 0) {
      Refuse(name, std::to_string(count), "place '" + place.name + "' has no streets; set it to 0");
    }
  }
  place.people = options.people;
  place.city.lamps = options.lamps;
  if (options.cloud_shadows > 0.0 && place.landscape == Landscape::kRoom) {
    Refuse("cloud_shadows", std::to_string(options.cloud_shadows), "the flight is in a room, under a roof; set it to 0");
  }
  place.cloud_shadows = {options.cloud_shadows, options.cloud_size_m, options.cloud_penumbra_m, options.cloud_speed_ms, options.cloud_cover};
  Overlay(options.sun_azimuth_deg, place.sun_azimuth_deg);
  Overlay(options.sun_elevation_deg, place.sun_elevation_deg);
  if (options.marsh && place.landscape != Landscape::kTidalFlat) Refuse("marsh", "true", "only place 'tidalflat' has a marsh; set it to false");
  place.marsh = options.marsh;
  CheckControlCrs(options);
  if (options.ortho_cell_m > 0.0 && place.flight != FlightKind::kSurvey) {
    Refuse("ortho_cell_m", Text(options.ortho_cell_m), "level photos make no orthophoto; set it to 0, or flight to survey");
  }
  return place;
}

}  // namespace skyquilt::simulate
