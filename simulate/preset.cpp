#include "simulate/preset.h"

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

void CenterArea(Preset& preset, double width_m, double height_m) {
  preset.area_max = {0.5 * width_m, 0.5 * height_m};
  preset.area_min = -preset.area_max;
}

Preset Hamlet() {
  Preset preset;
  preset.name = "hamlet";
  CenterArea(preset, 70.0, 70.0);
  preset.surround_m = 60.0;
  preset.terrain_amplitude_m = 0.8;
  preset.city.min = {-42.0, -42.0};
  preset.city.max = {42.0, 42.0};
  preset.city.pitch_m = 62.0;
  preset.city.phase = {-9.0, -8.0};
  preset.city.tower_share = 0.0;
  preset.city.flats_share = 0.0;
  preset.city.park_share = 0.0;
  preset.city.lot_use = 0.6;
  preset.city.tree_detail = 1;
  preset.altitudes_agl_m.assign(4, 45.0);
  preset.flight_inset_m = 6.0;
  preset.camera = MakeCamera(camera::CameraModel::kSimpleRadial, 160, 120, 70.0, {-0.02});
  preset.gps_noise_m = 0.3;
  preset.moving_cars = 1;
  return preset;
}

Preset Town() {
  Preset preset;
  preset.name = "town";
  CenterArea(preset, 200.0, 200.0);
  preset.surround_m = 130.0;
  preset.city.min = {-168.0, -168.0};
  preset.city.max = {168.0, 168.0};
  preset.city.pitch_m = 66.0;
  preset.city.phase = {-33.0, -33.0};
  preset.altitudes_agl_m.assign(4, 85.0);
  preset.flight_inset_m = 8.0;
  preset.oblique_lines = 4;
  preset.camera = MakeCamera(camera::CameraModel::kSimpleRadial, 640, 360, 70.0, {-0.02});
  return preset;
}

Preset SmallCity() {
  Preset preset;
  preset.name = "smallcity";
  CenterArea(preset, 1500.0, 600.0);
  preset.surround_m = 420.0;
  preset.terrain_step_m = 4.0;
  preset.terrain_amplitude_m = 3.0;
  preset.city.min = {-950.0, -500.0};
  preset.city.max = {950.0, 500.0};
  preset.city.pitch_m = 76.0;
  preset.city.phase = {-30.0, -38.0};
  preset.city.tower_share = 0.22;
  preset.city.flats_share = 0.28;
  preset.city.trees = 0.6;
  preset.city.tree_detail = 1;
  preset.rows = 2;
  preset.columns = 5;
  preset.altitudes_agl_m = {150, 150, 300, 500, 450, 450, 350, 350, 250, 200};
  preset.speed_mps = 14.0;
  preset.camera = MakeCamera(camera::CameraModel::kPinhole, 640, 360, 70.0, {});
  preset.gps_noise_m = 1.0;
  preset.moving_cars = 12;
  preset.ambient_voxel_m = 6.0;
  return preset;
}

