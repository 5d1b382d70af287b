#include "simulate/place_spec.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "simulate/simulate.h"

namespace skyquilt::simulate {
namespace {

// At 13 stops below normal exposure the shutter time is 15 units of 1e-8 s, in which the tags are written.
constexpr double kMaxStops = 13.0;

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

[[noreturn]] void Refuse(const std::string& option, const std::string& given, const std::string& allowed) {
  throw base::UsageError("simulate." + option + " = " + given + " is not possible: " + allowed);
}

std::string Text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

void RequireRange(const std::string& option, double value, double low, double high) {
  if (!(value >= low && value <= high)) Refuse(option, Text(value), "give a number from " + Text(low) + " to " + Text(high));
}

// Negative means "as the place has it"; NaN is refused.
void Overlay(const std::string& option, double value, double low, double high, double& target) {
  if (value < 0.0) return;
  RequireRange(option, value, low, high);
  target = value;
}

void ApplyAltitudes(const std::vector<double>& altitudes, PlaceSpec& place) {
  if (altitudes.empty()) return;
  const auto n_blocks = static_cast<size_t>(place.rows) * static_cast<size_t>(place.columns);
  if (altitudes.size() != 1 && altitudes.size() != n_blocks) {
    Refuse("altitudes", std::to_string(altitudes.size()) + " numbers",
           "place '" + place.name + "' has " + std::to_string(n_blocks) + " blocks; give one altitude or " + std::to_string(n_blocks));
  }
  // Below roof height the camera would fly through the scenery.
  for (const double altitude : altitudes) RequireRange("altitudes", altitude, 40.0, 2000.0);
  place.altitudes_agl_m = altitudes;
  place.altitudes_agl_m.resize(n_blocks, altitudes.front());
}

void ApplyExposure(const SimulateOptions& options, PlaceSpec& place) {
  Overlay("exposure_drift_stops", options.exposure_drift_stops, 0.0, 10.0, place.exposure_drift_stops);
  Overlay("exposure_jumps_stops", options.exposure_jumps_stops, 0.0, 10.0, place.exposure_jumps_stops);
  RequireRange("exposure_offset_stops", options.exposure_offset_stops, -10.0, 10.0);
  place.exposure_offset_stops = options.exposure_offset_stops;
  if (std::abs(place.exposure_offset_stops) + place.exposure_drift_stops + place.exposure_jumps_stops > kMaxStops) {
    Refuse("exposure_offset_stops", Text(place.exposure_offset_stops),
           "with exposure_drift_stops = " + Text(place.exposure_drift_stops) + " and exposure_jumps_stops = " + Text(place.exposure_jumps_stops) +
               " photos would be more than " + Text(kMaxStops) + " stops from normal; give less of one of them");
  }
  RequireRange("exposure_error_stops", options.exposure_error_stops, 0.0, 3.0);
  place.exposure_error_stops = options.exposure_error_stops;
  RequireRange("color_drift_stops", options.color_drift_stops, 0.0, 3.0);
  place.color_drift_stops = options.color_drift_stops;
  RequireRange("vignetting", options.vignetting, 0.0, 0.9);
  place.vignetting = options.vignetting;
  if (options.exposure_tags == "all") {
    place.exposure_tags = ExposureTags::kAll;
  } else if (options.exposure_tags == "none") {
    place.exposure_tags = ExposureTags::kNone;
  } else if (options.exposure_tags == "half") {
    place.exposure_tags = ExposureTags::kHalf;
  } else {
    Refuse("exposure_tags", "'" + options.exposure_tags + "'", "choose one of all, none, half");
  }
}

}  // namespace

std::vector<std::string> PlaceNames() {
  return {"hamlet", "town", "smallcity", "tidalflat"};
}

PlaceSpec ResolvePlace(const SimulateOptions& options) {
  PlaceSpec place;
  if (options.place == "hamlet") {
    place = Hamlet();
  } else if (options.place == "town") {
    place = Town();
  } else if (options.place == "smallcity") {
    place = SmallCity();
  } else if (options.place == "tidalflat") {
    place = TidalFlat();
  } else {
    Refuse("place", "'" + options.place + "'", "choose one of " + base::Join(PlaceNames()));
  }
  RequireRange("seed", options.seed, 0, 2147483647.0);
  place.seed = static_cast<uint32_t>(options.seed);
  if (options.image_width != 0) {
    RequireRange("image_width", options.image_width, 32, 8192);
    const double scale = static_cast<double>(options.image_width) / place.camera.width;
    place.camera = place.camera.Resized(options.image_width, static_cast<int>(std::lround(scale * place.camera.height)));
  }
  Overlay("forward_overlap", options.forward_overlap, 0.0, 0.95, place.forward_overlap);
  Overlay("side_overlap", options.side_overlap, 0.0, 0.95, place.side_overlap);
  ApplyAltitudes(options.altitudes, place);
  if (!options.oblique) place.oblique_lines = 0;
  Overlay("gps_noise_m", options.gps_noise_m, 0.0, 1000.0, place.gps_noise_m);
  ApplyExposure(options, place);
  RequireRange("latitude_deg", options.latitude_deg, -90.0, 90.0);
  RequireRange("longitude_deg", options.longitude_deg, -180.0, 180.0);
  RequireRange("height_m", options.height_m, -500.0, 9000.0);
  RequireRange("test_every", options.test_every, 1, 1000000);
  if (options.moving_cars >= 0) {
    RequireRange("moving_cars", options.moving_cars, 0, 1000);
    if (place.landscape == Landscape::kTidalFlat && options.moving_cars > 0) {
      Refuse("moving_cars", std::to_string(options.moving_cars), "place 'tidalflat' has no roads; give 0");
    }
    place.moving_cars = options.moving_cars;
  }
  Overlay("sun_azimuth_deg", options.sun_azimuth_deg, 0.0, 360.0, place.sun_azimuth_deg);
  Overlay("sun_elevation_deg", options.sun_elevation_deg, 5.0, 90.0, place.sun_elevation_deg);
  RequireRange("light_intensity", options.light_intensity, 1e-3, 1e3);
  if (options.samples_per_pixel != 1 && options.samples_per_pixel != 4 && options.samples_per_pixel != 16) {
    Refuse("samples_per_pixel", std::to_string(options.samples_per_pixel), "give 1, 4 or 16");
  }
  RequireRange("jpeg_quality", options.jpeg_quality, 1, 100);
  return place;
}

}  // namespace skyquilt::simulate
