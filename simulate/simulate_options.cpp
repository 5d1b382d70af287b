#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

void SimulateOptions::Visit(config::OptionVisitor& v) {
  v.Field("place", place, "what to build: hamlet, town, smallcity or tidalflat");
  v.Field("seed", seed, "same seed, same bytes");
  v.Field("image_width", image_width, "width of the photos in pixels; 0: the place's");
  v.Field("forward_overlap", forward_overlap, "share of a photo seen by the next of its line, 0..0.95; negative: the place's");
  v.Field("side_overlap", side_overlap, "share of a photo seen by the next line, 0..0.95; negative: the place's");
  v.Field("altitudes", altitudes,
          "flying heights above ground in metres, one for all blocks or one per block (rows from the south); empty: the place's");
  v.Field("oblique", oblique, "fly the place's oblique lines too");
  v.Field("gps_noise_m", gps_noise_m, "standard deviation of the tagged position per horizontal axis, metres; negative: the place's");
  v.Field("exposure_drift_stops", exposure_drift_stops, "slow change of exposure over the flight, +- stops; negative: the place's");
  v.Field("exposure_jumps_stops", exposure_jumps_stops, "sudden changes of exposure, +- stops; negative: the place's");
  v.Field("exposure_offset_stops", exposure_offset_stops, "exposure of every photo, stops above normal, -10..10; the tags follow");
  v.Field("exposure_error_stops", exposure_error_stops, "standard deviation of brightness per photo that its tags do not tell, stops, 0..3");
  v.Field("color_drift_stops", color_drift_stops,
          "slow wander of the white balance that no tag tells: red up and blue down by at most this, stops, 0..3");
  v.Field("vignetting", vignetting, "share of light that the lens loses in the corners, 0..0.9");
  v.Field("exposure_tags", exposure_tags, "photos tagged with exposure time, aperture and ISO: all, none, or half (every second one)");
  v.Field("latitude_deg", latitude_deg, "latitude of the survey's origin, degrees");
  v.Field("longitude_deg", longitude_deg, "longitude of the survey's origin, degrees");
  v.Field("height_m", height_m, "ellipsoidal height of the origin, metres");
  v.Field("test_every", test_every, "every n-th photo in name order gets a true depth image");
  v.Field("moving_cars", moving_cars, "cars that move between photos; negative: the place's");
  v.Field("sun_azimuth_deg", sun_azimuth_deg, "clockwise from north, 0..360; negative: the place's");
  v.Field("sun_elevation_deg", sun_elevation_deg, "above the horizon, 5..90; negative: the place's");
  v.Field("light_intensity", light_intensity, "scales sun and sky");
  v.Field("samples_per_pixel", samples_per_pixel, "1, 4 or 16 rays per pixel");
  v.Field("soft_shadows", soft_shadows, "spread the shadow rays over the sun's disc");
  v.Field("jpeg_quality", jpeg_quality, "1..100");
}

}  // namespace skyquilt::simulate