Preset TidalFlat() {
  Preset preset;
  preset.name = "tidalflat";
  preset.landscape = Landscape::kTidalFlat;
  CenterArea(preset, 200.0, 200.0);
  preset.surround_m = 90.0;
  preset.terrain_step_m = 1.0;
  preset.terrain_amplitude_m = 0.5;
  preset.altitudes_agl_m.assign(4, 80.0);
  preset.flight_inset_m = 10.0;
  preset.oblique_lines = 2;
  preset.camera = MakeCamera(camera::CameraModel::kOpencv, 640, 480, 68.0, {-0.03, 0.008, 0.0004, -0.0003});
  preset.gps_noise_m = 0.8;
  preset.exposure_drift_stops = 1.5;
  preset.exposure_jumps_stops = 0.8;
  preset.moving_cars = 0;
  preset.sun_azimuth_deg = 200.0;
  preset.sun_elevation_deg = 56.0;
  preset.ambient_voxel_m = 6.0;
  preset.sky_clouds = 0.8;
  return preset;
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

// Negative means "as the preset has it"; NaN is refused.
void Overlay(const std::string& option, double value, double low, double high, double& target) {
  if (value < 0.0) return;
  RequireRange(option, value, low, high);
  target = value;
}

void ApplyAltitudes(const std::vector<double>& altitudes, Preset& preset) {
  if (altitudes.empty()) return;
  const auto n_blocks = static_cast<size_t>(preset.rows) * static_cast<size_t>(preset.columns);
  if (altitudes.size() != 1 && altitudes.size() != n_blocks) {
    Refuse("altitudes", std::to_string(altitudes.size()) + " numbers",
           "preset '" + preset.name + "' has " + std::to_string(n_blocks) + " blocks; give one altitude or " + std::to_string(n_blocks));
  }
  // Below roof height the camera would fly through the scenery.
  for (const double altitude : altitudes) RequireRange("altitudes", altitude, 40.0, 2000.0);
  preset.altitudes_agl_m = altitudes;
  preset.altitudes_agl_m.resize(n_blocks, altitudes.front());
}

void ApplyExposure(const SimulateOptions& options, Preset& preset) {
  Overlay("exposure_drift_stops", options.exposure_drift_stops, 0.0, 10.0, preset.exposure_drift_stops);
  Overlay("exposure_jumps_stops", options.exposure_jumps_stops, 0.0, 10.0, preset.exposure_jumps_stops);
  RequireRange("exposure_offset_stops", options.exposure_offset_stops, -10.0, 10.0);
  preset.exposure_offset_stops = options.exposure_offset_stops;
  if (std::abs(preset.exposure_offset_stops) + preset.exposure_drift_stops + preset.exposure_jumps_stops > kMaxStops) {
    Refuse("exposure_offset_stops", Text(preset.exposure_offset_stops),
           "with exposure_drift_stops = " + Text(preset.exposure_drift_stops) + " and exposure_jumps_stops = " + Text(preset.exposure_jumps_stops) +
               " photos would be more than " + Text(kMaxStops) + " stops from normal; give less of one of them");
  }
  RequireRange("exposure_error_stops", options.exposure_error_stops, 0.0, 3.0);
  preset.exposure_error_stops = options.exposure_error_stops;
  RequireRange("color_drift_stops", options.color_drift_stops, 0.0, 3.0);
  preset.color_drift_stops = options.color_drift_stops;
  RequireRange("vignetting", options.vignetting, 0.0, 0.9);
  preset.vignetting = options.vignetting;
  if (options.exposure_tags == "all") {
    preset.exposure_tags = ExposureTags::kAll;
  } else if (options.exposure_tags == "none") {
    preset.exposure_tags = ExposureTags::kNone;
  } else if (options.exposure_tags == "half") {
    preset.exposure_tags = ExposureTags::kHalf;
  } else {
    Refuse("exposure_tags", "'" + options.exposure_tags + "'", "choose one of all, none, half");
  }
}

}  // namespace

std::vector<std::string> PresetNames() {
  return {"hamlet", "town", "smallcity", "tidalflat"};
}

Preset ResolvePreset(const SimulateOptions& options) {
  Preset preset;
  if (options.preset == "hamlet") {
    preset = Hamlet();
  } else if (options.preset == "town") {
    preset = Town();
  } else if (options.preset == "smallcity") {
    preset = SmallCity();
  } else if (options.preset == "tidalflat") {
    preset = TidalFlat();
  } else {
    Refuse("preset", "'" + options.preset + "'", "choose one of " + base::Join(PresetNames()));
  }
  RequireRange("seed", options.seed, 0, 2147483647.0);
  preset.seed = static_cast<uint32_t>(options.seed);
  if (options.image_width != 0) {
    RequireRange("image_width", options.image_width, 32, 8192);
    const double scale = static_cast<double>(options.image_width) / preset.camera.width;
    preset.camera = preset.camera.Resized(options.image_width, static_cast<int>(std::lround(scale * preset.camera.height)));
  }
  Overlay("forward_overlap", options.forward_overlap, 0.0, 0.95, preset.forward_overlap);
  Overlay("side_overlap", options.side_overlap, 0.0, 0.95, preset.side_overlap);
  ApplyAltitudes(options.altitudes, preset);
  if (!options.oblique) preset.oblique_lines = 0;
  Overlay("gps_noise_m", options.gps_noise_m, 0.0, 1000.0, preset.gps_noise_m);
  ApplyExposure(options, preset);
  RequireRange("latitude_deg", options.latitude_deg, -90.0, 90.0);
  RequireRange("longitude_deg", options.longitude_deg, -180.0, 180.0);
  RequireRange("height_m", options.height_m, -500.0, 9000.0);
  RequireRange("test_every", options.test_every, 1, 1000000);
  if (options.moving_cars >= 0) {
    RequireRange("moving_cars", options.moving_cars, 0, 1000);
    if (preset.landscape == Landscape::kTidalFlat && options.moving_cars > 0) {
      Refuse("moving_cars", std::to_string(options.moving_cars), "preset 'tidalflat' has no roads; give 0");
    }
    preset.moving_cars = options.moving_cars;
  }
  Overlay("sun_azimuth_deg", options.sun_azimuth_deg, 0.0, 360.0, preset.sun_azimuth_deg);
  Overlay("sun_elevation_deg", options.sun_elevation_deg, 5.0, 90.0, preset.sun_elevation_deg);
  RequireRange("light_intensity", options.light_intensity, 1e-3, 1e3);
  if (options.samples_per_pixel != 1 && options.samples_per_pixel != 4 && options.samples_per_pixel != 16) {
    Refuse("samples_per_pixel", std::to_string(options.samples_per_pixel), "give 1, 4 or 16");
  }
  RequireRange("jpeg_quality", options.jpeg_quality, 1, 100);
  return preset;
}

}  // namespace skyquilt::simulate
